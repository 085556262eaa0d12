// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "Haptos_BodyMotions.hpp"
#include "Haptos_ContactLaw.hpp"
#include "Haptos_DistributedModel.hpp"
#include "Haptos_DeflatedPreconditioner.hpp"
#include "Haptos_DualPreconditioner.hpp"
#include "Haptos_DualProblem.hpp"

namespace Haptos {

/// \brief Stiffnesses, B, G, F, projectors and the dual problem of a distributed model, built in three phases.
///
/// `assemble` checks all that can be checked without a factor (inverted elements, unheld bodies, loads that
/// contact cannot carry); `factor` and `formDual` do the rest.  All Collective.
class FetiSystem {
 public:
  explicit FetiSystem(const DistributedModel& model);

  /// \throws InputError, InsufficientModel on all ranks
  void assemble();
  /// \param dual how K^+ is applied, see `LocalDual`; dense matrices take at most half the machine's memory
  /// \param preconditioner made in the same go, or none: K is let go after it
  void factor(LocalSolverMethod method, LocalDual dual, std::optional<PreconditionerKind> preconditioner);
  void formDual(const CoarseOptions& coarse = {});

  const DistributedModel& model() const { return model_; }
  const ContactLaw& law() const { return law_; }
  const JumpOperator& jump() const { return *jump_; }
  const LocalSystems& systems() const { return *systems_; }
  const BodyMotions& bodies() const { return *bodies_; }
  const CoarseProblem::Holds& holds() const { return holds_; }
  const UnheldMotions& floatingMotions() const { return floating_; }  ///< of bodies that contact alone holds, if anything
  const Vector& f() const { return *f_; }
  const Vector& c() const { return *c_; }
  const DualProblem& dual() const { return dual_; }
  const RCP<const DualPreconditioner>& preconditioner() const { return preconditioner_; }  ///< or null
  bool hasSlenderSubdomains() const { return anySlender_; }  ///< on any rank, and the preconditioner is Dirichlet's
  /// \brief The preconditioner with rigid motions deflated, and the soft ones of slender subdomains; null where it is not
  /// Dirichlet's, or there would be too many.  Collective.
  RCP<const DeflatedPreconditioner> makeDeflated() const;

 private:
  void assembleLoads();
  template <class Holds>
  UnheldMotions motionsUnheldBy(Holds&& holds) const;
  void findSlender();
  RCP<const LocalSystems> assembleAgain(SurfaceOperators& surface, bool dense) const;

  const DistributedModel& model_;
  ContactLaw law_;
  RCP<JumpOperator> jump_;
  RCP<LocalSystems> systems_;
  RCP<NaturalCoarseSpace> G_;
  std::unique_ptr<BodyMotions> bodies_;
  CoarseProblem::Holds holds_;
  UnheldMotions floating_;
  RCP<Vector> f_, c_;
  std::vector<int> copies_;  ///< [mesh nodes] subdomains that share a node; only for nodal forces
  DualProblem dual_;
  RCP<const DualPreconditioner> preconditioner_;
  std::vector<IsotropicMaterial> cappedMaterials_;  ///< of the preconditioner
  LocalSolverMethod localMethod_ = LocalSolverMethod::Automatic;
  std::optional<PreconditionerKind> kind_;
  std::vector<char> slender_;  ///< [local subdomains]
  bool anySlender_ = false;
};

}  // namespace Haptos
