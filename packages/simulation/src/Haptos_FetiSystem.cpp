// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_FetiSystem.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "Haptos_ElasticStiffness.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_LoadAdmissibility.hpp"
#include "Haptos_NodalLoads.hpp"
#include "Haptos_PairLaws.hpp"
#include "Haptos_SoftModes.hpp"

namespace Haptos {
namespace {

std::vector<int> sizesOf(const std::vector<Subdomain>& subdomains) {
  std::vector<int> sizes;
  for (const auto& sub : subdomains) sizes.push_back(sub.numDofs());
  return sizes;
}

bool contains(const std::vector<int>& list, int value) { return std::find(list.begin(), list.end(), value) != list.end(); }

// Sides of a group that a load acts on, each once: sets overlap, and some programs list a face twice.
std::vector<GroupSide> loadedSides(const Subdomain& sub, int group, const Load& load) {
  std::set<std::pair<int, int>> found;
  for (const auto& side : sub.sides)
    if (side.group == group && contains(load.sideSets, side.sideSet)) found.emplace(side.element, side.side);
  std::vector<GroupSide> sides;
  for (const auto& [element, side] : found) sides.push_back({element, side});
  return sides;
}

void addLoad(const Subdomain& sub, const Load& load, Eigen::Ref<Eigen::VectorXd> f) {
  const ScalarField pressure = [&](double x, double y, double z) { return load.pressure(x, y, z); };
  const VectorField vector = [&](double x, double y, double z) { return load.value(x, y, z); };
  for (int g = 0; g < int(sub.groups.size()); ++g) {
    if (load.kind == Load::Kind::BodyForce) {
      if (contains(load.blocks, sub.blockOfGroup[g])) addBodyForce(sub.coordinates, sub.groups[g], vector, f);
      continue;
    }
    const auto sides = loadedSides(sub, g, load);
    if (sides.empty()) continue;
    if (load.kind == Load::Kind::Pressure) addPressure(sub.coordinates, sub.groups[g], sides, pressure, f);
    else addTraction(sub.coordinates, sub.groups[g], sides, vector, f);
  }
}

// In how many subdomains of all ranks every mesh node lies.  Collective.
std::vector<int> countCopies(const Communicator& comm, const std::vector<Subdomain>& subdomains) {
  std::int64_t mine = 0, size = 0;  // nodes ascend in a subdomain
  for (const auto& sub : subdomains)
    if (!sub.nodes.empty()) mine = std::max(mine, sub.nodes.back() + 1);
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(size));
  std::vector<int> count(std::size_t(size), 0), all(std::size_t(size), 0);
  for (const auto& sub : subdomains)
    for (auto node : sub.nodes) ++count[node];
  Teuchos::reduceAll(comm, Teuchos::REDUCE_SUM, int(size), count.data(), all.data());
  return all;
}

// The copies of a node share its force equally.
void addForces(const Subdomain& sub, const std::vector<int>& copies, const NodalForces& forces, Eigen::Ref<Eigen::VectorXd> f) {
  for (int i = 0; i < sub.numNodes(); ++i) {
    const auto force = forces(sub.nodes[i], sub.coordinates[i]);
    for (int d = 0; d < 3; ++d) {
      if (!std::isfinite(force[d]))
        throw InputError("The nodal force at node " + std::to_string(sub.nodes[i] + 1) + " of the mesh is not finite.");
      f[3 * i + d] += force[d] / copies[sub.nodes[i]];
    }
  }
}

// Near incompressibility S is stiff against changes of volume, which F does not mirror: a capped ratio does better.
bool capMaterials(const std::vector<IsotropicMaterial>& materials, std::vector<IsotropicMaterial>& capped) {
  constexpr double kLargestRatio = 0.4;
  bool any = false;
  capped = materials;
  for (auto& material : capped) {
    any = any || material.poissonsRatio > kLargestRatio;
    material.poissonsRatio = std::min(material.poissonsRatio, kLargestRatio);
  }
  return any;
}

}  // namespace

FetiSystem::FetiSystem(const DistributedModel& model) : model_(model), law_(makeContactLaw(*model.multipliers, model.data.friction)) {
  jump_ = Teuchos::rcp(new JumpOperator(model.multipliers, model.firstSubdomain, sizesOf(model.subdomains)));
  systems_ = Teuchos::rcp(new LocalSystems(
      std::make_shared<ElasticStiffness>(model.subdomains, model.data.materials, model.data.formulation)));
}

void FetiSystem::assembleLoads() {
  f_ = Teuchos::rcp(new Vector(jump_->getDomainMap()));
  {
    const auto data = f_->getDataNonConst(0);
    for (std::size_t i = 0; i < model_.subdomains.size(); ++i) {
      Eigen::Map<Eigen::VectorXd> f(data.getRawPtr() + jump_->primalOffsets()[i], model_.subdomains[i].numDofs());
      for (const auto& load : model_.data.loads) addLoad(model_.subdomains[i], load, f);
      for (const auto& forces : model_.nodalForces) addForces(model_.subdomains[i], copies_, forces, f);
    }
  }
  c_ = Teuchos::rcp(new Vector(model_.multipliers->map()));
  const auto data = c_->getDataNonConst(0);
  std::copy(model_.multipliers->c().begin(), model_.multipliers->c().end(), data.begin());
}

