// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of a grid shared out among ranks, and its columns, for which they hand each other parts.
#include "base/strip.h"

// The first of the rows of a rank.
static size_t begin_of(const lac_strip *strip, int rank)
{
    const size_t ranks = (size_t)strip->team->ranks;
    const size_t begin = (strip->grains * (size_t)rank + ranks - 1) / ranks * strip->grain;
    return begin < strip->all ? begin : strip->all;
}

lac_strip lac_strip_at(const lac_strip *strip, int rank)
{
    lac_strip at = *strip;
    if (at.team != NULL) {
        at.first = begin_of(strip, rank);
        at.n = begin_of(strip, rank + 1) - at.first;
    }
    return at;
}

lac_strip lac_strip_like(const lac_strip *strip, size_t all, size_t grain)
{
    const lac_strip like = {strip->team, all, grain, strip->grains, 0, all};
    return lac_strip_at(&like, like.team != NULL ? like.team->rank : 0);
}

lac_strip lac_strip_of(lac_team *team, size_t all, size_t grain)
{
    const lac_strip strip = {.team = team, .grains = (all + grain - 1) / grain};
    return lac_strip_like(&strip, all, grain);
}

int lac_strip_owner(const lac_strip *strip, size_t row)
{
    const size_t ranks = strip->team != NULL ? (size_t)strip->team->ranks : 1;
    return (int)(row / strip->grain * ranks / strip->grains);
}

size_t lac_strip_share(const lac_strip *strip, size_t first, size_t n)
{
    const size_t low = first > strip->first ? first : strip->first;
    const size_t end = first + n < strip->first + strip->n ? first + n : strip->first + strip->n;
    return end > low ? end - low : 0;
}

// What ranks want may overlap: it is put behind each other.
lac_status lac_strip_bring(const lac_strip *strip, size_t first, size_t n, size_t size,
                           const void *rows, const void **out, void **made, lac_error *err)
{
    uint64_t wants[LAC_TEAM_MOST][2] = {{0}}; // first row and number
    size_t sent[LAC_TEAM_MOST] = {0}, taken[LAC_TEAM_MOST] = {0}, total = 0;
    lac_team *team = strip->team;
    *made = NULL;
    *out = (const char *)rows + (team == NULL ? first * size : 0);
    if (team == NULL) {
        return LAC_OK;
    }
    wants[team->rank][0] = first;
    wants[team->rank][1] = n;
    team->join(team, wants[0], 2 * (size_t)team->ranks);
    for (int rank = 0; rank < team->ranks; rank++) {
        const lac_strip of = lac_strip_at(strip, rank);
        taken[rank] = lac_strip_share(&of, first, n) * size;
        sent[rank] = lac_strip_share(strip, wants[rank][0], wants[rank][1]) * size;
        total += sent[rank];
    }
    char *packet = malloc(total + 1);
    *out = *made = malloc(n * size + 1);
    const bool room = *made != NULL && packet != NULL; // on every rank, or none hands over
    const lac_status status = lac_team_room(team, room, err);
    total = 0;
    for (int rank = 0; status == LAC_OK && rank < team->ranks; rank++) {
        const size_t from = wants[rank][0] > strip->first ? wants[rank][0] - strip->first : 0;
        memcpy(packet + total, (const char *)rows + (sent[rank] > 0 ? from * size : 0), sent[rank]);
        total += sent[rank];
    }
    if (status == LAC_OK) {
        team->exchange(team, packet, sent, *made, taken);
    }
    free(packet);
    LAC_MADE(status, made, free);
}

// Numbers over so many.
typedef struct summands {
    const double *x;
    size_t n;
    double over;
} summands;

static void add(void *context, double *sum)
{
    const summands *s = context;
    for (size_t i = 0; i < s->n; i++) {
        *sum += s->x[i] / s->over;
    }
}

static double total(const lac_strip *strip, summands of)
{
    double sum = 0.0;
    lac_team_relay(strip->team, add, &of, &sum, 1);
    return sum;
}

double lac_strip_sum(const lac_strip *strip, size_t n, const double *x)
{
    return total(strip, (summands){x, n, 1.0});
}

double lac_strip_mean(const lac_strip *strip, size_t nx, const double *x)
{
    return total(strip, (summands){x, strip->n * nx, (double)(strip->all * nx)});
}

