// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubdomainCopies.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

#include "Haptos_Reductions.hpp"

namespace Haptos {
namespace {

using Word = unsigned long long;  // wraps around, on any number of ranks

// Of a subdomain's work, what every copy has of its own: mesh, rows, vectors.  The factor, made and read, is the rest.
constexpr double kOwnPart = 0.5;

// Places in an extent; a power of two: layers of a regular mesh never lie half-way between two of them.
constexpr double kSteps = 1 << 20;

/// Lowest coordinates and the longest edge of the box around every subdomain.
struct Boxes {
  std::vector<double> lowest, extent;  // [3 x count], [count]
};

// Calls visit(element, block, nodes, how many) in the order of the mesh.
template <class Visit>
void forEachElement(const Mesh& mesh, Visit&& visit) {
  std::size_t element = 0;
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const auto& nodes = mesh.blocks[b].connectivity;
    const auto perElement = std::size_t(nodesPerElement(mesh.blocks[b].topology));
    for (std::size_t at = 0; at < nodes.size(); at += perElement) visit(element++, b, nodes.data() + at, perElement);
  }
}

Boxes boxesOf(const Communicator& comm, const Mesh& mesh, const Partition& partition) {
  const std::size_t count = std::size_t(partition.count);
  std::vector<double> lowest(3 * count, std::numeric_limits<double>::max()), highest(3 * count, std::numeric_limits<double>::lowest());
  forEachElement(mesh, [&](std::size_t e, std::size_t, const std::int64_t* nodes, std::size_t perElement) {
    const std::size_t first = 3 * std::size_t(partition.ofElement[e]);
    for (std::size_t i = 0; i < perElement; ++i)
      for (std::size_t d = 0; d < 3; ++d) {
        const double x = mesh.coordinates[std::size_t(nodes[i])][d];
        lowest[first + d] = std::min(lowest[first + d], x);
        highest[first + d] = std::max(highest[first + d], x);
      }
  });
  Boxes boxes{leastOfAll(comm, lowest), std::vector<double>(count, std::numeric_limits<double>::min())};
  highest = largestOfAll(comm, highest);
  for (std::size_t i = 0; i < highest.size(); ++i) boxes.extent[i / 3] = std::max(boxes.extent[i / 3], highest[i] - boxes.lowest[i]);
  return boxes;
}

// The finaliser of MurmurHash3: every bit of the word reaches every bit of the result.
Word mixed(Word word) {
  word = (word ^ (word >> 33)) * 0xff51afd7ed558ccdull;
  word = (word ^ (word >> 33)) * 0xc4ceb9fe1a85ec53ull;
  return word ^ (word >> 33);
}

// [2 x count] number of elements and sum of their fingerprints, whichever rank has them.
std::vector<Word> fingerprintsOf(const Communicator& comm, const Mesh& mesh, const Partition& partition, const std::vector<int>& materialOfBlock) {
  const Boxes boxes = boxesOf(comm, mesh, partition);
  std::vector<Word> mine(2 * std::size_t(partition.count), 0);
  forEachElement(mesh, [&](std::size_t e, std::size_t b, const std::int64_t* nodes, std::size_t perElement) {
    const auto s = std::size_t(partition.ofElement[e]);
    Word hash = mixed(Word(mesh.blocks[b].topology) * 1000003 + Word(materialOfBlock[b]));
    for (std::size_t i = 0; i < perElement; ++i)
      for (std::size_t d = 0; d < 3; ++d) {
        const double x = mesh.coordinates[std::size_t(nodes[i])][d] - boxes.lowest[3 * s + d];
        hash = mixed(hash + Word(std::llround(x / boxes.extent[s] * kSteps)));
      }
    ++mine[2 * s];
    mine[2 * s + 1] += hash;
  });
  return sumOfAll(comm, mine);
}

using Copies = std::map<std::pair<int, int>, int>;  // how many on a rank, by rank and the lowest copy

Copies countCopiesOnRanks(const std::vector<int>& copyOf, const std::vector<int>& rankOf) {
  Copies copies;
  for (std::size_t s = 0; s < copyOf.size(); ++s) ++copies[{rankOf[s], copyOf[s]}];
  return copies;
}

// Every copy pays its part of the factor that a rank's copies share.
std::vector<double> sharedWork(const std::vector<double>& work, const std::vector<int>& copyOf, const std::vector<int>& rankOf) {
  const Copies copies = countCopiesOnRanks(copyOf, rankOf);
  std::vector<double> shared;
  for (std::size_t s = 0; s < work.size(); ++s) shared.push_back(work[s] * (kOwnPart + (1 - kOwnPart) / copies.at({rankOf[s], copyOf[s]})));
  return shared;
}

}  // namespace

std::vector<int> findCopies(const Communicator& comm, const OwnElements& own, const Partition& partition,
                            const std::vector<int>& materialOfBlock) {
  const auto fingerprints = fingerprintsOf(comm, own.part.mesh, partition, materialOfBlock);
  std::map<std::pair<Word, Word>, int> lowest;
  std::vector<int> copyOf;
  for (int s = 0; s < partition.count; ++s)
    copyOf.push_back(lowest.emplace(std::pair(fingerprints[2 * std::size_t(s)], fingerprints[2 * std::size_t(s) + 1]), s).first->second);
  return copyOf;
}

std::vector<double> workOfRanks(const std::vector<double>& work, const std::vector<int>& copyOf, const std::vector<int>& rankOf, int ranks) {
  const auto shared = sharedWork(work, copyOf, rankOf);
  std::vector<double> sums(std::size_t(ranks), 0.0);
  for (std::size_t s = 0; s < shared.size(); ++s) sums[std::size_t(rankOf[s])] += shared[s];
  return sums;
}

// What a subdomain costs hangs on where its copies are, and that on the dealing: a few rounds, of which the best counts.
std::vector<int> dealCopiesToRanks(const std::vector<double>& work, const std::vector<int>& copyOf, int ranks) {
  constexpr int kRounds = 8;
  auto best = dealToRanks(work, ranks), dealt = best;
  const auto most = [&](const std::vector<int>& rankOf) {
    const auto sums = workOfRanks(work, copyOf, rankOf, ranks);
    return *std::max_element(sums.begin(), sums.end());
  };
  for (int round = 0; round < kRounds; ++round) {
    const auto again = dealToRanks(sharedWork(work, copyOf, dealt), ranks);
    if (again == dealt) break;
    dealt = again;
    if (most(dealt) < most(best)) best = dealt;
  }
  return best;
}

}  // namespace Haptos
