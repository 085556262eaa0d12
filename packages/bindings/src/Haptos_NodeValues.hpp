// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief Three values a node, at whatever nodes a rank names, from and to vectors on a system's map (3 x id + component).
class NodeValues {
 public:
  /// \param nodes [n] ids; ranks may name the same ones, and a rank one of them more than once.  Collective.
  /// \throws InputError on all ranks for a node that is in no subdomain
  NodeValues(const RCP<const Map>& system, const std::vector<std::int64_t>& nodes);

  /// \brief vector := sums of `values` [n x 3] of all ranks.  Collective.
  void sumInto(Vector& vector, const std::vector<double>& values) const;
  /// \brief values [n x 3] of `vector`.  Collective.
  void read(const Vector& vector, double* values) const;

 private:
  RCP<const Map> system_, here_;
  std::vector<int> first_;  // [n] first of a node's rows in here_
};

}  // namespace Haptos
