// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_Communication.hpp"

namespace Haptos {

/// \brief Geometric means of the values of bodies, to a hundredth; the same whatever the ranks.
class BodyMeans {
 public:
  explicit BodyMeans(const Communicator& comm) : comm_(comm) {}

  /// \param body global, 0-based \param values > 0
  void add(int body, const std::vector<double>& values);

  /// \brief Collective.
  void sum();

  /// \brief Of a body of any rank, once summed; 1 where it has no values.
  double of(int body) const;

 private:
  const Communicator& comm_;
  std::vector<long> sums_;  // body by body: sum, number
};

}  // namespace Haptos
