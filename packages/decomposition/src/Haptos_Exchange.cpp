// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Exchange.hpp"

#include <mpi.h>

#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_DefaultSerialComm.hpp>
#include <algorithm>
#include <cstdint>

namespace Haptos {
namespace {

constexpr std::size_t kPiece = std::size_t(1) << 30;  // MPI 3 counts are ints

MPI_Comm rawComm(const Communicator& comm) {
  const auto* mpi = dynamic_cast<const Teuchos::MpiComm<int>*>(&comm);
  return mpi ? (*mpi->getRawMpiComm())() : MPI_COMM_SELF;
}

void send(MPI_Comm comm, const Bytes& message, int to, std::vector<MPI_Request>& requests) {
  for (std::size_t at = 0; at < message.size(); at += kPiece) {
    requests.emplace_back();
    MPI_Isend(message.data() + at, int(std::min(kPiece, message.size() - at)), MPI_BYTE, to, 71, comm, &requests.back());
  }
}

void receive(MPI_Comm comm, Bytes& message, int from, std::vector<MPI_Request>& requests) {
  for (std::size_t at = 0; at < message.size(); at += kPiece) {
    requests.emplace_back();
    MPI_Irecv(message.data() + at, int(std::min(kPiece, message.size() - at)), MPI_BYTE, from, 71, comm, &requests.back());
  }
}

}  // namespace

std::vector<Bytes> exchangeAll(const Communicator& comm, const std::vector<Bytes>& outgoing) {
  const MPI_Comm raw = rawComm(comm);
  const int ranks = comm.getSize(), me = comm.getRank();
  std::vector<std::uint64_t> sizesOut(ranks), sizesIn(ranks);
  for (int r = 0; r < ranks; ++r) sizesOut[r] = outgoing[r].size();
  MPI_Alltoall(sizesOut.data(), 1, MPI_UINT64_T, sizesIn.data(), 1, MPI_UINT64_T, raw);

  std::vector<Bytes> incoming(ranks);
  std::vector<MPI_Request> requests;
  for (int r = 0; r < ranks; ++r) {
    if (r == me) continue;
    incoming[r].resize(sizesIn[r]);
    receive(raw, incoming[r], r, requests);
  }
  for (int r = 0; r < ranks; ++r)
    if (r != me) send(raw, outgoing[r], r, requests);
  incoming[me] = outgoing[me];
  MPI_Waitall(int(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  return incoming;
}

Bytes scatterFromRoot(const Communicator& comm, const std::vector<Bytes>& messages, int root) {
  std::vector<Bytes> outgoing(comm.getSize());
  if (comm.getRank() == root) outgoing = messages;
  return std::move(exchangeAll(comm, outgoing)[root]);
}

std::vector<Bytes> gatherOnRoot(const Communicator& comm, const Bytes& message, int root) {
  std::vector<Bytes> outgoing(comm.getSize());
  outgoing[root] = message;
  auto incoming = exchangeAll(comm, outgoing);
  if (comm.getRank() != root) incoming.clear();
  return incoming;
}

std::vector<Bytes> gatherOnAll(const Communicator& comm, const Bytes& message) {
  return exchangeAll(comm, std::vector<Bytes>(comm.getSize(), message));
}

}  // namespace Haptos
