// SPDX-License-Identifier: GPL-3.0-or-later
// lacuna-mpi: the ranks of an MPI job as a team. Nothing else knows of MPI.
#include <fcntl.h>
#include <math.h>
#include <mpi.h>
#include <signal.h>
#include <unistd.h>

#include "cli/common/command.h"
#include "cli/common/progress.h"
#include "cli/team/team.h"

typedef struct ranks {
    lac_team team;
    int heard;      // standard error, where it still is
    MPI_Comm apart; // where they agree
    double begun;   // [s]
} ranks;

const char cli_team_help[] =
    "\nRanks of an MPI job share run, contact and check, to the bits of lacuna:\n"
    "  mpirun -np 8 lacuna-mpi run CASE\n"
    "check says how many help, and what memory each takes. One rank does all else.\n";

enum { NOTICE = 1 };      // the tag of an error
enum { PIECE = 1 << 27 }; // of what MPI counts in an int; in bytes it fits one, too

static int piece_of(size_t n) { return (int)(n < PIECE ? n : PIECE); }

static void join(const lac_team *team, uint64_t *words, size_t n)
{
    (void)team;
    for (size_t at = 0; at < n; at += PIECE) {
        const int count = piece_of(n - at);
        (void)MPI_Allreduce(MPI_IN_PLACE, words + at, count, MPI_UINT64_T, MPI_BOR, MPI_COMM_WORLD);
    }
}

// With the next rank and the one before, then with those two away, and so on round; who has
// nothing to say is not spoken to.
static void exchange(const lac_team *team, const lac_piece *give, const lac_piece *take)
{
    const int all = team->ranks, own = team->rank;
    if (give[own].n > 0) {
        memcpy(take[own].at, give[own].at, give[own].n);
    }
    for (int step = 1; step < all; step++) {
        const int next = (own + step) % all, last = (own + all - step) % all;
        const size_t sent = give[next].n, taken = take[last].n;
        for (size_t at = 0; at < sent || at < taken; at += PIECE) {
            const size_t gives = at < sent ? sent - at : 0, takes = at < taken ? taken - at : 0;
            (void)MPI_Sendrecv((char *)give[next].at + (gives > 0 ? at : 0), piece_of(gives),
                               MPI_BYTE, gives > 0 ? next : MPI_PROC_NULL, 0,
                               (char *)take[last].at + (takes > 0 ? at : 0), piece_of(takes),
                               MPI_BYTE, takes > 0 ? last : MPI_PROC_NULL, 0, MPI_COMM_WORLD,
                               MPI_STATUS_IGNORE);
        }
    }
}

// Of ranks with errors that the others do not hear of, the first says its own and ends all.
static void end_all(const lac_team *team, lac_status status, const lac_error *err)
{
    const ranks *all = team->context;
    int lower = 0;
    (void)signal(SIGTERM, SIG_IGN); // comes to all by that
    for (int rank = 0; rank < team->rank && !lower; rank++) {
        (void)MPI_Iprobe(rank, NOTICE, MPI_COMM_WORLD, &lower, MPI_STATUS_IGNORE);
    }
    if (lower) {
        (void)sleep(10); // by then it has
    } else {
        char words[2048];
        cli_signals_remedy(words, sizeof words);
        (void)dprintf(all->heard, "lacuna-mpi: rank %d: %s; all ranks end%s\n", team->rank,
                      err != NULL ? err->message : "", words);
    }
    (void)MPI_Abort(MPI_COMM_WORLD, cli_exit_status(status));
}

// The longer they have worked the longer one may be busy before it comes to this, up to a minute.
static void fare(const lac_team *team, uint64_t *words, lac_status here, const lac_error *err)
{
    const ranks *all = team->context;
    const double now = MPI_Wtime(), patience = fmin(1.0 + 0.1 * (now - all->begun), 60.0);
    MPI_Request told, notice[LAC_TEAM_MOST];
    int come = 0;
    (void)MPI_Iallreduce(MPI_IN_PLACE, words, team->ranks, MPI_UINT64_T, MPI_BOR, all->apart,
                         &told);
    for (int rank = 0; rank < team->ranks && here != LAC_OK; rank++) {
        (void)MPI_Isend(NULL, 0, MPI_BYTE, rank, NOTICE, MPI_COMM_WORLD, &notice[rank]);
    }
    while (here != LAC_OK && !come) {
        (void)MPI_Test(&told, &come, MPI_STATUS_IGNORE);
        (void)usleep(come ? 0 : 1000);
        if (!come && MPI_Wtime() > now + patience) {
            end_all(team, here, err);
        }
    }
    (void)MPI_Wait(&told, MPI_STATUS_IGNORE);
    for (int rank = 0; rank < team->ranks; rank++) {
        if (words[rank] != LAC_OK) {
            (void)MPI_Recv(NULL, 0, MPI_BYTE, rank, NOTICE, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        }
    }
    (void)MPI_Waitall(here != LAC_OK ? team->ranks : 0, notice, MPI_STATUSES_IGNORE);
}

lac_status cli_team_join(lac_team **out, lac_error *err)
{
    lac_team team = {.join = join, .exchange = exchange, .fare = fare};
    int heard = STDERR_FILENO;
    *out = NULL;
    cli_signals_hush(true); // mpirun stops all ranks where one ends: that one has said why
    (void)MPI_Init(NULL, NULL);
    (void)MPI_Comm_rank(MPI_COMM_WORLD, &team.rank);
    (void)MPI_Comm_size(MPI_COMM_WORLD, &team.ranks);
    if (team.rank > 0) { // what is said and shown is the same on all: once is enough
        const int nowhere = open("/dev/null", O_WRONLY);
        heard = dup(STDERR_FILENO);
        (void)dup2(nowhere, STDOUT_FILENO);
        (void)dup2(nowhere, STDERR_FILENO);
        (void)close(nowhere);
    }
    LAC_FAIL_IF(team.ranks > LAC_TEAM_MOST, err, LAC_EINPUT,
                "lacuna-mpi: %d ranks: at most %d can share the cells of a case", team.ranks,
                (int)LAC_TEAM_MOST);
    if (team.ranks == 1) {
        cli_signals_hush(false);
        return LAC_OK;
    }
    static ranks all; // no memory of which one of them may have none
    all = (ranks){team, heard, MPI_COMM_NULL, MPI_Wtime()};
    (void)MPI_Comm_dup(MPI_COMM_WORLD, &all.apart);
    all.team.context = &all;
    *out = &all.team;
    return LAC_OK;
}

lac_status cli_team_end(lac_team *team, lac_status status, lac_error *err)
{
    // mpirun asks ranks to stop that end after one with an error: all is said by now.
    (void)signal(SIGTERM, SIG_IGN);
    (void)signal(SIGINT, SIG_IGN);
    return lac_team_agree(team, status, err);
}

void cli_team_leave(void)
{
    int joined = 0;
    (void)MPI_Initialized(&joined);
    if (joined != 0) {
        (void)MPI_Finalize();
    }
}
