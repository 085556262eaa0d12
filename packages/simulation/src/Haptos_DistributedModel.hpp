// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "Haptos_ModelBuilder.hpp"
#include "Haptos_MultiplierMap.hpp"
#include "Haptos_RunClock.hpp"

namespace Haptos {

/// \brief Forces on mesh nodes [force] by node index and place; asked for every node that has elements, on all ranks.
using NodalForces = std::function<std::array<double, 3>(std::int64_t node, const std::array<double, 3>& x)>;

/// \brief The model, dealt to the ranks: every rank has its subdomains and its rows, rank 0 also the mesh.
struct DistributedModel {
  RCP<const Communicator> comm;
  ModelData data;                     ///< the same on all ranks
  std::vector<Subdomain> subdomains;  ///< this rank's, contiguous in their global numbers
  int firstSubdomain = 0, numSubdomains = 0;
  long primalUnknowns = 0;            ///< n, over all ranks
  RCP<const MultiplierMap> multipliers;
  std::vector<NodalForces> nodalForces;  ///< beside data.loads
  GlobalModel global;                 ///< rank 0 only: mesh, interfaces, prescribed displacements
};

/// \brief Rank 0 reads the mesh (or takes `source`) and builds the model; all get their part.  Collective.
///
/// \param source rank 0: a mesh made in memory, used in place of the options' one; may be null
/// \throws InputError, InsufficientModel on all ranks
DistributedModel distributeModel(const RCP<const Communicator>& comm, const RunOptions& options,
                                 const SourceMesh* source, RunClock& clock);

}  // namespace Haptos
