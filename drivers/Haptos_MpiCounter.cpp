// SPDX-License-Identifier: BSD-3-Clause
// MPI's profiling interface: a program that is linked with this file sends through wrappers that count and call PMPI_*, and
// communicationSoFar() tells what they counted, the calls of Trilinos included.  Counted are blocking and non-blocking sends, and
// the collectives of MPI 1 with MPI_Iallreduce; persistent sends and one-sided communication, which neither Haptos nor what it
// calls uses, are not.
#include <mpi.h>

#include "Haptos_Communication.hpp"

namespace {

Haptos::CommunicationCounts counts;

[[maybe_unused]] const bool isSource = [] {
  Haptos::setCommunicationSource([] { return counts; });
  return true;
}();

int sizeOf(MPI_Comm comm) {
  int size = 1;
  PMPI_Comm_size(comm, &size);
  return size;
}

int rankIn(MPI_Comm comm) {
  int rank = 0;
  PMPI_Comm_rank(comm, &rank);
  return rank;
}

long long bytesOf(int count, MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  return (long long)(count) * size;
}

void countMessage(int count, MPI_Datatype type, int to, MPI_Comm comm) {
  if (to == MPI_PROC_NULL || to == rankIn(comm)) return;
  ++counts.messages;
  counts.messageBytes += bytesOf(count, type);
}

void countReduction(MPI_Comm comm, long long bytes) {
  if (sizeOf(comm) == 1) return;
  ++counts.reductions;
  counts.collectiveBytes += bytes;
}

void countCollective(MPI_Comm comm, long long bytes) {
  if (sizeOf(comm) == 1) return;
  ++counts.collectives;
  counts.collectiveBytes += bytes;
}

// In-place calls have their data in the receive buffer.
long long gathered(const void* send, int count, MPI_Datatype type, int receiveCount, MPI_Datatype receiveType) {
  return send == MPI_IN_PLACE ? bytesOf(receiveCount, receiveType) : bytesOf(count, type);
}

long long sumOf(const int n[], MPI_Datatype type, MPI_Comm comm) {
  long long bytes = 0;
  for (int r = 0, size = sizeOf(comm), me = rankIn(comm); r < size; ++r)
    if (r != me) bytes += bytesOf(n[r], type);
  return bytes;
}

}  // namespace

extern "C" {

#define HAPTOS_COUNT_SEND(NAME)                                                                    \
  int MPI_##NAME(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm) { \
    countMessage(count, type, to, comm);                                                           \
    return PMPI_##NAME(data, count, type, to, tag, comm);                                          \
  }
HAPTOS_COUNT_SEND(Send)
HAPTOS_COUNT_SEND(Bsend)
HAPTOS_COUNT_SEND(Ssend)
HAPTOS_COUNT_SEND(Rsend)
#undef HAPTOS_COUNT_SEND

#define HAPTOS_COUNT_SEND(NAME)                                                                                          \
  int MPI_##NAME(const void* data, int count, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request) { \
    countMessage(count, type, to, comm);                                                                                 \
    return PMPI_##NAME(data, count, type, to, tag, comm, request);                                                       \
  }
HAPTOS_COUNT_SEND(Isend)
HAPTOS_COUNT_SEND(Ibsend)
HAPTOS_COUNT_SEND(Issend)
HAPTOS_COUNT_SEND(Irsend)
#undef HAPTOS_COUNT_SEND

int MPI_Sendrecv(const void* data, int count, MPI_Datatype type, int to, int tag, void* in, int inCount, MPI_Datatype inType,
                 int from, int inTag, MPI_Comm comm, MPI_Status* status) {
  countMessage(count, type, to, comm);
  return PMPI_Sendrecv(data, count, type, to, tag, in, inCount, inType, from, inTag, comm, status);
}

// What combines or gathers something of all ranks.

int MPI_Allreduce(const void* data, void* result, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  countReduction(comm, bytesOf(count, type));
  return PMPI_Allreduce(data, result, count, type, op, comm);
}

int MPI_Iallreduce(const void* data, void* result, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm, MPI_Request* request) {
  countReduction(comm, bytesOf(count, type));
  return PMPI_Iallreduce(data, result, count, type, op, comm, request);
}

