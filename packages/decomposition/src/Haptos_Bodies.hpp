// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "Haptos_Components.hpp"

namespace Haptos {

/// \brief Bodies: sets of elements connected through shared nodes, and their side-connected pieces.
///
/// Pieces and bodies are numbered by their first element.  A body that is connected through nodes only (a hinge) has several
/// pieces.  All but `pieces.ofElement` is the same on all ranks.
struct Bodies {
  Components pieces;
  std::vector<int> ofPiece;        ///< [pieces] body
  std::vector<std::string> names;  ///< [bodies] the blocks that a body is made of

  int count() const { return int(names.size()); }
};

/// \brief Collective.
Bodies findBodies(const Communicator& comm, const OwnElements& own, const DualGraph& graph);

}  // namespace Haptos
