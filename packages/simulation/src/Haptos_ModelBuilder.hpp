// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "Haptos_ConstraintRows.hpp"
#include "Haptos_ContactLaw.hpp"
#include "Haptos_ContactPairs.hpp"
#include "Haptos_Expression.hpp"
#include "Haptos_LinearElasticity.hpp"
#include "Haptos_Partition.hpp"
#include "Haptos_RunOptions.hpp"

namespace Haptos {

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
  std::vector<std::string> hinged;           ///< bodies whose pieces hang together by nodes or edges alone
  Formulation formulation = Formulation::Standard;
  std::vector<std::string> notes;            ///< full sentences for the report, also printed as warnings
  std::vector<std::string> remarks;          ///< full sentences for the report
  std::size_t unpairedNodes = 0;
  long tiedPairs = 0;
  bool metis = false;
  int mendedFragments = 0;
};

/// \brief What the reader holds beside: the mesh, its cut into subdomains, what is prescribed and paired.
struct GlobalModel {
  Mesh mesh;
  Partition partition;
  std::vector<Subdomain> subdomains;         ///< emptied once they are sent
  std::vector<ContactInterface> interfaces;
  std::vector<PrescribedDisplacement> prescribed;
};

/// \brief A mesh with, for a generated one, its bricks.
struct SourceMesh {
  Mesh mesh;
  std::vector<int> bricks;  ///< [numElements], or empty
};

/// \brief The materials in the order of the input.
std::vector<IsotropicMaterial> materialsOf(const std::vector<MaterialOptions>& materials);

/// \brief Reads or generates the mesh.  Serial.
SourceMesh makeMesh(const MeshOptions& options);

/// \brief What the first half of a model leaves for the second.
struct ModelDraft {
  std::vector<int> materialOfBlock;
  DualGraph graph;
  Bodies bodies;
  PartitionOptions options;
  PartitionPlan plan;
};

/// \name Options and a mesh become a model, on the reader, up to the cut and from there on; each half is serial.
/// @{
/// \throws InputError naming the parameter and what exists
ModelDraft draftModel(const RunOptions& options, SourceMesh source, ModelData& data, GlobalModel& model);
/// \param partsOfPieces from `cutOnRanks` of draft.plan.cuts
void finishModel(const ModelDraft& draft, const std::vector<std::vector<int>>& partsOfPieces, ModelData& data, GlobalModel& model);
/// @}

/// \brief Prescribed values of all Displacement conditions, sorted; serial.
/// \throws InputError for a missing set, or for two conditions that differ at a node, naming both.
std::vector<PrescribedDisplacement> collectDisplacements(const std::vector<ConditionOptions>& conditions, const Mesh& mesh);

/// \brief Pressures, tractions and body forces; serial.  \throws InputError for a missing set or block.
std::vector<Load> collectLoads(const std::vector<ConditionOptions>& conditions, const Mesh& mesh);

/// \brief Where the mesh has them: a load on nothing would be none.  Serial.  \throws InputError naming the set or block.
void requireLoadedSides(const std::vector<Load>& loads, const Mesh& mesh);

}  // namespace Haptos
