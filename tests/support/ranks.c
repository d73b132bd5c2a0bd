// SPDX-License-Identifier: GPL-3.0-or-later
// A team of threads, of which one at a time does something, until all meet: FFTW's planner allows
// no more.
#include "support/ranks.h"

#include <pthread.h>

#include "support/test.h"

enum { MOST = 16 };

// What all ranks meet at.
typedef struct meeting {
    pthread_barrier_t all;
    pthread_mutex_t one;
    size_t exchanged;
    uint64_t *words[MOST]; // of each
    const lac_piece *given[MOST];
} meeting;

typedef struct member {
    lac_team team;
    void (*body)(lac_team *team, void *context);
    void *context;
    pthread_t thread;
} member;

static void meet(meeting *at)
{
    (void)pthread_mutex_unlock(&at->one);
    (void)pthread_barrier_wait(&at->all);
    (void)pthread_mutex_lock(&at->one);
}

static void join(const lac_team *team, uint64_t *words, size_t n)
{
    meeting *at = team->context;
    uint64_t *joined = reallocarray(NULL, n + 1, sizeof *joined); // a test has malloc fail
    assert_non_null(joined);
    memset(joined, 0, (n + 1) * sizeof *joined);
    at->words[team->rank] = words;
    meet(at);
    for (int rank = 0; rank < team->ranks; rank++) {
        for (size_t i = 0; i < n; i++) {
            joined[i] |= at->words[rank][i];
        }
    }
    meet(at);
    memcpy(words, joined, n * sizeof *words);
    free(joined);
}

static void exchange(const lac_team *team, const lac_piece *give, const lac_piece *take)
{
    meeting *at = team->context;
    at->given[team->rank] = give;
    meet(at);
    for (int rank = 0; rank < team->ranks; rank++) {
        const lac_piece *given = &at->given[rank][team->rank];
        assert_int_equal(given->n, take[rank].n);
        if (given->n > 0) {
            memcpy(take[rank].at, given->at, given->n);
        }
        at->exchanged += rank != team->rank ? given->n : 0;
    }
    meet(at);
}

static void *work_as(void *context)
{
    member *m = context;
    meeting *at = m->team.context;
    (void)pthread_mutex_lock(&at->one);
    m->body(&m->team, m->context);
    (void)pthread_mutex_unlock(&at->one);
    return NULL;
}

size_t ranks_do(int ranks, void (*body)(lac_team *team, void *context), void *context)
{
    meeting at = {.exchanged = 0};
    member of[MOST];
    if (ranks == 0) {
        body(NULL, context);
        return 0;
    }
    assert_true(ranks <= MOST);
    pthread_barrier_init(&at.all, NULL, (unsigned)ranks);
    pthread_mutex_init(&at.one, NULL);
    for (int r = 0; r < ranks; r++) {
        of[r] = (member){{.rank = r, .ranks = ranks, .context = &at}, body, context, 0};
        of[r].team.join = join;
        of[r].team.exchange = exchange;
        assert_int_equal(pthread_create(&of[r].thread, NULL, work_as, &of[r]), 0);
    }
    for (int r = 0; r < ranks; r++) {
        pthread_join(of[r].thread, NULL);
    }
    pthread_barrier_destroy(&at.all);
    pthread_mutex_destroy(&at.one);
    return at.exchanged;
}
