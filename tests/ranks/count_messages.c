// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded into lacuna-mpi, counts what rank 0 tells the others: at the end a line for each number of
// words, and how many collectives had it; last the bytes that came to it alone.
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST = 1 << 16 };

static long collectives[MOST + 1]; // of so many words; MOST: of more
static long received;

int MPI_Allreduce(const void *from, void *to, int count, MPI_Datatype type, MPI_Op op,
                  MPI_Comm comm)
{
    collectives[count < MOST ? count : MOST]++;
    return PMPI_Allreduce(from, to, count, type, op, comm);
}

int MPI_Iallreduce(const void *from, void *to, int count, MPI_Datatype type, MPI_Op op,
                   MPI_Comm comm, MPI_Request *request)
{
    collectives[count < MOST ? count : MOST]++;
    return PMPI_Iallreduce(from, to, count, type, op, comm, request);
}

int MPI_Sendrecv(const void *from, int sent, MPI_Datatype type, int to_rank, int tag, void *to,
                 int taken, MPI_Datatype its, int from_rank, int its_tag, MPI_Comm comm,
                 MPI_Status *status)
{
    received += taken;
    return PMPI_Sendrecv(from, sent, type, to_rank, tag, to, taken, its, from_rank, its_tag, comm,
                         status);
}

int MPI_Finalize(void)
{
    int rank = 0;
    const char *path = getenv("COUNTS");
    (void)PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
    FILE *file = rank == 0 && path != NULL ? fopen(path, "w") : NULL;
    for (int words = 0; file != NULL && words <= MOST; words++) {
        if (collectives[words] > 0) {
            (void)fprintf(file, "%d %ld\n", words, collectives[words]);
        }
    }
    if (file != NULL) {
        (void)fprintf(file, "received %ld\n", received);
        (void)fclose(file);
    }
    return PMPI_Finalize();
}
