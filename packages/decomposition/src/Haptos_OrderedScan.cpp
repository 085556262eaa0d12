// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_OrderedScan.hpp"

#include <Teuchos_CommHelpers.hpp>

#include "Haptos_Rendezvous.hpp"

namespace Haptos {

GlobalOrdinal sumOverLowerRanks(const Communicator& comm, GlobalOrdinal mine) {
  GlobalOrdinal sum = 0;
  Teuchos::scan(comm, Teuchos::REDUCE_SUM, mine, Teuchos::outArg(sum));
  return sum - mine;
}

// Places are ranges of ranks: every rank adds up what lies in its range, a scan over the ranks gives what lies before, and the
// answers go back the way the items came.
std::vector<GlobalOrdinal> scanInOrder(const Communicator& comm, const std::vector<PlacedCount>& items, GlobalOrdinal total) {
  if (total == 0) return {};
  const GlobalOrdinal perRank = (total - 1) / comm.getSize() + 1, first = perRank * comm.getRank();
  const auto rankOf = [&](const PlacedCount& item) { return int(item.place / perRank); };
  std::vector<std::size_t> countFrom;
  const auto received = sendItems(comm, items, rankOf, &countFrom);
  std::vector<GlobalOrdinal> before(std::size_t(perRank) + 1, 0), answers;
  for (const PlacedCount& item : received) before[std::size_t(item.place - first) + 1] = item.count;
  for (std::size_t i = 1; i < before.size(); ++i) before[i] += before[i - 1];
  const GlobalOrdinal lower = sumOverLowerRanks(comm, before.back());
  for (const PlacedCount& item : received) answers.push_back(lower + before[std::size_t(item.place - first)]);
  const auto lists = sendAnswers(comm, answers, countFrom);
  std::vector<std::size_t> next(lists.size(), 0);
  std::vector<GlobalOrdinal> result;
  for (const PlacedCount& item : items) {
    const std::size_t rank = std::size_t(rankOf(item));
    result.push_back(lists[rank][next[rank]++]);
  }
  return result;
}

}  // namespace Haptos
