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

// How many of rows first ... first + n - 1 a strip has.
static size_t share(const lac_strip *strip, size_t first, size_t n)
{
    const size_t low = first > strip->first ? first : strip->first;
    const size_t end = first + n < strip->first + strip->n ? first + n : strip->first + strip->n;
    return end > low ? end - low : 0;
}

void lac_strip_exchange(const lac_strip *strip, const uint64_t wants[][2], size_t size,
                        const void *rows, void *out)
{
    const lac_team *team = strip->team;
    lac_piece give[LAC_TEAM_MOST], take[LAC_TEAM_MOST];
    char *to = out;
    for (int rank = 0; rank < team->ranks; rank++) {
        const lac_strip of = lac_strip_at(strip, rank);
        const size_t first = wants[rank][0] > strip->first ? wants[rank][0] - strip->first : 0;
        const size_t gives = share(strip, wants[rank][0], wants[rank][1]);
        give[rank] = (lac_piece){(char *)rows + (gives > 0 ? first * size : 0), gives * size};
        take[rank].at = to;
        take[rank].n = share(&of, wants[team->rank][0], wants[team->rank][1]) * size;
        to += take[rank].n;
    }
    team->exchange(team, give, take);
}

const void *lac_strip_bring(const lac_strip *strip, size_t first, size_t n, size_t size,
                            const void *rows, void **made)
{
    uint64_t wants[LAC_TEAM_MOST][2] = {{0}};
    lac_team *team = strip->team;
    *made = NULL;
    if (team == NULL) {
        return (const char *)rows + first * size;
    }
    wants[team->rank][0] = first;
    wants[team->rank][1] = n;
    team->join(team, wants[0], 2 * (size_t)team->ranks);
    *made = lac_team_alloc(team, n * size);
    if (*made != NULL) {
        lac_strip_exchange(strip, (const uint64_t(*)[2])wants, size, rows, *made);
    }
    return *made;
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

double lac_strip_sum(const lac_strip *strip, size_t n, const double *x, double over)
{
    double sum = 0.0;
    lac_team_relay(strip->team, add, &(summands){x, n, over}, &sum, 1);
    return sum;
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
    memset(c->plane, 0, plane);
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

// Columns of a matrix as lines, or as rows of a grain. @param size  of an item, in numbers
static void pack_matrix(const lac_turn *c, const lac_strip *of, size_t size,
                        const lac_turn_use *use, double *packet, bool back)
{
    const size_t down = c->lead > 0 ? size : of->grain * size;
    const size_t across = c->lead > 0 ? c->rows.n * size : size;
    memset(packet, 0, back || c->lead > 0 ? 0 : c->rows.n * down * sizeof *packet);
    for (size_t j = 0; j < c->rows.n; j++) {
        for (size_t k = 0; k < of->n; k++) {
            double *at = (double *)use->matrix + (j * use->stride + of->first + k) * size;
            double *packed = packet + j * down + k * across;
            const double *from = back ? packed : at;
            double *to = back ? at : packed;
            for (size_t i = 0; i < size; i++) {
                to[i] = from[i];
            }
        }
    }
}

// What goes to each rank, or came back from it.
static void pack_all(const lac_turn *c, const lac_strip *columns, size_t round,
                     const lac_piece *away, size_t size, const lac_turn_use *use, bool back)
{
    for (int rank = 0; rank < c->rows.team->ranks; rank++) {
        const lac_strip of = of_round(columns, rank, round);
        if (of.n > 0 && use->pack == NULL) {
            pack_matrix(c, &of, size / sizeof(double), use, away[rank].at, back);
        } else if (of.n > 0) {
            use->pack(use->context, of.first, of.n, away[rank].at, back);
        }
    }
}

static void one_round(const lac_turn *c, const lac_strip *columns, size_t round, size_t size,
                      const lac_turn_use *use)
{
    lac_piece away[LAC_TEAM_MOST], home[LAC_TEAM_MOST];
    const lac_team *team = c->rows.team;
    const lac_strip own = of_round(columns, team->rank, round);
    char *packet = c->packet, *come = c->lead > 0 ? c->come : c->plane;
    for (int rank = 0; rank < team->ranks; rank++) {
        const lac_strip of = of_round(columns, rank, round), rows = lac_strip_at(&c->rows, rank);
        const size_t wide = c->lead > 0 || of.n == 0 ? of.n : of.grain;
        const size_t wide_here = c->lead > 0 || own.n == 0 ? own.n : own.grain;
        away[rank] = (lac_piece){packet, wide * c->rows.n * size};
        home[rank] = (lac_piece){come, wide_here * rows.n * size};
        packet += away[rank].n;
        come += home[rank].n;
    }
    pack_all(c, columns, round, away, size, use, false);
    team->exchange(team, away, home);
    lay(c, own.n, size, false);
    if (own.n > 0) {
        use->work(use->context, own.first, own.n, c->plane);
    }
    if (use->returns) {
        lay(c, own.n, size, true);
        team->exchange(team, home, away);
        pack_all(c, columns, round, away, size, use, true);
    }
}

void lac_turn_pass(const lac_turn *c, const lac_strip *columns, size_t size,
                   const lac_turn_use *use)
{
    const size_t most = lac_strip_at(columns, 0).n; // no other rank has more
    for (size_t round = 0; round * columns->grain < most; round++) {
        one_round(c, columns, round, size, use);
    }
}
