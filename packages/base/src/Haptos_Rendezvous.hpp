// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_Comm.hpp>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "Haptos_EvenRanges.hpp"
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

/// \brief `exchangeAll` of plain values: outgoing[r] goes to rank r, what rank s sent stands at s.  Collective.
template <class T>
std::vector<std::vector<T>> exchangeValues(const Communicator& comm, const std::vector<std::vector<T>>& outgoing) {
  static_assert(std::is_trivially_copyable_v<T>);
  std::vector<Bytes> messages(outgoing.size());
  for (std::size_t r = 0; r < outgoing.size(); ++r) {
    messages[r].resize(outgoing[r].size() * sizeof(T));
    if (!messages[r].empty()) std::memcpy(messages[r].data(), outgoing[r].data(), messages[r].size());
  }
  messages = exchangeAll(comm, messages);
  std::vector<std::vector<T>> incoming(messages.size());
  for (std::size_t r = 0; r < messages.size(); ++r) {
    incoming[r].resize(messages[r].size() / sizeof(T));
    if (!messages[r].empty()) std::memcpy(incoming[r].data(), messages[r].data(), messages[r].size());
    messages[r] = {};
  }
  return incoming;
}

/// \brief Lists, one after the other.
template <class T>
std::vector<T> joined(const std::vector<std::vector<T>>& lists) {
  std::vector<T> all;
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

/// \brief Plain values of every rank, by rank, on all of them.  Collective.
template <class T>
std::vector<T> gatheredOnAll(const Communicator& comm, const std::vector<T>& mine) {
  static_assert(std::is_trivially_copyable_v<T>);
  Bytes message(mine.size() * sizeof(T));
  if (!message.empty()) std::memcpy(message.data(), mine.data(), message.size());
  std::vector<T> all;
  for (const Bytes& part : gatherOnAll(comm, message)) {
    const std::size_t before = all.size();
    all.resize(before + part.size() / sizeof(T));
    if (!part.empty()) std::memcpy(all.data() + before, part.data(), part.size());
  }
  return all;
}

/// \brief Asks the ranks that hold ranges of an index for values at some of its places, as often as one likes.
class RemoteValues {
 public:
  /// \brief Collective.
  /// \param ranges who holds which indices
  /// \param wanted ascending, each once; what this rank wants to know
  RemoteValues(const Communicator& comm, const EvenRanges& ranges, const std::vector<std::int64_t>& wanted) : comm_(comm) {
    std::vector<std::vector<std::int64_t>> places(std::size_t(comm.getSize()));
    for (auto index : wanted) {
      const int owner = ranges.owner(index);
      places[std::size_t(owner)].push_back(index - ranges.begin(owner));
    }
    asked_ = exchangeValues(comm, places);
  }

  /// \brief Places in this rank's range that rank r asked for, ascending: [ranks].
  const std::vector<std::vector<std::int64_t>>& asked() const { return asked_; }

  /// \brief [wanted] what the holders' `valueAt(place in their range)` gives, a plain value.  Collective.
  template <class ValueAt>
  auto fetch(ValueAt&& valueAt) const {
    std::vector<std::vector<std::decay_t<decltype(valueAt(std::int64_t(0)))>>> replies(asked_.size());
    for (std::size_t r = 0; r < asked_.size(); ++r)
      for (auto place : asked_[r]) replies[r].push_back(valueAt(place));
    return joined(exchangeValues(comm_, replies));
  }

 private:
  const Communicator& comm_;
  std::vector<std::vector<std::int64_t>> asked_;
};

}  // namespace Haptos
