// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BodyMeans.hpp"

#include <cmath>

#include "Haptos_Reductions.hpp"

namespace Haptos {
namespace {

// Logarithms in whole steps: sums of these know no order.
constexpr double kSteps = 64;  // an octave

}  // namespace

void BodyMeans::add(int body, const std::vector<double>& values) {
  const std::size_t at = 2 * std::size_t(body);
  if (sums_.size() < at + 2) sums_.resize(at + 2, 0);
  for (const double value : values) sums_[at] += std::lround(kSteps * std::log2(value));
  sums_[at + 1] += long(values.size());
}

void BodyMeans::sum() {
  sums_.resize(largestOfAll(comm_, sums_.size()), 0);
  sums_ = sumOfAll(comm_, sums_);
}

double BodyMeans::of(int body) const {
  const std::size_t at = 2 * std::size_t(body);
  return at < sums_.size() && sums_[at + 1] > 0 ? std::exp2(double(sums_[at]) / double(sums_[at + 1]) / kSteps) : 1.0;
}

}  // namespace Haptos
