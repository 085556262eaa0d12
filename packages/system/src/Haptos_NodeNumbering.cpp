// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NodeNumbering.hpp"

#include <algorithm>

#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SampledCuts.hpp"

namespace Haptos {

// Ids may lie anywhere, close together or far apart: where ranks begin follows from those that are there.  Numbers follow from how many ids
// lie below, so they ascend with ids.
NodeNumbering::NodeNumbering(RCP<const Communicator> comm, const std::vector<std::int64_t>& ids) : comm_(std::move(comm)) {
  const auto keepEachOnce = [](std::vector<std::int64_t>& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  std::vector<std::int64_t> mine = ids;
  keepEachOnce(mine);
  cuts_ = sampledCuts(*comm_, mine);
  own_ = sendItems(*comm_, mine, [&](std::int64_t id) { return rankOf(id); });
  keepEachOnce(own_);
  first_ = sumOfLower(*comm_, std::int64_t(own_.size()));
  size_ = sumOfAll(*comm_, std::int64_t(own_.size()));
}

int NodeNumbering::rankOf(std::int64_t id) const { return int(std::upper_bound(cuts_.begin(), cuts_.end(), id) - cuts_.begin()); }

std::int64_t NodeNumbering::numberOf(std::int64_t id) const {
  const auto at = std::lower_bound(own_.begin(), own_.end(), id);
  return at != own_.end() && *at == id ? first_ + (at - own_.begin()) : -1;
}

// Who keeps an id answers; answers come rank by rank, in the order in which that rank was asked.
std::vector<std::int64_t> NodeNumbering::find(const std::vector<std::int64_t>& ids) const {
  std::vector<std::size_t> countFrom;
  std::vector<std::int64_t> answers, numbers;
  for (const std::int64_t id : sendItems(*comm_, ids, [&](std::int64_t i) { return rankOf(i); }, &countFrom)) answers.push_back(numberOf(id));
  const auto answered = sendAnswers(*comm_, answers, countFrom);
  std::vector<std::size_t> next(answered.size(), 0);
  for (const std::int64_t id : ids) {
    const auto rank = std::size_t(rankOf(id));
    numbers.push_back(answered[rank][next[rank]++]);
  }
  return numbers;
}

}  // namespace Haptos
