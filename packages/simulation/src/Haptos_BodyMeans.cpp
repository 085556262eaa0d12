// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BodyMeans.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_Reductions.hpp"

namespace Haptos {

// Logarithms in whole steps: sums of these know no order.
void takeMeansOfBodies(const Communicator& comm, const std::vector<int>& bodies, std::vector<double>& values) {
  constexpr double kSteps = 64;  // an octave
  TEUCHOS_ASSERT(bodies.size() == values.size());
  const int mine = bodies.empty() ? 0 : 1 + *std::max_element(bodies.begin(), bodies.end());
  std::vector<long> sums(2 * std::size_t(largestOfAll(comm, mine)), 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    sums[2 * std::size_t(bodies[i])] += std::lround(kSteps * std::log2(values[i]));
    ++sums[2 * std::size_t(bodies[i]) + 1];
  }
  sums = sumOfAll(comm, sums);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t at = 2 * std::size_t(bodies[i]);
    values[i] = std::exp2(double(sums[at]) / double(sums[at + 1]) / kSteps);
  }
}

}  // namespace Haptos