lac_status lac_turn_create(const lac_strip *rows, size_t lead, size_t grain_bytes, lac_turn **out,
                           lac_error *err)
{
    lac_turn *c = calloc(1, sizeof *c);
    *out = c;
    LAC_FAIL_MEMORY_IF(c == NULL, err);
    c->rows = *rows;
    c->lead = lead;
    const size_t plane = grain_bytes * (lead > 0 ? lead : rows->all);
    c->packet = malloc(grain_bytes * rows->n * (size_t)rows->team->ranks + 1);
    c->come = malloc(grain_bytes * rows->all + 1);
    c->plane = aligned_alloc(64, (plane + 64) / 64 * 64);
    LAC_FAIL_MEMORY_IF(c->packet == NULL || c->come == NULL || c->plane == NULL, err);
    return LAC_OK;
}

void lac_turn_free(lac_turn *c)
{
    if (c != NULL) {
        free(c->packet);
        free(c->come);
        free(c->plane);
        free(c);
    }
}

// The columns of a round that a rank has.
static lac_strip of_round(const lac_strip *columns, int rank, size_t round)
{
    lac_strip at = lac_strip_at(columns, rank);
    const size_t done = round * at.grain < at.n ? round * at.grain : at.n;
    at.first += done;
    at.n = at.n - done < at.grain ? at.n - done : at.grain;
    return at;
}

// What came, packet after packet, into the plane, or back.
static void lay(const lac_turn *c, size_t width, size_t size, bool back)
{
    char *packet = c->come;
    for (int rank = 0; rank < c->rows.team->ranks && c->lead > 0; rank++) {
        const lac_strip rows = lac_strip_at(&c->rows, rank);
        for (size_t k = 0; k < width; k++) {
            char *to = c->plane + (k * c->lead + rows.first) * size;
            memcpy(back ? packet : to, back ? to : packet, rows.n * size);
            packet += rows.n * size;
        }
    }
}

// What goes to each rank, or came back from it. @param away  [ranks] bytes
static void pack_all(const lac_turn *c, const lac_strip *columns, size_t round, const size_t *away,
                     const lac_turn_use *use, bool back)
{
    char *packet = c->packet;
    for (int rank = 0; rank < c->rows.team->ranks; rank++) {
        const lac_strip of = of_round(columns, rank, round);
        if (away[rank] > 0) {
            use->pack(use->context, of.first, of.n, packet, back);
        }
        packet += away[rank];
    }
}

static void one_round(const lac_turn *c, const lac_strip *columns, size_t round, size_t size,
                      const lac_turn_use *use)
{
    size_t away[LAC_TEAM_MOST] = {0}, home[LAC_TEAM_MOST] = {0};
    const lac_team *team = c->rows.team;
    const lac_strip own = of_round(columns, team->rank, round);
    char *come = c->lead > 0 ? c->come : c->plane;
    for (int rank = 0; rank < team->ranks; rank++) {
        const lac_strip of = of_round(columns, rank, round), rows = lac_strip_at(&c->rows, rank);
        const size_t wide = c->lead > 0 || of.n == 0 ? of.n : of.grain;
        away[rank] = wide * c->rows.n * size;
        home[rank] = (c->lead > 0 || own.n == 0 ? own.n : own.grain) * rows.n * size;
    }
    pack_all(c, columns, round, away, use, false);
    team->exchange(team, c->packet, away, come, home);
    lay(c, own.n, size, false);
    if (own.n > 0) {
        use->work(use->context, own.first, own.n, c->plane);
    }
    if (use->returns) {
        lay(c, own.n, size, true);
        team->exchange(team, come, home, c->packet, away);
        pack_all(c, columns, round, away, use, true);
    }
}

void lac_turn_pass(const lac_turn *c, const lac_strip *columns, size_t size,
                   const lac_turn_use *use)
{
    size_t most = 0;
    for (int rank = 0; rank < columns->team->ranks; rank++) {
        const size_t n = lac_strip_at(columns, rank).n;
        most = n > most ? n : most;
    }
    for (size_t round = 0; round * columns->grain < most; round++) {
        one_round(c, columns, round, size, use);
    }
}
