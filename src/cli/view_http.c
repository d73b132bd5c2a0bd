// SPDX-License-Identifier: GPL-3.0-or-later
// The server of `lacuna run --view`: three resources, all made in memory. No request names a file.
#include "cli/view_http.h"

#include <arpa/inet.h>
#include <dlfcn.h>
#include <errno.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include "cli/view_guests.h"
#include "lacuna/report.h"

enum { STREAMS = 16, IDLE = 15, NONCE = 16, BLOCK = 2048 };

// Between two signs of life on a stream on which nothing happens, and how long data are waited for.
static const double heartbeat = 5.0, patience = 10.0;

// The library is loaded for --view alone: linked, it would cost every run its start-up.
typedef struct functions {
    struct MHD_Daemon *(*start)(unsigned flags, uint16_t port, MHD_AcceptPolicyCallback accept,
                                void *accept_context, MHD_AccessHandlerCallback answer,
                                void *answer_context, ...);
    void (*stop)(struct MHD_Daemon *daemon);
    struct MHD_Response *(*from_buffer)(size_t size, void *buffer,
                                        enum MHD_ResponseMemoryMode mode);
    struct MHD_Response *(*from_buffer_freed)(size_t size, const void *buffer,
                                              MHD_ContentReaderFreeCallback done, void *context);
    struct MHD_Response *(*from_callback)(uint64_t size, size_t block,
                                          MHD_ContentReaderCallback read, void *context,
                                          MHD_ContentReaderFreeCallback done);
    enum MHD_Result (*add_header)(struct MHD_Response *response, const char *name,
                                  const char *value);
    enum MHD_Result (*queue)(struct MHD_Connection *connection, unsigned status,
                             struct MHD_Response *response);
    void (*destroy)(struct MHD_Response *response);
    const char *(*lookup)(struct MHD_Connection *connection, enum MHD_ValueKind kind,
                          const char *key);
    const union MHD_ConnectionInfo *(*info)(struct MHD_Connection *connection,
                                            enum MHD_ConnectionInfoType type, ...);
} functions;

struct cli_http {
    functions mhd;
    void *library;
    struct MHD_Daemon *daemon;
    int socket;
    unsigned port;
    cli_feed *feed;
    cli_guests guests;
};

// A stream of events to one page.
typedef struct stream {
    cli_feed *feed;
    uint64_t last; // id of the event that it has
    bool greeted;
} stream;

static lac_status load(cli_http *http, lac_error *err)
{
    static const struct {
        const char *name;
        size_t offset;
    } wanted[] = {
        {"MHD_start_daemon", offsetof(functions, start)},
        {"MHD_stop_daemon", offsetof(functions, stop)},
        {"MHD_create_response_from_buffer", offsetof(functions, from_buffer)},
        {"MHD_create_response_from_buffer_with_free_callback_cls",
         offsetof(functions, from_buffer_freed)},
        {"MHD_create_response_from_callback", offsetof(functions, from_callback)},
        {"MHD_add_response_header", offsetof(functions, add_header)},
        {"MHD_queue_response", offsetof(functions, queue)},
        {"MHD_destroy_response", offsetof(functions, destroy)},
        {"MHD_lookup_connection_value", offsetof(functions, lookup)},
        {"MHD_get_connection_info", offsetof(functions, info)},
    };
    http->library = dlopen("libmicrohttpd.so.12", RTLD_NOW | RTLD_LOCAL);
    for (size_t i = 0; http->library != NULL && i < sizeof wanted / sizeof *wanted; i++) {
        void *found = dlsym(http->library, wanted[i].name);
        if (found == NULL) {
            return lac_fail(err, LAC_EIO, "--view: %s", dlerror());
        }
        memcpy((char *)&http->mhd + wanted[i].offset, &found, sizeof found);
    }
    return http->library != NULL
               ? LAC_OK
               : lac_fail(err, LAC_EIO, "--view needs libmicrohttpd (Debian's libmicrohttpd12): %s",
                          dlerror());
}

static lac_status fail_port(unsigned port, lac_error *err)
{
    return errno == EADDRINUSE || errno == EACCES
               ? lac_fail(err, LAC_EINPUT,
                          "--view: port %u of 127.0.0.1: %s; name another, or none for a free one",
                          port, strerror(errno))
               : lac_fail(err, LAC_EIO, "--view: 127.0.0.1: %s", strerror(errno));
}

