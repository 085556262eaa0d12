// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NodeNumbering.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <algorithm>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Exchange.hpp"

namespace Haptos {
namespace {

using Ids = std::vector<std::int64_t>;

std::vector<Ids> exchangeIds(const Communicator& comm, const std::vector<Ids>& outgoing) {
  std::vector<Bytes> messages;
  for (const auto& list : outgoing) {
    ByteWriter writer;
    writer.write(list);
    messages.push_back(writer.take());
  }
  std::vector<Ids> received;
  for (const auto& message : exchangeAll(comm, messages)) received.push_back(ByteReader(message).readVector<std::int64_t>());
  return received;
}

}  // namespace

// [ranks] ids for the ranks that keep them
std::vector<Ids> NodeNumbering::collect(const Ids& ids) const {
  std::vector<Ids> parts(std::size_t(comm_->getSize()));
  for (auto id : ids) parts[std::size_t(rankOf(id))].push_back(id);
  return parts;
}

NodeNumbering::NodeNumbering(RCP<const Communicator> comm, const Ids& ids) : comm_(std::move(comm)) {
  std::int64_t mine = 0, largest = 0, end = 0;
  for (auto id : ids) mine = std::max(mine, id);
  Teuchos::reduceAll(*comm_, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(largest));
  perRank_ = largest / comm_->getSize() + 1;
  for (const auto& list : exchangeIds(*comm_, collect(ids))) own_.insert(own_.end(), list.begin(), list.end());
  std::sort(own_.begin(), own_.end());
  own_.erase(std::unique(own_.begin(), own_.end()), own_.end());
  mine = std::int64_t(own_.size());
  Teuchos::scan(*comm_, Teuchos::REDUCE_SUM, mine, Teuchos::outArg(end));
  Teuchos::reduceAll(*comm_, Teuchos::REDUCE_SUM, mine, Teuchos::outArg(size_));
  first_ = end - mine;
}

Ids NodeNumbering::find(const Ids& ids) const {
  Ids known;  // others than these nobody can have
  for (auto id : ids)
    if (id >= 0 && id / perRank_ < comm_->getSize()) known.push_back(id);
  auto asked = exchangeIds(*comm_, collect(known));
  for (auto& list : asked)
    for (auto& id : list) {
      const auto at = std::lower_bound(own_.begin(), own_.end(), id);
      id = at != own_.end() && *at == id ? first_ + (at - own_.begin()) : -1;
    }
  const auto answers = exchangeIds(*comm_, asked);
  std::vector<std::size_t> next(answers.size(), 0);
  Ids numbers;
  for (auto id : ids) {
    if (id < 0 || id / perRank_ >= comm_->getSize()) {
      numbers.push_back(-1);
      continue;
    }
    const auto rank = std::size_t(rankOf(id));
    numbers.push_back(answers[rank][next[rank]++]);
  }
  return numbers;
}

}  // namespace Haptos
