// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "Haptos_ConstraintRows.hpp"
#include "Haptos_ContactLaw.hpp"
#include "Haptos_ContactPairs.hpp"
#include "Haptos_Expression.hpp"
#include "Haptos_LinearElasticity.hpp"
#include "Haptos_MeshShare.hpp"
#include "Haptos_MultiplierMap.hpp"
#include "Haptos_RunOptions.hpp"

namespace Haptos {

struct OwnElements;
struct PartitionOptions;

/// \brief A load on surfaces or volumes, with positions of sets and blocks in the mesh.
struct Load {
  using Kind = ConditionType;
  Kind kind;                   ///< not a displacement
  std::string name;            ///< path of its parameter list, for messages
  std::vector<int> sideSets;   ///< of Pressure and Traction
  std::vector<int> blocks;     ///< of BodyForce
  Expression pressure;         ///< [force/area], positive into the body
  VectorExpression value;      ///< [force/area] or [force/volume]
};

/// \brief What every rank knows: read from the parameters alone, except the resolved positions of sets.
struct ModelData {
  std::vector<IsotropicMaterial> materials;
  std::vector<Load> loads;
  std::vector<FrictionSpec> friction;        ///< [interfaces]
  std::vector<std::string> interfaceNames;
  std::vector<std::string> bodyNames;
  std::vector<std::string> pieceNames;       ///< of the side-connected pieces of bodies
  Formulation formulation = Formulation::Standard;
  std::vector<std::string> notes;            ///< full sentences for the report, also printed as warnings
  std::vector<std::string> remarks;          ///< full sentences for the report
  std::size_t unpairedNodes = 0;
  long tiedPairs = 0;
  std::vector<char> isMortar, isExchanged;   ///< [interfaces], see `ContactInterface`
  std::vector<InitialOverlap> overlaps;      ///< [interfaces]
  bool metis = false;
  int mendedFragments = 0;
};

/// \brief A mesh with, for a generated one, its bricks.
struct SourceMesh {
  Mesh mesh;
  std::vector<int> bricks;  ///< [numElements], or empty
};

/// \brief What one rank holds of such a mesh.
struct SourceShare {
  MeshShare mesh;           ///< with all numbers of nodes and elements
  bool hasBricks = false;
  std::vector<int> bricks;  ///< [elements of this rank] where there are bricks
};

/// \brief Reads or generates every rank's share of the mesh of the options, or deals `source`.  Collective.
/// \param source read on rank 0: a mesh in memory to take in place of the options' one; may be null
SourceShare makeShare(const Communicator& comm, const RunOptions& options, const SourceMesh* source);

using LatePairs = std::vector<std::vector<ContactPair>>;  ///< [interfaces] of nodes that have none by the geometry, see UnpairedNodes

/// \brief What the options say, looked up in the mesh; replicated.
struct ModelDraft {
  ModelData data;
  std::vector<int> materialOfBlock;  ///< [blocks]
  std::vector<ContactSpec> contacts;
  std::vector<ContactOptions> contactOptions;  ///< what they come from
  LatePairs late;  ///< rank 0: to be added; empty: none
  std::int64_t surfaceElements = 0;  ///< that rank 0 got for the pairing; set by `pairSurfaces`
};

/// \brief Checks the mesh as a whole, and looks materials, loads and contacts up in it.  Collective.
/// \throws InputError on all ranks, naming the parameter and what exists
ModelDraft draftModel(const Communicator& comm, const RunOptions& options, const MeshShare& mesh);

/// \brief The cut that the options want; takes the bricks of `source`.  Serial.
/// \throws InputError for bricks of a mesh that has none
PartitionOptions partitionOptions(const DecompositionOptions& options, SourceShare& source);

/// \brief Pairs of all interfaces, on rank 0, which gets the elements at the surfaces; notes and counts go to the draft.  Collective.
/// \param prescribed at the nodes of this rank's range, sorted
/// \param mesh with the nodal fields that frictions name
/// \param own its nodes are moved onto surfaces that they are tied to
/// \throws InputError on all ranks
std::vector<ContactInterface> pairSurfaces(const Communicator& comm, const MeshShare& mesh, const std::vector<PrescribedDisplacement>& prescribed,
                                           OwnElements& own, ModelDraft& draft);

/// \brief A contact pair that cannot move must respect its gap already.  Collective.
/// \throws InsufficientModel on all ranks
void checkPinnedRows(const Communicator& comm, const MultiplierMap& multipliers, const MeshShare& mesh, const ModelData& data);

/// \brief Prescribed values of all Displacement conditions at the nodes of this rank's range, sorted by node and component.  Collective.
/// \throws InputError on all ranks for a missing set, or for two conditions that differ at a node, naming both;
/// round-off of the largest values of either is no difference.
std::vector<PrescribedDisplacement> collectDisplacements(const Communicator& comm, const std::vector<ConditionOptions>& conditions,
                                                         const MeshShare& mesh, const OwnElements& own);

/// \brief Pressures, tractions and body forces; serial.  \throws InputError for a missing set or block.
std::vector<Load> collectLoads(const std::vector<ConditionOptions>& conditions, const Mesh& mesh);

/// \brief Where the mesh has them: a load on nothing would be none.  Serial.  \throws InputError naming the set or block.
void requireLoadedSides(const std::vector<Load>& loads, const MeshShare& mesh);

/// \brief "node 17 (0.5, 0.25, 0)" of any node of the mesh, on all ranks.  Collective; `node` is the same on all.
std::string describeNode(const Communicator& comm, const MeshShare& mesh, std::int64_t node);

}  // namespace Haptos
