// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "Haptos_ContactLaw.hpp"
#include "Haptos_MultiplierMap.hpp"
#include "Haptos_NodalGather.hpp"
#include "Haptos_Options.hpp"
#include "Haptos_SubdomainStiffness.hpp"

namespace Haptos {

/// \brief A model dealt to the ranks, as far as it is solved: stiffnesses, rows of B and laws; no mesh.
struct SystemModel {
  RCP<const Communicator> comm;
  std::shared_ptr<const SubdomainStiffness> stiffness;  ///< of this rank's subdomains, contiguous in their global numbers
  /// For the preconditioner where K is nearly incompressible (what F does not mirror), on the same nodes; null: the same.
  std::shared_ptr<const SubdomainStiffness> softened;
  std::vector<double> aspects;  ///< [local subdomains] see `aspectOfPart`
  bool isHard = false;  ///< elements for which the preconditioner is known to be poor; the same on all ranks
  bool isHardlyCompressible = false;  ///< some are so nearly incompressible that `softened` is far from what they are; the same on all ranks
  int firstSubdomain = 0;
  std::vector<int> bodies, pieces;          ///< [local subdomains]; pieces of a body are joined by nodes or edges alone, and may turn there
  std::vector<std::string> bodyNames;       ///< the same on all ranks, as the names and laws below
  std::vector<std::string> pieceNames;      ///< those of the bodies where each is one piece
  std::vector<std::string> interfaceNames;
  std::vector<FrictionSpec> friction;       ///< [interfaces]
  RCP<const MultiplierMap> multipliers;
  bool isOwn = false;  ///< stiffnesses that a caller made: their kernels may hold more than rigid motions
  std::shared_ptr<const NodalGather> gather;
  /// What the user calls a node; asked on all ranks at once.
  std::function<std::string(std::int64_t node)> nameOfNode = [](std::int64_t node) { return std::to_string(node); };
};

/// \brief What steers a solve.
struct SystemOptions {
  LocalSolverOptions localSolver;
  PreconditionerOptions preconditioner;
  CoarseOptions coarse;
  SolverOptions solver;
};

}  // namespace Haptos