int MPI_Reduce(const void* data, void* result, int count, MPI_Datatype type, MPI_Op op, int root, MPI_Comm comm) {
  countReduction(comm, rankIn(comm) == root ? 0 : bytesOf(count, type));
  return PMPI_Reduce(data, result, count, type, op, root, comm);
}

int MPI_Reduce_scatter(const void* data, void* result, const int n[], MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  countReduction(comm, sumOf(n, type, comm));
  return PMPI_Reduce_scatter(data, result, n, type, op, comm);
}

int MPI_Scan(const void* data, void* result, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  countReduction(comm, bytesOf(count, type));
  return PMPI_Scan(data, result, count, type, op, comm);
}

int MPI_Exscan(const void* data, void* result, int count, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  countReduction(comm, bytesOf(count, type));
  return PMPI_Exscan(data, result, count, type, op, comm);
}

int MPI_Gather(const void* data, int count, MPI_Datatype type, void* result, int n, MPI_Datatype resultType, int root, MPI_Comm comm) {
  countReduction(comm, rankIn(comm) == root ? 0 : bytesOf(count, type));
  return PMPI_Gather(data, count, type, result, n, resultType, root, comm);
}

int MPI_Gatherv(const void* data, int count, MPI_Datatype type, void* result, const int n[], const int at[], MPI_Datatype resultType,
                int root, MPI_Comm comm) {
  countReduction(comm, rankIn(comm) == root ? 0 : bytesOf(count, type));
  return PMPI_Gatherv(data, count, type, result, n, at, resultType, root, comm);
}

int MPI_Allgather(const void* data, int count, MPI_Datatype type, void* result, int n, MPI_Datatype resultType, MPI_Comm comm) {
  countReduction(comm, gathered(data, count, type, n, resultType));
  return PMPI_Allgather(data, count, type, result, n, resultType, comm);
}

int MPI_Allgatherv(const void* data, int count, MPI_Datatype type, void* result, const int n[], const int at[],
                   MPI_Datatype resultType, MPI_Comm comm) {
  countReduction(comm, gathered(data, count, type, n[rankIn(comm)], resultType));
  return PMPI_Allgatherv(data, count, type, result, n, at, resultType, comm);
}

// Other collectives.

int MPI_Bcast(void* data, int count, MPI_Datatype type, int root, MPI_Comm comm) {
  countCollective(comm, rankIn(comm) == root ? bytesOf(count, type) : 0);
  return PMPI_Bcast(data, count, type, root, comm);
}

int MPI_Scatter(const void* data, int count, MPI_Datatype type, void* result, int n, MPI_Datatype resultType, int root, MPI_Comm comm) {
  countCollective(comm, rankIn(comm) == root ? (sizeOf(comm) - 1) * bytesOf(count, type) : 0);
  return PMPI_Scatter(data, count, type, result, n, resultType, root, comm);
}

int MPI_Scatterv(const void* data, const int n[], const int at[], MPI_Datatype type, void* result, int count,
                 MPI_Datatype resultType, int root, MPI_Comm comm) {
  countCollective(comm, rankIn(comm) == root ? sumOf(n, type, comm) : 0);
  return PMPI_Scatterv(data, n, at, type, result, count, resultType, root, comm);
}

int MPI_Alltoall(const void* data, int count, MPI_Datatype type, void* result, int n, MPI_Datatype resultType, MPI_Comm comm) {
  countCollective(comm, (sizeOf(comm) - 1) * gathered(data, count, type, n, resultType));
  return PMPI_Alltoall(data, count, type, result, n, resultType, comm);
}

int MPI_Alltoallv(const void* data, const int n[], const int at[], MPI_Datatype type, void* result, const int resultN[],
                  const int resultAt[], MPI_Datatype resultType, MPI_Comm comm) {
  countCollective(comm, data == MPI_IN_PLACE ? sumOf(resultN, resultType, comm) : sumOf(n, type, comm));
  return PMPI_Alltoallv(data, n, at, type, result, resultN, resultAt, resultType, comm);
}

int MPI_Barrier(MPI_Comm comm) {
  countCollective(comm, 0);
  return PMPI_Barrier(comm);
}

}  // extern "C"
