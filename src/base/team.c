// SPDX-License-Identifier: GPL-3.0-or-later
// What processes that share a case tell each other. One alone has nobody to ask.
#include "base/team.h"

_Static_assert(sizeof(double) == sizeof(uint64_t), "numbers are joined as words");

void lac_team_join(const lac_team *team, double *x, size_t n)
{
    if (team != NULL) {
        team->join(team, (uint64_t *)(void *)x, n);
    }
}

void lac_team_relay(const lac_team *team, lac_team_part *part, void *context, double *values,
                    size_t n)
{
    for (int rank = 0; rank < (team != NULL ? team->ranks : 1); rank++) {
        if (team == NULL || team->rank == rank) {
            part(context, values);
        } else {
            memset(values, 0, n * sizeof *values);
        }
        lac_team_join(team, values, n);
    }
}

void lac_team_follow(const lac_team *team, void *word)
{
    if (team != NULL) {
        memset(word, 0, team->rank > 0 ? sizeof(uint64_t) : 0);
        team->join(team, word, 1);
    }
}

bool lac_team_any(const lac_team *team, bool here)
{
    uint64_t word = here ? 1 : 0;
    if (team != NULL) {
        team->join(team, &word, 1);
    }
    return word != 0;
}

double lac_team_most(const lac_team *team, double here)
{
    if (team == NULL) {
        return here;
    }
    double all[LAC_TEAM_MOST] = {0}, most = here;
    all[team->rank] = here;
    lac_team_join(team, all, (size_t)team->ranks);
    for (int i = 0; i < team->ranks && !isnan(most); i++) {
        most = all[i] <= most ? most : all[i];
    }
    return most;
}

lac_status lac_team_agree(lac_team *team, lac_status here, lac_error *err)
{
    if (team == NULL || team->over) {
        return here;
    }
    uint64_t all[LAC_TEAM_MOST] = {0};
    union {
        lac_error error;
        uint64_t words[sizeof(lac_error) / sizeof(uint64_t)];
    } said = {0};
    const size_t n = (size_t)team->ranks;
    size_t first = 0;
    all[team->rank] = (uint64_t)here;
    if (team->fare != NULL) {
        team->fare(team, all, here, err);
    } else {
        team->join(team, all, n);
    }
    while (first < n && all[first] == LAC_OK) {
        first++;
    }
    if (first == n) {
        return LAC_OK;
    }
    if ((size_t)team->rank == first && err != NULL) {
        said.error = *err;
    }
    team->join(team, said.words, sizeof said.words / sizeof *said.words);
    if (err != NULL) {
        *err = said.error;
    }
    team->over = true;
    return (lac_status)all[first];
}

void *lac_team_alloc(lac_team *team, size_t bytes)
{
    void *here = calloc(bytes + 1, 1);
    if (lac_team_all(team, here != NULL)) {
        return here;
    }
    free(here);
    return NULL;
}