static lac_status listen_at(cli_http *http, unsigned port, lac_error *err)
{
    struct sockaddr_in here = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    socklen_t size = sizeof here;
    const int yes = 1;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    http->socket = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (http->socket < 0 ||
        setsockopt(http->socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) != 0 ||
        bind(http->socket, (const struct sockaddr *)&here, sizeof here) != 0 ||
        listen(http->socket, CLI_GUESTS_ROOM) != 0 ||
        getsockname(http->socket, (struct sockaddr *)&here, &size) != 0) {
        return fail_port(port, err);
    }
    http->port = ntohs(here.sin_port);
    return LAC_OK;
}

static const char *header_of(const cli_http *http, struct MHD_Connection *connection,
                             const char *name)
{
    const char *value = http->mhd.lookup(connection, MHD_HEADER_KIND, name);
    return value != NULL ? value : "";
}

// Only names of this machine: a page from elsewhere whose name is made to point here sends its own.
static bool is_local(const cli_http *http, const char *host)
{
    static const char *const names[] = {"127.0.0.1", "localhost"};
    char whole[32];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        (void)snprintf(whole, sizeof whole, "%s:%u", names[i], http->port);
        if (strcasecmp(host, whole) == 0 || (http->port == 80 && strcasecmp(host, names[i]) == 0)) {
            return true;
        }
    }
    return false;
}

typedef struct header {
    const char *name, *value;
} header;

static enum MHD_Result deliver(const cli_http *http, struct MHD_Connection *connection,
                               unsigned status, const header *more, struct MHD_Response *response)
{
    static const header always[] = {{"Cache-Control", "no-store"},
                                    {"X-Content-Type-Options", "nosniff"},
                                    {"Referrer-Policy", "no-referrer"},
                                    {"Cross-Origin-Resource-Policy", "same-origin"}};
    if (response == NULL) {
        return MHD_NO;
    }
    for (size_t i = 0; i < sizeof always / sizeof *always; i++) {
        (void)http->mhd.add_header(response, always[i].name, always[i].value);
    }
    for (; more->name != NULL; more++) {
        (void)http->mhd.add_header(response, more->name, more->value);
    }
    const enum MHD_Result done = http->mhd.queue(connection, status, response);
    http->mhd.destroy(response);
    return done;
}

// A response with a text of its own, which is freed with it; NULL without memory.
static struct MHD_Response *respond(const cli_http *http, char *text)
{
    struct MHD_Response *response =
        http->mhd.from_buffer(strlen(text), text, MHD_RESPMEM_MUST_FREE);
    if (response == NULL) {
        free(text); // it was not taken
    }
    return response;
}

#define CLOSED_POLICY "default-src 'none'; frame-ancestors 'none'"

// A line of text: what is wrong.
static enum MHD_Result refuse(const cli_http *http, struct MHD_Connection *connection,
                              unsigned status, const char *words)
{
    const header more[] = {{"Content-Type", "text/plain; charset=utf-8"},
                           {"Content-Security-Policy", CLOSED_POLICY},
                           {status == 405 ? "Allow" : NULL, "GET, HEAD"},
                           {NULL, NULL}};
    char *copy = strdup(words);
    return copy != NULL ? deliver(http, connection, status, more, respond(http, copy)) : MHD_NO;
}

static enum MHD_Result send_page(const cli_http *http, struct MHD_Connection *connection)
{
    unsigned char random[NONCE];
    char nonce[2 * NONCE + 1] = "", policy[320], *html = NULL;
    if (getrandom(random, sizeof random, 0) != (ssize_t)sizeof random) {
        return MHD_NO;
    }
    for (size_t i = 0; i < NONCE; i++) {
        (void)snprintf(nonce + 2 * i, 3, "%02x", random[i]);
    }
    (void)snprintf(policy, sizeof policy,
                   "default-src 'none'; script-src 'nonce-%s'; style-src 'nonce-%s'; "
                   "img-src data:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
                   "frame-ancestors 'none'",
                   nonce, nonce);
    const header more[] = {{"Content-Type", "text/html; charset=utf-8"},
                           {"Content-Security-Policy", policy},
                           {NULL, NULL}};
    if (lac_report_live_page(nonce, &html, NULL) != LAC_OK) {
        return MHD_NO;
    }
    return deliver(http, connection, MHD_HTTP_OK, more, respond(http, html));
}

// Data on their way: a run that has ended waits for them.
typedef struct parcel {
    cli_feed *feed;
    uint64_t version;
    char *json;
} parcel;

static void end_parcel(void *context)
{
    parcel *sent = context;
    cli_feed_taken(sent->feed, sent->version);
    free(sent->json);
    free(sent);
}

