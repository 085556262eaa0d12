// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Exchange.hpp"

#include <mpi.h>

#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_DefaultSerialComm.hpp>
#include <algorithm>
#include <cstdint>
#include <numeric>

namespace Haptos {
namespace {

constexpr std::size_t kPiece = std::size_t(1) << 30;  // MPI 3 counts are ints

// Teuchos has no non-blocking messages of bytes.
MPI_Comm rawComm(const Communicator& comm) {
  const auto* mpi = dynamic_cast<const Teuchos::MpiComm<int>*>(&comm);
  return mpi ? (*mpi->getRawMpiComm())() : MPI_COMM_SELF;
}

// In pieces of at most 2^30 bytes, which arrive in the order in which they are sent.
void send(MPI_Comm comm, const Bytes& message, int to, std::vector<MPI_Request>& requests) {
  for (std::size_t at = 0; at < message.size(); at += kPiece) {
    requests.emplace_back();
    MPI_Isend(message.data() + at, int(std::min(kPiece, message.size() - at)), MPI_BYTE, to, 71, comm, &requests.back());
  }
}

// Lengths are known before; pieces as they are sent.
void receive(MPI_Comm comm, Bytes& message, int from, std::vector<MPI_Request>& requests) {
  for (std::size_t at = 0; at < message.size(); at += kPiece) {
    requests.emplace_back();
    MPI_Irecv(message.data() + at, int(std::min(kPiece, message.size() - at)), MPI_BYTE, from, 71, comm, &requests.back());
  }
}

void waitFor(std::vector<MPI_Request>& requests) {
  MPI_Waitall(int(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

}  // namespace

// Everybody to everybody, most messages being empty.
std::vector<Bytes> exchangeAll(const Communicator& comm, const std::vector<Bytes>& outgoing) {
  const MPI_Comm raw = rawComm(comm);
  const int ranks = comm.getSize(), me = comm.getRank();
  if (ranks == 1) return outgoing;
  std::vector<std::uint64_t> sizesOut(ranks), sizesIn(ranks);
  for (int r = 0; r < ranks; ++r) sizesOut[r] = outgoing[r].size();
  // Who sends to whom is known to the sender alone, so sizes go first; empty messages are not sent.
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
  waitFor(requests);
  return incoming;
}

// Not MPI_Scatterv, whose counts are ints: messages are sent one by one, none of them copied.
Bytes scatterFromRoot(const Communicator& comm, const std::vector<Bytes>& messages, int root) {
  if (comm.getSize() == 1) return messages[0];
  const MPI_Comm raw = rawComm(comm);
  const bool isRoot = comm.getRank() == root;
  std::vector<std::uint64_t> sizes;
  if (isRoot)
    for (const auto& message : messages) sizes.push_back(message.size());
  std::uint64_t size = 0;
  MPI_Scatter(sizes.data(), 1, MPI_UINT64_T, &size, 1, MPI_UINT64_T, root, raw);
  if (!isRoot) {
    Bytes mine(size);
    std::vector<MPI_Request> requests;
    receive(raw, mine, root, requests);
    waitFor(requests);
    return mine;
  }
  std::vector<MPI_Request> requests;
  for (int r = 0; r < comm.getSize(); ++r)
    if (r != root) send(raw, messages[r], r, requests);
  waitFor(requests);
  return messages[root];
}

// All of them are there at once: not for what grows with the mesh (`passToRoot`).
std::vector<Bytes> gatherOnRoot(const Communicator& comm, const Bytes& message, int root) {
  if (comm.getSize() == 1) return {message};  // MPI need not have begun
  const MPI_Comm raw = rawComm(comm);
  const int ranks = comm.getSize();
  std::vector<std::uint64_t> sizes(ranks);
  const std::uint64_t size = message.size();
  MPI_Gather(&size, 1, MPI_UINT64_T, sizes.data(), 1, MPI_UINT64_T, root, raw);
  std::vector<MPI_Request> requests;
  if (comm.getRank() != root) {
    send(raw, message, root, requests);
    waitFor(requests);
    return {};
  }
  std::vector<Bytes> incoming(ranks);
  for (int r = 0; r < ranks; ++r) {
    if (r == root) continue;
    incoming[r].resize(sizes[r]);
    receive(raw, incoming[r], r, requests);
  }
  incoming[root] = message;
  waitFor(requests);
  return incoming;
}

std::vector<Bytes> gatherOnAll(const Communicator& comm, const Bytes& message) {
  if (comm.getSize() == 1) return {message};
  const MPI_Comm raw = rawComm(comm);
  const int ranks = comm.getSize();
  std::vector<std::uint64_t> sizes(ranks);
  const std::uint64_t size = message.size();
  MPI_Allgather(&size, 1, MPI_UINT64_T, sizes.data(), 1, MPI_UINT64_T, raw);
  const std::uint64_t total = std::accumulate(sizes.begin(), sizes.end(), std::uint64_t(0));
  // MPI_Allgatherv counts in ints; beyond, point to point
  if (total > kPiece) return exchangeAll(comm, std::vector<Bytes>(ranks, message));
  std::vector<int> counts(sizes.begin(), sizes.end()), starts(ranks, 0);
  std::partial_sum(counts.begin(), counts.end() - 1, starts.begin() + 1);
  Bytes all(total);
  MPI_Allgatherv(message.data(), counts[comm.getRank()], MPI_BYTE, all.data(), counts.data(), starts.data(), MPI_BYTE, raw);
  std::vector<Bytes> incoming;
  for (int r = 0; r < ranks; ++r) incoming.emplace_back(all.begin() + starts[r], all.begin() + starts[r] + counts[r]);
  return incoming;
}

// Synchronous sends: a rank waits until root asks for its next piece, which keeps what root must hold to one.
void passToRoot(const Communicator& comm, ByteView mine, std::size_t pieceSize,
                const std::function<void(int rank, ByteView piece)>& take, int root) {
  const int ranks = comm.getSize(), me = comm.getRank();
  std::vector<std::uint64_t> sizes(std::size_t(ranks), mine.size);
  if (ranks > 1) {
    const std::uint64_t size = mine.size;
    MPI_Gather(&size, 1, MPI_UINT64_T, sizes.data(), 1, MPI_UINT64_T, root, rawComm(comm));
  }
  if (me != root) {  // one at a time: the next one waits here until root has room for it
    for (std::size_t at = 0; at < mine.size; at += pieceSize)
      MPI_Ssend(mine.data + at, int(std::min(pieceSize, mine.size - at)), MPI_BYTE, root, 72, rawComm(comm));
    return;
  }
  Bytes buffer;
  for (int r = 0; r < ranks; ++r)
    for (std::size_t at = 0; at < sizes[std::size_t(r)]; at += pieceSize) {
      const std::size_t size = std::min<std::size_t>(pieceSize, sizes[std::size_t(r)] - at);
      if (r == me) {
        take(r, {mine.data + at, size});
        continue;
      }
      buffer.resize(size);
      MPI_Recv(buffer.data(), int(size), MPI_BYTE, r, 72, rawComm(comm), MPI_STATUS_IGNORE);
      take(r, {buffer.data(), size});
    }
}

// A node is what shares memory.
int lowestRankOfNode(const Communicator& comm) {
  MPI_Comm node;
  MPI_Comm_split_type(rawComm(comm), MPI_COMM_TYPE_SHARED, comm.getRank(), MPI_INFO_NULL, &node);
  int lowest = comm.getRank();
  MPI_Bcast(&lowest, 1, MPI_INT, 0, node);
  MPI_Comm_free(&node);
  return lowest;
}

}  // namespace Haptos