void FetiSystem::assemble() {
  if (!model_.nodalForces.empty()) copies_ = countCopies(*model_.comm, model_.subdomains);
  runOnAllRanks(*model_.comm, [&] {
    systems_->assemble();
    assembleLoads();
  });
  G_ = Teuchos::rcp(new NaturalCoarseSpace(jump_, *systems_));
  std::vector<int> bodies;
  for (const auto& sub : model_.subdomains) bodies.push_back(sub.body);
  bodies_ = std::make_unique<BodyMotions>(*G_, *systems_, bodies, model_.data.bodyNames);
  const Eigen::VectorXd e = G_->restrictLoad(*f_, *systems_);
  const double loadScale = f_->norm2();
  holds_ = holdUnheldMotions(motionsUnheldBy([](RowKind kind) { return kind != RowKind::Gluing; }), *bodies_, e, loadScale);
  floating_ = motionsUnheldBy([](RowKind kind) { return kind != RowKind::Gluing && isEquality(kind); });
  requireAdmissibleLoads(law_, *model_.multipliers, *G_, e, *bodies_, loadScale);
}

template <class Holds>
UnheldMotions FetiSystem::motionsUnheldBy(Holds&& holds) const {
  std::vector<char> counts;
  for (const RowKind kind : model_.multipliers->kinds()) counts.push_back(holds(kind));
  return findUnheldMotions(*model_.comm, G_->rows(), bodies_->Z(), counts);
}

void FetiSystem::factor(LocalSolverMethod method, LocalDual dual, std::optional<PreconditionerKind> preconditioner) {
  kind_ = preconditioner;
  localMethod_ = method;
  const bool capped = capMaterials(model_.data.materials, cappedMaterials_);
  SurfaceOperators surface(kind_.value_or(PreconditionerKind::Dirichlet), method);
  const double mayUse = 0.5 * physicalMemoryBytes() / double(model_.comm->getSize());  // as if all ranks shared one machine
  runOnAllRanks(*model_.comm, [&] {
    systems_->factor(*jump_, method, dual, mayUse, [&](int) {
      if (kind_ && !capped) surface.add(*systems_, *jump_);
    });
  });
  if (!kind_) return;
  findSlender();
  RCP<const LocalSystems> systems = systems_;
  if (capped) systems = assembleAgain(surface, kind_ == PreconditionerKind::Dirichlet);
  preconditioner_ = Teuchos::rcp(new DualPreconditioner(jump_, systems, std::move(surface)));
}

// K once more, each class as long as the preconditioner's part of it is made.
RCP<const LocalSystems> FetiSystem::assembleAgain(SurfaceOperators& surface, bool dense) const {
  const auto systems =
      Teuchos::rcp(new LocalSystems(std::make_shared<ElasticStiffness>(model_.subdomains, cappedMaterials_, model_.data.formulation)));
  runOnAllRanks(*model_.comm, [&] {
    systems->assemble();
    if (dense) systems->condenseLike(*systems_);
    else systems->findClasses();
    for (int c = 0; c < systems->numClasses(); ++c) {
      surface.add(*systems, *jump_);
      systems->releaseStiffness(c);
    }
  });
  return systems;
}

void FetiSystem::formDual(const CoarseOptions& coarse) {
  const auto F = Teuchos::rcp(new DualOperator(jump_, systems_));
  const auto placement = std::make_shared<CoarsePlacement>(model_.comm, G_->dimension(), coarse);
  std::vector<double> isGluing, isContact;
  for (const auto kind : model_.multipliers->kinds()) {
    isGluing.push_back(isEquality(kind));
    isContact.push_back(!isEquality(kind));
  }
  RCP<CoarseProblem> GGT;
  try {
    GGT = Teuchos::rcp(
        new CoarseProblem(placement, {G_->rows(), isGluing}, {G_->rows(), isContact}, holds_, CoarseProblem::Factor::Now));
  } catch (const std::runtime_error&) {  // thrown on all ranks
    if (model_.data.hinged.empty()) throw;
    throw InsufficientModel("The model has no solution: pieces of body '" + model_.data.hinged.front() +
                            "' hang together by single nodes or edges, and a rotation about these is held by nothing. "
                            "Join them by element sides, or hold every piece.");
  }
  dual_ = makeDualProblem(F, G_, GGT, *f_, *c_);
}

void FetiSystem::findSlender() {
  slender_.clear();
  for (const auto& sub : model_.subdomains) slender_.push_back(kind_ == PreconditionerKind::Dirichlet && isSlender(sub.coordinates));
  const int mine = std::count(slender_.begin(), slender_.end(), char(1)) > 0;
  int any = 0;
  Teuchos::reduceAll(*model_.comm, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(any));
  anySlender_ = any != 0;
}

RCP<const DeflatedPreconditioner> FetiSystem::makeDeflated() const {
  if (kind_ != PreconditionerKind::Dirichlet) return {};
  // Soft motions live in the last digits of S, and G M = 0 asks for all of them.
  SurfaceOperators surface(*kind_, localMethod_, std::vector<char>(slender_.size(), 1));
  const auto systems = assembleAgain(surface, false);
  return DeflatedPreconditioner::make(Teuchos::rcp(new DualPreconditioner(jump_, systems, std::move(surface))), slender_);
}

}  // namespace Haptos
