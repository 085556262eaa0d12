// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Communication.hpp"

namespace Haptos {

/// \brief Bytes that somebody else keeps.
struct ByteView {
  const char* data = nullptr;
  std::size_t size = 0;
};

/// \brief Sends `outgoing[r]` to rank r and returns what every rank sent here, by sender.  Collective.
///
/// \param outgoing [ranks]
/// \return [ranks]; messages above 2 GB are cut in pieces on the way.
std::vector<Bytes> exchangeAll(const Communicator& comm, const std::vector<Bytes>& outgoing);

/// \brief Root sends `messages[r]` to rank r; returns this rank's one.  Collective.
Bytes scatterFromRoot(const Communicator& comm, const std::vector<Bytes>& messages, int root = 0);

/// \brief Every rank sends `message` to root.  Collective.
/// \return on root [ranks], elsewhere empty.
std::vector<Bytes> gatherOnRoot(const Communicator& comm, const Bytes& message, int root = 0);

/// \brief Every rank gets every rank's message, by sender.  Collective.
std::vector<Bytes> gatherOnAll(const Communicator& comm, const Bytes& message);

/// \brief Root gets every rank's bytes in pieces, rank by rank, and holds no more than one of them.  Collective.
///
/// \param mine this rank's bytes
/// \param pieceSize [bytes] the same on all ranks
/// \param take called on root alone with a rank and the next of its pieces; it must not throw
void passToRoot(const Communicator& comm, ByteView mine, std::size_t pieceSize,
                const std::function<void(int rank, ByteView piece)>& take, int root = 0);

/// \brief The lowest rank among those that share this one's memory.  Collective.
int lowestRankOfNode(const Communicator& comm);

}  // namespace Haptos
