// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

#include "Haptos_Rendezvous.hpp"

namespace Haptos {

/// \brief Where to cut items into about equal parts, one a rank: [ranks - 1] of them, ascending, the same on all ranks.  Collective.
///
/// `std::upper_bound` among the cuts is the rank of an item.  From a few items of every rank, each of which stands for those around it: what is
/// kept grows with the ranks, not with their square.  Their places are shifted from rank to rank, so that errors do not add up.
/// \param sorted ascending
template <class T>
std::vector<T> sampledCuts(const Communicator& comm, const std::vector<T>& sorted) {
  constexpr std::size_t kSamples = 64;
  struct Sample {
    T item;
    std::int64_t weight;
    auto parts() { return std::tie(item, weight); }
  };
  const std::size_t n = sorted.size(), count = std::min(kSamples, n), ranks = std::size_t(comm.getSize());
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t begin = i * n / count, width = (i + 1) * n / count - begin;
    const std::size_t shift = (std::size_t(comm.getRank()) * kSamples + i) * 0x9E3779B97F4A7C15u >> 40;  // golden ratio: spread evenly
    samples.push_back({sorted[begin + shift % width], std::int64_t(width)});
  }
  samples = gatheredOnAll(comm, samples);
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.item < b.item; });
  std::int64_t all = 0, below = 0;
  for (const Sample& sample : samples) all += sample.weight;
  std::vector<T> cuts;
  auto next = samples.begin();
  for (std::size_t r = 1; r < ranks && !samples.empty(); ++r) {
    while (next + 1 != samples.end() && (below + next->weight) * std::int64_t(ranks) <= all * std::int64_t(r)) below += (next++)->weight;
    cuts.push_back(next->item);
  }
  return cuts;
}

}  // namespace Haptos