static enum MHD_Result send_data(const cli_http *http, struct MHD_Connection *connection)
{
    static const header more[] = {{"Content-Type", "application/json"},
                                  {"Content-Security-Policy", CLOSED_POLICY},
                                  {NULL, NULL}};
    parcel *sent = calloc(1, sizeof *sent);
    if (sent == NULL) {
        return MHD_NO;
    }
    sent->feed = http->feed;
    sent->json = cli_feed_take(http->feed, patience, &sent->version);
    if (sent->json == NULL) {
        free(sent);
        return refuse(http, connection, MHD_HTTP_SERVICE_UNAVAILABLE,
                      "The run has put out nothing yet.\n");
    }
    struct MHD_Response *response =
        http->mhd.from_buffer_freed(strlen(sent->json), sent->json, end_parcel, sent);
    if (response == NULL) {
        end_parcel(sent);
    }
    return deliver(http, connection, MHD_HTTP_OK, more, response);
}

// Waits for the next event, or for the time of a sign of life. Runs on the connection's own thread.
static ssize_t read_stream(void *context, uint64_t position, char *out, size_t room)
{
    stream *s = context;
    cli_feed *feed = s->feed;
    ssize_t length = 0;
    (void)position;
    (void)pthread_mutex_lock(&feed->lock);
    const char *greeting = s->greeted ? "" : "retry: 1000\n";
    bool waited = false;
    while (feed->id == s->last && !feed->ended && s->greeted && !waited) {
        waited = !cli_feed_wait(feed, heartbeat);
    }
    if (feed->id != s->last) {
        length = snprintf(out, room, "%sid: %s.%llu\nevent: state\ndata: %s\n\n", greeting,
                          feed->mark, (unsigned long long)feed->id, feed->event);
        s->last = feed->id;
    } else if (feed->ended) {
        length = MHD_CONTENT_READER_END_OF_STREAM;
    } else {
        length = snprintf(out, room, "%s: here\n\n", greeting);
    }
    s->greeted = true;
    (void)pthread_mutex_unlock(&feed->lock);
    return length < (ssize_t)room ? length : MHD_CONTENT_READER_END_WITH_ERROR;
}

static void end_stream(void *context)
{
    stream *s = context;
    (void)pthread_mutex_lock(&s->feed->lock);
    s->feed->watchers--;
    (void)pthread_mutex_unlock(&s->feed->lock);
    free(s);
}

// The event that a page has, if it was told so by this process.
static uint64_t event_of(const cli_feed *feed, const char *id)
{
    const size_t length = strlen(feed->mark);
    return strncmp(id, feed->mark, length) == 0 && id[length] == '.'
               ? strtoull(id + length + 1, NULL, 10)
               : 0;
}

// A stream that is counted; NULL: there are too many. `over`: the page has the last event already.
static stream *open_stream(cli_feed *feed, const char *last, bool *over)
{
    stream *s = malloc(sizeof *s);
    if (s == NULL) {
        return NULL;
    }
    *s = (stream){.feed = feed, .last = event_of(feed, last)};
    (void)pthread_mutex_lock(&feed->lock);
    s->last = s->last <= feed->id ? s->last : 0;
    *over = feed->ended && s->last == feed->id;
    const bool fits = feed->watchers < STREAMS && !*over;
    feed->watchers += fits ? 1 : 0;
    (void)pthread_cond_broadcast(&feed->changed);
    (void)pthread_mutex_unlock(&feed->lock);
    if (!fits) {
        free(s);
        return NULL;
    }
    return s;
}

static enum MHD_Result send_events(cli_http *http, struct MHD_Connection *connection, bool head)
{
    static const header more[] = {{"Content-Type", "text/event-stream"},
                                  {"Content-Security-Policy", CLOSED_POLICY},
                                  {NULL, NULL}};
    bool over = false;
    if (head) {
        return deliver(http, connection, MHD_HTTP_OK, more,
                       http->mhd.from_buffer(0, NULL, MHD_RESPMEM_PERSISTENT));
    }
    stream *s = open_stream(http->feed, header_of(http, connection, "Last-Event-ID"), &over);
    if (s == NULL) {
        return over ? refuse(http, connection, MHD_HTTP_NO_CONTENT, "")
                    : refuse(http, connection, MHD_HTTP_SERVICE_UNAVAILABLE,
                             "Too many pages watch this run.\n");
    }
    const union MHD_ConnectionInfo *info =
        http->mhd.info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);
    cli_guests_watch(&http->guests, info != NULL ? info->socket_context : NULL);
    struct MHD_Response *response =
        http->mhd.from_callback(MHD_SIZE_UNKNOWN, BLOCK, read_stream, s, end_stream);
    if (response == NULL) {
        end_stream(s);
    }
    return deliver(http, connection, MHD_HTTP_OK, more, response);
}

