// SPDX-License-Identifier: GPL-3.0-or-later
// What ranks hand each other where that is more than MPI counts. The counts and addresses are made
// up, and MPI is what stands here: each piece must follow the one before, and fit an int in bytes.
#include <limits.h>
#include <mpi.h>
#include <unistd.h>

#include "cli/common/command.h"
#include "cli/common/progress.h"
#include "cli/team/team.h"
#include "support/test.h"

enum { RANKS = 3, TO = 0, FROM = RANKS };

static int own;                     // this rank
static const char *next[2 * RANKS]; // what goes to and comes from each rank: up to where it was
static int pieces;

static int piece(int which, const void *at, int count, size_t size)
{
    assert_true(count > 0 && (size_t)count * size <= INT_MAX);
    assert_ptr_equal(at, next[which]);
    next[which] += (size_t)count * size;
    pieces++;
    return MPI_SUCCESS;
}

static size_t size_of(MPI_Datatype type) { return type == MPI_BYTE ? 1 : sizeof(double); }

int MPI_Init(int *argc, char ***argv)
{
    (void)argc, (void)argv;
    return MPI_SUCCESS;
}

int MPI_Initialized(int *yes)
{
    *yes = 1;
    return MPI_SUCCESS;
}

int MPI_Comm_dup(MPI_Comm comm, MPI_Comm *other)
{
    *other = comm;
    return MPI_SUCCESS;
}

double MPI_Wtime(void) { return 0.0; }

int MPI_Finalize(void) { return MPI_SUCCESS; }

int MPI_Comm_rank(MPI_Comm comm, int *rank)
{
    (void)comm;
    *rank = own;
    return MPI_SUCCESS;
}

int MPI_Comm_size(MPI_Comm comm, int *ranks)
{
    (void)comm;
    *ranks = RANKS;
    return MPI_SUCCESS;
}

int MPI_Allreduce(const void *from, void *to, int count, MPI_Datatype type, MPI_Op op,
                  MPI_Comm comm)
{
    (void)from, (void)op, (void)comm;
    return piece(TO, to, count, size_of(type));
}

int MPI_Send(const void *from, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm)
{
    (void)tag, (void)comm;
    return piece(TO + to, from, count, size_of(type));
}

int MPI_Recv(void *to, int count, MPI_Datatype type, int from, int tag, MPI_Comm comm,
             MPI_Status *status)
{
    (void)tag, (void)comm, (void)status;
    return piece(FROM + from, to, count, size_of(type));
}

int MPI_Sendrecv(const void *from, int sent, MPI_Datatype type, int to_rank, int tag, void *to,
                 int taken, MPI_Datatype its, int from_rank, int its_tag, MPI_Comm comm,
                 MPI_Status *status)
{
    if (to_rank != MPI_PROC_NULL) {
        (void)MPI_Send(from, sent, type, to_rank, tag, comm);
    }
    return from_rank != MPI_PROC_NULL ? MPI_Recv(to, taken, its, from_rank, its_tag, comm, status)
                                      : MPI_SUCCESS;
}

// Where a thing is that nobody looks at.
static char *nowhere(size_t gib) { return (char *)(uintptr_t)(gib << 30); }

static const size_t counts[] = {(size_t)1 << 31, UINT32_MAX, (size_t)1 << 32,
                                ((size_t)1 << 32) + 1};
enum { COUNTS = sizeof counts / sizeof *counts, GIB = 1 << 10 };

void cli_signals_hush(bool parent) { (void)parent; }

void cli_signals_remedy(char *out, size_t room) { (void)out, (void)room; }

int cli_exit_status(lac_status status) { return (int)status; }

// The team of a rank; what another than the first says is heard all the same.
static lac_team *join_as(int rank)
{
    const int heard[] = {dup(STDOUT_FILENO), dup(STDERR_FILENO)};
    lac_team *team = NULL;
    own = rank;
    assert_int_equal(cli_team_join(&team, NULL), LAC_OK);
    for (int i = 0; i < 2; i++) {
        (void)dup2(heard[i], STDOUT_FILENO + i);
        (void)close(heard[i]);
    }
    pieces = 0;
    return team;
}

static void all_get_all_pieces(void **state)
{
    (void)state;
    lac_team *team = join_as(0);
    for (size_t i = 0; i < COUNTS; i++) {
        next[TO] = nowhere(GIB);
        team->join(team, (uint64_t *)(void *)nowhere(GIB), counts[i]);
        assert_ptr_equal(next[TO], nowhere(GIB) + counts[i] * sizeof(uint64_t));
    }
    assert_true(pieces > COUNTS);
    cli_team_leave();
}

// Of each to each, more one way than the other.
static void ranks_exchange_all_pieces(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNTS; i++) {
        const size_t sent[RANKS] = {counts[i], 0, counts[COUNTS - 1 - i]};
        const size_t taken[RANKS] = {5, 0, counts[i] + 1};
        lac_team *team = join_as(1);
        next[TO + 0] = nowhere(GIB);
        next[TO + 2] = nowhere(GIB) + sent[0];
        next[FROM + 0] = nowhere(2 * GIB);
        next[FROM + 2] = nowhere(2 * GIB) + taken[0];
        lac_piece give[RANKS], take[RANKS];
        for (int rank = 0; rank < RANKS; rank++) {
            give[rank] = (lac_piece){nowhere(GIB) + (rank == 2 ? sent[0] : 0), sent[rank]};
            take[rank] = (lac_piece){nowhere(2 * GIB) + (rank == 2 ? taken[0] : 0), taken[rank]};
        }
        team->exchange(team, give, take);
        for (int rank = 0; rank < RANKS; rank += 2) {
            const size_t before = rank == 2 ? 1 : 0;
            assert_ptr_equal(next[TO + rank], nowhere(GIB) + before * sent[0] + sent[rank]);
            assert_ptr_equal(next[FROM + rank], nowhere(2 * GIB) + before * taken[0] + taken[rank]);
        }
        cli_team_leave();
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_get_all_pieces),
        cmocka_unit_test(ranks_exchange_all_pieces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
