// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <vector>

#include "Haptos_DualGraph.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {

/// \brief Values at the neighbours of this rank's elements that others have.
class Halo {
 public:
  /// \brief Collective.
  Halo(const Communicator& comm, const ElementRange& own, const DualGraph& graph);
  /// \brief `valueAt(e)` of every element in the halo, by its holder.  Collective.
  template <class ValueAt>
  auto fetch(ValueAt&& valueAt) const {
    return values_.fetch(valueAt);
  }
  /// Position of a neighbour in the halo, or -1: it is this rank's own.
  int position(std::int64_t neighbour) const;

 private:
  std::int64_t first_, end_;
  std::vector<std::int64_t> elements_;
  RemoteValues values_;
};

}  // namespace Haptos
