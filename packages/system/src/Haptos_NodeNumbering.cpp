// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NodeNumbering.hpp"

#include <algorithm>
#include <iterator>

#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {

// An id lives with the rank in whose range of values it lies; numbers follow from how many ids lie below, so they ascend with ids.
NodeNumbering::NodeNumbering(RCP<const Communicator> comm, const std::vector<std::int64_t>& ids) : comm_(std::move(comm)) {
  const std::int64_t largest = ids.empty() ? 0 : *std::max_element(ids.begin(), ids.end());
  ranges_ = {largestOfAll(*comm_, largest) + 1, comm_->getSize()};
  own_ = sendItems(*comm_, ids, [&](std::int64_t id) { return ranges_.owner(id); });
  std::sort(own_.begin(), own_.end());
  own_.erase(std::unique(own_.begin(), own_.end()), own_.end());
  first_ = sumOfLower(*comm_, std::int64_t(own_.size()));
  size_ = sumOfAll(*comm_, std::int64_t(own_.size()));
}

// Ids beyond the largest that anybody brought have no owner, and need none.
std::vector<std::int64_t> NodeNumbering::find(const std::vector<std::int64_t>& ids) const {
  const auto isPossible = [&](std::int64_t id) { return id >= 0 && id < ranges_.size; };
  std::vector<std::int64_t> possible, numbers;
  std::copy_if(ids.begin(), ids.end(), std::back_inserter(possible), isPossible);
  const auto found = RemoteValues(*comm_, ranges_, possible).fetch([&](std::int64_t place) {
    const auto at = std::lower_bound(own_.begin(), own_.end(), ranges_.begin(comm_->getRank()) + place);
    return at != own_.end() && *at == ranges_.begin(comm_->getRank()) + place ? first_ + (at - own_.begin()) : -1;
  });
  auto next = found.begin();
  for (auto id : ids) numbers.push_back(isPossible(id) ? *next++ : -1);
  return numbers;
}

}  // namespace Haptos
