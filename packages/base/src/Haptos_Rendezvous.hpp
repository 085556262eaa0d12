// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_Comm.hpp>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "Haptos_EvenRanges.hpp"
#include "Haptos_Exchange.hpp"

namespace Haptos {

// Values that ranks send each other: whatever a ByteWriter takes.

/// \brief `exchangeAll` of values: outgoing[r] goes to rank r, what rank s sent stands at s.  Collective.
template <class T>
std::vector<std::vector<T>> exchangeValues(const Communicator& comm, const std::vector<std::vector<T>>& outgoing) {
  std::vector<Bytes> messages;
  for (const auto& list : outgoing) {
    ByteWriter writer;
    writer.writeAll(list);
    messages.push_back(writer.take());
  }
  messages = exchangeAll(comm, messages);
  std::vector<std::vector<T>> incoming(messages.size());
  for (std::size_t r = 0; r < messages.size(); ++r) {
    ByteReader(messages[r]).readAll(incoming[r]);
    messages[r] = {};
  }
  return incoming;
}

/// \brief One value to every rank, one from every rank.  What was sent is let go on the way.  Collective.
template <class T>
std::vector<T> exchangeEach(const Communicator& comm, std::vector<T> outgoing) {
  std::vector<Bytes> messages;
  for (T& value : outgoing) {
    ByteWriter writer;
    writer.write(std::exchange(value, T{}));
    messages.push_back(writer.take());
  }
  messages = exchangeAll(comm, messages);
  for (std::size_t r = 0; r < messages.size(); ++r) {
    outgoing[r] = ByteReader(messages[r]).read<T>();
    messages[r] = {};
  }
  return outgoing;
}

/// \brief Sends every item to a rank and returns what came here, by sender and in the sender's order.  Collective.
///
/// \param rankOf the receiver of an item
/// \param countFrom [ranks], if not null: how many came from every rank
template <class T, class RankOf>
std::vector<T> sendItems(const Communicator& comm, const std::vector<T>& items, const RankOf& rankOf,
                         std::vector<std::size_t>* countFrom = nullptr) {
  std::vector<ByteWriter> outgoing(std::size_t(comm.getSize()));
  for (const T& item : items) outgoing[std::size_t(rankOf(item))].write(item);
  std::vector<Bytes> messages;
  for (ByteWriter& writer : outgoing) messages.push_back(writer.take());
  messages = exchangeAll(comm, messages);
  std::vector<T> received;
  if constexpr (std::is_trivially_copyable_v<T>) {  // a list that grows would ask for twice its memory
    std::size_t bytes = 0;
    for (const Bytes& message : messages) bytes += message.size();
    received.reserve(bytes / sizeof(T));
  }
  if (countFrom) countFrom->clear();
  for (const Bytes& message : messages) {
    const std::size_t before = received.size();
    ByteReader(message).readAll(received);
    if (countFrom) countFrom->push_back(received.size() - before);
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
  std::vector<std::vector<A>> outgoing;
  auto at = answers.begin();
  for (const std::size_t count : countFrom) {
    outgoing.emplace_back(at, at + std::ptrdiff_t(count));
    at += std::ptrdiff_t(count);
  }
  return exchangeValues(comm, outgoing);
}

/// \brief Lists, one after the other.
template <class T>
std::vector<T> joined(const std::vector<std::vector<T>>& lists) {
  std::vector<T> all;
  for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

/// \brief Values of every rank, by rank, on all of them.  Collective.
template <class T>
std::vector<T> gatheredOnAll(const Communicator& comm, const std::vector<T>& mine) {
  ByteWriter writer;
  writer.writeAll(mine);
  std::vector<T> all;
  for (const Bytes& part : gatherOnAll(comm, writer.take())) ByteReader(part).readAll(all);
  return all;
}

/// \brief Values of every rank, by rank, on rank 0; empty elsewhere.  Collective.
template <class T>
std::vector<T> gatheredOnRoot(const Communicator& comm, const std::vector<T>& mine) {
  return sendItems(comm, mine, [](const T&) { return 0; });
}

/// \brief The root's value on all ranks.  Collective.
template <class T>
T broadcasted(const Communicator& comm, const T& value, int root = 0) {
  ByteWriter writer;
  if (comm.getRank() == root) writer.write(value);
  return ByteReader(gatherOnAll(comm, writer.take())[std::size_t(root)]).template read<T>();
}

/// \brief The root's values[r] on rank r.  Collective.
template <class T>
T scattered(const Communicator& comm, const std::vector<T>& values, int root = 0) {
  std::vector<Bytes> messages;
  for (const T& value : values) {
    ByteWriter writer;
    writer.write(value);
    messages.push_back(writer.take());
  }
  return ByteReader(scatterFromRoot(comm, messages, root)).template read<T>();
}

/// \brief Places of an index that others hold ranges of, whose values are asked for, or added to, as often as one likes.
class RemoteValues {
 public:
  /// \brief Collective.
  /// \param ranges who holds which indices
  /// \param wanted what this rank wants to know, in any order
  RemoteValues(const Communicator& comm, const EvenRanges& ranges, const std::vector<std::int64_t>& wanted) : comm_(comm) {
    std::vector<std::vector<std::int64_t>> places(std::size_t(comm.getSize()));
    for (auto index : wanted) {
      owners_.push_back(ranges.owner(index));
      places[std::size_t(owners_.back())].push_back(index - ranges.begin(owners_.back()));
    }
    asked_ = exchangeValues(comm, places);
  }

  /// \brief Places in this rank's range that rank r asked for, in its order: [ranks].
  const std::vector<std::vector<std::int64_t>>& asked() const { return asked_; }

  /// \brief [wanted] what the holders' `valueAt(place in their range)` gives.  Collective.
  template <class ValueAt>
  auto fetch(ValueAt&& valueAt) const {
    using T = std::decay_t<decltype(valueAt(std::int64_t(0)))>;
    std::vector<std::vector<T>> replies(asked_.size());
    for (std::size_t r = 0; r < asked_.size(); ++r)
      for (auto place : asked_[r]) replies[r].push_back(valueAt(place));
    replies = exchangeValues(comm_, replies);
    std::vector<std::size_t> next(replies.size(), 0);
    std::vector<T> values;
    for (const int owner : owners_) values.push_back(std::move(replies[std::size_t(owner)][next[std::size_t(owner)]++]));
    return values;
  }

  /// \brief The way back: the holders' `take(place in their range, value)` gets values [wanted], by rank and in its order.  Collective.
  template <class T, class Take>
  void give(const std::vector<T>& values, Take&& take) const {
    std::vector<std::vector<T>> outgoing(asked_.size());
    for (std::size_t i = 0; i < values.size(); ++i) outgoing[std::size_t(owners_[i])].push_back(values[i]);
    const auto incoming = exchangeValues(comm_, outgoing);
    for (std::size_t r = 0; r < incoming.size(); ++r)
      for (std::size_t i = 0; i < incoming[r].size(); ++i) take(asked_[r][i], incoming[r][i]);
  }

 private:
  const Communicator& comm_;
  std::vector<int> owners_;                        // [wanted]
  std::vector<std::vector<std::int64_t>> asked_;
};

}  // namespace Haptos
