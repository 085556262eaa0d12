// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_Comm.hpp>
#include <cstring>
#include <type_traits>
#include <vector>

#include "Haptos_Exchange.hpp"

namespace Haptos {

/// \brief Sends every item to a rank and returns what came here, by sender and in the sender's order.  Collective.
///
/// \param items plain data; \param rankOf the receiver of an item
/// \param countFrom [ranks], if not null: how many came from every rank
template <class T, class RankOf>
std::vector<T> sendItems(const Communicator& comm, const std::vector<T>& items, const RankOf& rankOf,
                         std::vector<std::size_t>* countFrom = nullptr) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<Bytes> outgoing(std::size_t(comm.getSize()));
  for (const T& item : items) {
    Bytes& to = outgoing[std::size_t(rankOf(item))];
    const char* bytes = reinterpret_cast<const char*>(&item);
    to.insert(to.end(), bytes, bytes + sizeof(T));
  }
  const auto incoming = exchangeAll(comm, outgoing);
  outgoing.clear();
  std::size_t size = 0;
  for (const auto& message : incoming) size += message.size() / sizeof(T);
  std::vector<T> received(size);
  if (countFrom) countFrom->clear();
  T* at = received.data();
  for (const auto& message : incoming) {
    if (!message.empty()) std::memcpy(static_cast<void*>(at), message.data(), message.size());
    at += message.size() / sizeof(T);
    if (countFrom) countFrom->push_back(message.size() / sizeof(T));
  }
  return received;
}

/// \brief Sends one answer for each item back to where `sendItems` brought it from, in the sender's order.  Collective.
///
/// \param answers in the order of the received items, \param countFrom as `sendItems` gave it
/// \return by receiver of the items, and in the order in which they were sent to it.
template <class A>
std::vector<std::vector<A>> sendAnswers(const Communicator& comm, const std::vector<A>& answers,
                                        const std::vector<std::size_t>& countFrom) {
  static_assert(std::is_trivially_copyable_v<A>);
  std::vector<Bytes> outgoing;
  const A* at = answers.data();
  for (const std::size_t count : countFrom) {
    const char* bytes = reinterpret_cast<const char*>(at);
    outgoing.emplace_back(bytes, bytes + count * sizeof(A));
    at += count;
  }
  std::vector<std::vector<A>> received;
  for (const auto& message : exchangeAll(comm, outgoing)) {
    received.emplace_back(message.size() / sizeof(A));
    if (!message.empty()) std::memcpy(static_cast<void*>(received.back().data()), message.data(), message.size());
  }
  return received;
}

}  // namespace Haptos
