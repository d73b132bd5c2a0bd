// SPDX-License-Identifier: GPL-3.0-or-later
// Loaded into lacuna-mpi, swaps the sums of the first and the last block: what a test
// that compares bits must notice.
#include <mpi.h>
#include <stdint.h>

int MPI_Allreduce(const void *from, void *to, int count, MPI_Datatype type, MPI_Op op,
                  MPI_Comm comm)
{
    uint64_t *word = to;
    const int status = PMPI_Allreduce(from, to, count, type, op, comm);
    if (count == 20) { // one sum of twenty blocks
        const uint64_t first = word[0];
        word[0] = word[19];
        word[19] = first;
    }
    return status;
}
