// SPDX-License-Identifier: GPL-3.0-or-later
// The server of `lacuna run --view`: two resources, both made in memory. No request names a file.
// One thread, which never waits for a connection: a slow one costs its place alone.
#include "cli/view/view.h"

#include <dlfcn.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <signal.h>
#include <stdatomic.h>
#include <strings.h>
#include <sys/random.h>
#include <sys/socket.h>

#include "report/report.h"

// Connections that stay beside one another, and room for those that are being shown out; seconds
// after which a silent one is closed, more than a hidden page lets pass between two questions.
enum { GUESTS = 32, ROOM = 2 * GUESTS, IDLE = 10, NONCE = 16 };

// The library is loaded for --view alone: linked, it would cost every run its start-up.
#define FUNCTIONS(X)                            \
    X(start, start_daemon)                      \
    X(stop, stop_daemon)                        \
    X(from_buffer, create_response_from_buffer) \
    X(add_header, add_response_header)          \
    X(queue, queue_response)                    \
    X(destroy, destroy_response)                \
    X(lookup, lookup_connection_value)          \
    X(daemon_info, get_daemon_info)             \
    X(info, get_connection_info)

typedef struct functions {
#define MEMBER(name, function) __typeof__(MHD_##function) *(name);
    FUNCTIONS(MEMBER)
} functions;

// One connection.
typedef struct guest {
    bool here, out; // it was shown out, and is about to go
    bool waits;     // a page that has not been sent the last data
    bool told;      // they are on their way to it
    int socket;
    uint64_t order; // of its last question
} guest;

struct cli_http {
    cli_http_data *data;
    void *context;
    functions mhd;
    void *library;
    struct MHD_Daemon *daemon;
    atomic_size_t waiting; // of the guests
    // The server's thread alone:
    uint64_t next;
    guest guest[ROOM];
};

static lac_status load(cli_http *http, lac_error *err)
{
    static const char *const wanted[] = {
#define WANTED(name, function) "MHD_" #function,
        FUNCTIONS(WANTED)};
    http->library = dlopen("libmicrohttpd.so.12", RTLD_NOW | RTLD_LOCAL);
    for (size_t i = 0; http->library != NULL && i < sizeof wanted / sizeof *wanted; i++) {
        void *found = dlsym(http->library, wanted[i]);
        LAC_FAIL_IF(found == NULL, err, LAC_EIO, "--view: %s", dlerror());
        memcpy((char *)&http->mhd + i * sizeof found, &found, sizeof found);
    }
    return http->library != NULL
               ? LAC_OK
               : lac_fail(err, LAC_EIO, "--view needs libmicrohttpd (Debian's libmicrohttpd12): %s",
                          dlerror());
}

static unsigned port_of(const cli_http *http, struct MHD_Daemon *daemon)
{
    return http->mhd.daemon_info(daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
}

// Only names of this machine: a page from elsewhere whose name is made to point here sends its own.
static bool is_local(const cli_http *http, struct MHD_Connection *connection)
{
    static const char *const names[] = {"127.0.0.1", "localhost"};
    const char *host = http->mhd.lookup(connection, MHD_HEADER_KIND, "Host");
    const unsigned port =
        port_of(http, http->mhd.info(connection, MHD_CONNECTION_INFO_DAEMON)->daemon);
    char whole[32];
    for (size_t i = 0; host != NULL && i < sizeof names / sizeof *names; i++) {
        (void)snprintf(whole, sizeof whole, "%s:%u", names[i], port);
        if (strcasecmp(host, whole) == 0 || (port == 80 && strcasecmp(host, names[i]) == 0)) {
            return true;
        }
    }
    return false;
}

// Sends a text of its own, which is freed; nothing where there is no memory for it.
static enum MHD_Result deliver(const cli_http *http, struct MHD_Connection *connection,
                               unsigned status, const char *type, const char *policy, char *text)
{
    const char *const headers[][2] = {{"Content-Type", type},
                                      {"Content-Security-Policy", policy},
                                      {"Cache-Control", "no-store"},
                                      {"X-Content-Type-Options", "nosniff"},
                                      {"Referrer-Policy", "no-referrer"},
                                      {"Cross-Origin-Resource-Policy", "same-origin"},
                                      {"Allow", "GET, HEAD"}};
    const size_t count = sizeof headers / sizeof *headers - (status == 405 ? 0 : 1);
    struct MHD_Response *response =
        text != NULL ? http->mhd.from_buffer(strlen(text), text, MHD_RESPMEM_MUST_FREE) : NULL;
    if (response == NULL) {
        free(text);
        return MHD_NO;
    }
    for (size_t i = 0; i < count; i++) {
        (void)http->mhd.add_header(response, headers[i][0], headers[i][1]);
    }
    const enum MHD_Result done = http->mhd.queue(connection, status, response);
    http->mhd.destroy(response);
    return done;
}

#define CLOSED_POLICY "default-src 'none'; frame-ancestors 'none'"

static enum MHD_Result refuse(const cli_http *http, struct MHD_Connection *connection,
                              unsigned status, const char *words)
{
    return deliver(http, connection, status, "text/plain; charset=utf-8", CLOSED_POLICY,
                   strdup(words));
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
    (void)snprintf(
        policy, sizeof policy,
        "default-src 'none'; script-src 'nonce-%s'; style-src 'nonce-%s'; img-src data:; "
        "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
        nonce, nonce);
    (void)lac_page_live_page(nonce, &html, NULL); // NULL where it fails
    return deliver(http, connection, MHD_HTTP_OK, "text/html; charset=utf-8", policy, html);
}

// Slow ones must not keep others out: one more than there is room for shuts the one that has been
// silent longest.
static void make_room(cli_http *http)
{
    size_t count = 0;
    guest *out = NULL;
    for (guest *g = http->guest; g < http->guest + ROOM; g++) {
        const bool stays = g->here && !g->out;
        count += stays;
        out = stays && (out == NULL || g->order < out->order) ? g : out;
    }
    if (count > GUESTS) {
        (void)shutdown(out->socket, SHUT_RDWR);
        out->out = true;
    }
}

static void count_waiting(cli_http *http)
{
    size_t pages = 0;
    for (const guest *g = http->guest; g < http->guest + ROOM; g++) {
        pages += g->waits ? 1 : 0;
    }
    atomic_store(&http->waiting, pages);
}

static void on_connection(void *context, struct MHD_Connection *connection, void **place,
                          enum MHD_ConnectionNotificationCode code)
{
    cli_http *http = context;
    guest *g = *place;
    if (code == MHD_CONNECTION_NOTIFY_STARTED) {
        for (g = http->guest; g->here && g < http->guest + ROOM - 1; g++) {
        } // the library lets in no more than there is room for
        *g = (guest){.here = true,
                     .socket =
                         http->mhd.info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd,
                     .order = ++http->next};
        *place = g;
        make_room(http);
    } else if (g != NULL) {
        *g = (guest){0};
        count_waiting(http);
    }
}

static guest *guest_of(const cli_http *http, struct MHD_Connection *connection)
{
    return http->mhd.info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT)->socket_context;
}