static enum MHD_Result answer(void *context, struct MHD_Connection *connection, const char *url,
                              const char *method, const char *version, const char *upload,
                              size_t *upload_size, void **memory)
{
    cli_http *http = context;
    const bool head = strcmp(method, MHD_HTTP_METHOD_HEAD) == 0;
    (void)version;
    (void)upload;
    if (*memory == NULL) { // the headers alone: what follows them may be refused unread
        *memory = connection;
        if (!is_local(http, header_of(http, connection, "Host"))) {
            return refuse(http, connection, MHD_HTTP_FORBIDDEN,
                          "This page is at 127.0.0.1 and localhost alone.\n");
        }
        if (!head && strcmp(method, MHD_HTTP_METHOD_GET) != 0) {
            return refuse(http, connection, MHD_HTTP_METHOD_NOT_ALLOWED, "Only GET and HEAD.\n");
        }
        return MHD_YES;
    }
    if (*upload_size > 0) {
        *upload_size = 0;
        return MHD_YES;
    }
    if (strcmp(url, "/") == 0) {
        return send_page(http, connection);
    }
    if (strcmp(url, "/data") == 0) {
        return send_data(http, connection);
    }
    return strcmp(url, "/events") == 0
               ? send_events(http, connection, head)
               : refuse(http, connection, MHD_HTTP_NOT_FOUND, "There is /, /data and /events.\n");
}

// A path is compared as it was sent: what %00 and %2f would hide is no name here.
static size_t leave_as_it_is(void *context, struct MHD_Connection *connection, char *text)
{
    (void)context;
    (void)connection;
    return strlen(text);
}

static void note_guest(void *context, struct MHD_Connection *connection, void **guest,
                       enum MHD_ConnectionNotificationCode code)
{
    cli_http *http = context;
    if (code == MHD_CONNECTION_NOTIFY_CLOSED) {
        cli_guests_leave(&http->guests, *guest);
        *guest = NULL;
        return;
    }
    const union MHD_ConnectionInfo *info =
        http->mhd.info(connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    *guest = info != NULL ? cli_guests_enter(&http->guests, info->connect_fd) : NULL;
}

// Its threads take no signals: those are the run's.
static struct MHD_Daemon *start_daemon(cli_http *http)
{
    sigset_t all, before;
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    struct MHD_Daemon *daemon = http->mhd.start(
        MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_THREAD_PER_CONNECTION | MHD_USE_POLL, 0, NULL,
        NULL, answer, http, MHD_OPTION_LISTEN_SOCKET, http->socket, MHD_OPTION_CONNECTION_LIMIT,
        (unsigned)CLI_GUESTS_ROOM, MHD_OPTION_CONNECTION_TIMEOUT, (unsigned)IDLE,
        MHD_OPTION_NOTIFY_CONNECTION, note_guest, http, MHD_OPTION_UNESCAPE_CALLBACK,
        leave_as_it_is, NULL, MHD_OPTION_END);
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    return daemon;
}

lac_status cli_http_start(unsigned port, cli_feed *feed, cli_http **out, lac_error *err)
{
    lac_status status;
    cli_http *http = calloc(1, sizeof *http);
    *out = http;
    if (http == NULL) {
        return lac_fail_memory(err);
    }
    http->feed = feed;
    http->socket = -1;
    cli_guests_create(&http->guests);
    LAC_TRY(load(http, err));
    LAC_TRY(http->mhd.start != NULL ? LAC_OK : LAC_EIO); // load() found them all
    LAC_TRY(listen_at(http, port, err));
    http->daemon = start_daemon(http);
    LAC_TRY(http->daemon != NULL
                ? LAC_OK
                : lac_fail(err, LAC_EIO, "--view: no server: %s", strerror(errno)));
out:
    if (status != LAC_OK) {
        cli_http_stop(http);
        *out = NULL;
    }
    return status;
}

unsigned cli_http_port(const cli_http *http) { return http->port; }

void cli_http_stop(cli_http *http)
{
    if (http == NULL) {
        return;
    }
    cli_feed_close(http->feed);
    if (http->daemon != NULL) {
        http->mhd.stop(http->daemon); // closes the socket too
    } else if (http->socket >= 0) {
        (void)close(http->socket);
    }
    if (http->library != NULL) {
        (void)dlclose(http->library);
    }
    cli_guests_clear(&http->guests);
    free(http);
}
