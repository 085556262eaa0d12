// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "Haptos_ModelBuilder.hpp"
#include "Haptos_MultiplierMap.hpp"
#include "Haptos_RunClock.hpp"

namespace Haptos {

class NodalGather;

/// \brief Forces on mesh nodes [force] by node index and place; asked for every node that has elements, on all ranks.
using NodalForces = std::function<std::array<double, 3>(std::int64_t node, const std::array<double, 3>& x)>;

/// \brief What one rank touched while the model was made: the figures that must fall as ranks are added.
struct DealingWork {
  std::int64_t elementsRead = 0, nodesRead = 0;  ///< of its range of the mesh
  std::int64_t elementsCut = 0;                  ///< in pieces that it cut, for whomever
  std::int64_t elementsHeld = 0;                 ///< of its subdomains
  std::int64_t surfaceElements = 0;              ///< gathered for the pairing
};

/// \brief The model, dealt to the ranks: every rank has its share of the mesh, its subdomains and its rows.
struct DistributedModel {
  RCP<const Communicator> comm;
  ModelData data;                     ///< the same on all ranks
  MeshShare mesh;                     ///< this rank's ranges of nodes and elements, as they were read
  std::vector<Subdomain> subdomains;  ///< this rank's, contiguous in their global numbers
  std::vector<double> aspects;        ///< [this rank's subdomains] see `aspectOfPart`
  int firstSubdomain = 0, numSubdomains = 0;
  long primalUnknowns = 0;            ///< n, over all ranks
  RCP<const MultiplierMap> multipliers;
  std::vector<NodalForces> nodalForces;  ///< beside data.loads
  std::vector<PrescribedDisplacement> prescribed;  ///< at the nodes of this rank's range, sorted
  std::vector<std::shared_ptr<UnpairedNodes>> unpaired;  ///< rank 0: [interfaces] null where every node has a pair; empty elsewhere
  DealingWork work;
};

/// \brief Every rank reads its share of the mesh (or is dealt one of `source`) and gets its part of the model.  Collective.
///
/// No rank ever holds more than its share of the mesh, the pieces that it cuts, and on rank 0 the elements at contact surfaces.
/// \param source rank 0: a mesh made in memory, used in place of the options' one; may be null
/// \param late on rank 0: pairs of nodes that have none by the geometry; may be empty
/// \throws InputError, InsufficientModel on all ranks
DistributedModel distributeModel(const RCP<const Communicator>& comm, const RunOptions& options,
                                 const SourceMesh* source, RunClock& clock, const LatePairs& late = {});

/// \brief Pairs of nodes that `displacement` carries into the other body, though nothing lay opposite them.  Collective.
/// \param displacement [3 x nodes of this rank's range]
/// \param tolerance how deep [length] is not inside yet
/// \param isAny whether there are any, on all ranks
LatePairs findLatePairs(const DistributedModel& model, const NodalGather& gather, const std::vector<double>& displacement, double tolerance, bool& isAny);

}  // namespace Haptos