static void on_completed(void *context, struct MHD_Connection *connection, void **memory,
                         enum MHD_RequestTerminationCode how)
{
    cli_http *http = context;
    guest *g = guest_of(http, connection);
    (void)memory;
    g->waits = g->waits && !(g->told && how == MHD_REQUEST_TERMINATED_COMPLETED_OK);
    g->told = false;
    count_waiting(http);
}

// A page that names no version that it has is given the newest data.
static enum MHD_Result send_data(cli_http *http, struct MHD_Connection *connection, bool head)
{
    const char *since = http->mhd.lookup(connection, MHD_GET_ARGUMENT_KIND, "since");
    guest *g = guest_of(http, connection);
    const bool number =
        since != NULL && *since != '\0' && since[strspn(since, "0123456789")] == '\0';
    g->waits = g->waits || (since != NULL && !head);
    count_waiting(http);
    char *json =
        http->data(http->context, number ? strtoull(since, NULL, 10) : UINT64_MAX, &g->told);
    g->told = g->told && !head;
    return deliver(http, connection, MHD_HTTP_OK, "application/json", CLOSED_POLICY, json);
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
        guest_of(http, connection)->order = ++http->next;
        if (!is_local(http, connection)) {
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
    return strcmp(url, "/") == 0 ? send_page(http, connection)
           : strcmp(url, "/data") == 0
               ? send_data(http, connection, head)
               : refuse(http, connection, MHD_HTTP_NOT_FOUND, "There is / and /data.\n");
}

// A path is compared as it was sent: what %00 and %2f would hide is no name here.
static size_t leave_as_it_is(void *context, struct MHD_Connection *connection, char *text)
{
    (void)context;
    (void)connection;
    return strlen(text);
}

// Its thread takes no signals: those are the run's.
static lac_status start(cli_http *http, unsigned port, lac_error *err)
{
    struct sockaddr_in here = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    sigset_t all, before;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    (void)sigfillset(&all);
    (void)pthread_sigmask(SIG_SETMASK, &all, &before);
    http->daemon = http->mhd.start(
        MHD_USE_INTERNAL_POLLING_THREAD | MHD_USE_POLL | MHD_USE_ITC, 0, NULL, NULL, answer, http,
        MHD_OPTION_SOCK_ADDR, (const struct sockaddr *)&here, MHD_OPTION_CONNECTION_LIMIT,
        (unsigned)ROOM, MHD_OPTION_CONNECTION_TIMEOUT, (unsigned)IDLE, MHD_OPTION_NOTIFY_CONNECTION,
        on_connection, http, MHD_OPTION_NOTIFY_COMPLETED, on_completed, http,
        MHD_OPTION_UNESCAPE_CALLBACK, leave_as_it_is, NULL, MHD_OPTION_END);
    (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
    LAC_FAIL_IF(http->daemon == NULL && (errno == EADDRINUSE || errno == EACCES), err, LAC_EINPUT,
                "--view: port %u of 127.0.0.1: %s; name another, or none for a free one", port,
                strerror(errno));
    LAC_FAIL_IF(http->daemon == NULL, err, LAC_EIO, "--view: 127.0.0.1: %s", strerror(errno));
    return LAC_OK;
}

lac_status cli_http_start(unsigned port, cli_http_data *data, void *context, cli_http **out,
                          lac_error *err)
{
    lac_status status;
    cli_http *http = calloc(1, sizeof *http);
    *out = http;
    LAC_FAIL_MEMORY_IF(http == NULL, err);
    http->data = data;
    http->context = context;
    LAC_TRY(load(http, err));
    LAC_TRY(http->mhd.start != NULL ? LAC_OK : LAC_EIO); // load() found them all
    LAC_TRY(start(http, port, err));
out:
    LAC_MADE(status, out, cli_http_stop);
}

unsigned cli_http_port(const cli_http *http) { return port_of(http, http->daemon); }

size_t cli_http_waiting(const cli_http *http) { return atomic_load(&http->waiting); }

void cli_http_stop(cli_http *http)
{
    if (http == NULL) {
        return;
    }
    if (http->daemon != NULL) {
        http->mhd.stop(http->daemon);
    }
    if (http->library != NULL) {
        (void)dlclose(http->library);
    }
    free(http);
}
