// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_OrderedScan.hpp"

#include <numeric>

#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {

// Places are ranges of ranks: every rank adds up what lies in its range, a scan over the ranks gives what lies before.
std::vector<GlobalOrdinal> scanInOrder(const Communicator& comm, const std::vector<PlacedCount>& items, GlobalOrdinal total) {
  const EvenRanges ranges{total, comm.getSize()};
  const auto first = ranges.begin(comm.getRank());
  std::vector<GlobalOrdinal> before(std::size_t(ranges.count(comm.getRank())) + 1, 0);
  for (const PlacedCount& item : sendItems(comm, items, [&](const PlacedCount& i) { return ranges.owner(i.place); }))
    before[std::size_t(item.place - first) + 1] = item.count;
  std::partial_sum(before.begin(), before.end(), before.begin());
  const GlobalOrdinal lower = sumOfLower(comm, before.back());
  std::vector<std::int64_t> places;
  for (const PlacedCount& item : items) places.push_back(item.place);
  return RemoteValues(comm, ranges, places).fetch([&](std::int64_t place) { return lower + before[std::size_t(place)]; });
}

}  // namespace Haptos
