// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_TouchedUnknowns.hpp"

#include <Tpetra_Map.hpp>
#include <algorithm>
#include <cstdint>
#include <map>
#include <tuple>

#include "Haptos_LocalSystems.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

struct TouchedOfPattern {
  std::uint64_t pattern = 0;
  std::vector<int> unknowns;
  auto parts() { return std::tie(pattern, unknowns); }
};

void unite(std::vector<int>& all, const std::vector<int>& more) {
  all.insert(all.end(), more.begin(), more.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
}

// Lists of every rank, united by the rank that a pattern stands for, and sent back.
void uniteOverRanks(const Communicator& comm, std::vector<TouchedOfPattern>& mine) {
  const auto meetingPlace = [&](const TouchedOfPattern& item) { return int(item.pattern % std::uint64_t(comm.getSize())); };
  std::vector<std::size_t> countFrom;
  const auto received = sendItems(comm, mine, meetingPlace, &countFrom);
  std::map<std::uint64_t, std::vector<int>> united;
  for (const auto& item : received) unite(united[item.pattern], item.unknowns);
  std::vector<std::vector<int>> answers;
  for (const auto& item : received) answers.push_back(united[item.pattern]);
  auto lists = sendAnswers(comm, answers, countFrom);
  std::vector<std::size_t> next(lists.size(), 0);
  for (auto& item : mine) {
    const auto rank = std::size_t(meetingPlace(item));
    item.unknowns = std::move(lists[rank][next[rank]++]);
  }
}

}  // namespace

TouchedUnknowns::TouchedUnknowns(const LocalSystems& systems, const JumpOperator& jump) {
  std::vector<TouchedOfPattern> mine;
  std::map<std::uint64_t, int> placeOf;
  for (int i = 0; i < systems.size(); ++i) {
    const auto [at, isNew] = placeOf.try_emplace(systems[i].pattern, int(mine.size()));
    if (isNew) mine.push_back({systems[i].pattern, {}});
    unite(mine[std::size_t(at->second)].unknowns, jump.touchedDofs(i));
    listOf_.push_back(at->second);
  }
  const auto comm = jump.getDomainMap()->getComm();
  if (comm->getSize() > 1) uniteOverRanks(*comm, mine);
  for (auto& item : mine) lists_.push_back(std::move(item.unknowns));
}

}  // namespace Haptos
