// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "Haptos_AssembledPreconditioner.hpp"
#include "Haptos_BodyMotions.hpp"
#include "Haptos_DeflatedPreconditioner.hpp"
#include "Haptos_DualPreconditioner.hpp"
#include "Haptos_DualProblem.hpp"
#include "Haptos_SystemModel.hpp"
#include "Haptos_TouchedUnknowns.hpp"

namespace Haptos {

inline constexpr const char* kLooseModel =
    "The model cannot be solved with 16 digits: parts of it are held or joined by next to nothing. "
    "Hold or join them; Solver->Method = SMALSE bears more.";

class SurfaceOperators;

/// \brief Stiffnesses, B, G, F, projectors and the dual problem of a distributed model, built in phases.
///
/// `assemble` and `setStep` check all that can be checked without a factor (inverted elements, unheld bodies, loads that
/// contact cannot carry); `factor` and `formDual` do the rest.  All Collective.
class FetiSystem {
 public:
  explicit FetiSystem(SystemModel model);

  /// \throws InputError, InsufficientModel on all ranks
  void assemble();
  /// \brief Loads and right-hand sides; once the dual problem is formed this costs one K^+.
  /// \throws InsufficientModel on all ranks where nothing carries the loads; the step before stays then
  void setStep(StepData step);
  void setFriction(std::vector<std::string> names, std::vector<FrictionSpec> friction);

  /// \brief How K^+ is applied, see `LocalDual`: dense matrices take at most half the memory of a machine.
  /// \param preconditioner made in the same go, or none: K is let go after it
  void factor(const LocalSolverOptions& options, std::optional<PreconditionerKind> preconditioner);
  void formDual(const CoarseOptions& coarse = {});
  bool isFormed() const { return !dual_.F.is_null(); }

  /// \brief Other rows of B on the same subdomains; what was factored or formed is made to fit, sparse factors stay.  Needs a
  /// new step.
  void renewRows(RCP<const MultiplierMap> multipliers);

  const SystemModel& model() const { return model_; }
  const ContactLaw& law() const { return law_; }
  const JumpOperator& jump() const { return *jump_; }
  const LocalSystems& systems() const { return *systems_; }
  int kernelDimension() const { return G_->dimension(); }  ///< l
  const BodyMotions& bodies() const { return *bodies_; }
  const UnheldMotions& unheldMotions() const { return unheld_; }  ///< of bodies that no row holds: balanced loads may act on them
  const UnheldMotions& floatingMotions() const { return floating_; }  ///< of bodies that contact alone holds, if anything
  /// \brief Motions that nothing holds at these multipliers: no equality row, no closed pair, no tangential row of one that sticks.  Collective.
  UnheldMotions motionsUnheldAt(const Vector& lambda, const StateScales& scales) const;
  const StepData& step() const { return step_; }
  const Vector& f() const { return *step_.f; }
  const Vector& c() const { return *step_.c; }
  const DualProblem& dual() const { return dual_; }
  const RCP<const DualPreconditioner>& preconditioner() const { return preconditioner_; }  ///< or null
  /// \brief Whether the preconditioner is known to be poor from the start: slender subdomains, or hard elements whose spectral modes cost little.
  bool needsDeflation() const { return anySlender_ || (model_.isHard && hasSpectra(kCheapSpectrum)); }
  /// \brief Whether looking for spectral modes takes longer than some more steps with contact models do that lack them.  Collective.
  bool isDeflationDear() const;
  int largestBoundary() const { return largestBoundary_; }  ///< unknowns of any subdomain's boundary that rows touch
  /// \brief The preconditioner with rigid motions deflated, soft ones of slender subdomains and spectral ones of others; null where it is not
  /// Dirichlet's, or there would be too many.  Collective.
  RCP<const DeflatedPreconditioner> makeDeflated(const DeflatedMotions::Spectra& spectra) const;
  /// \brief F^-1 by a factor of whole bodies, where subdomains are slender and it takes less than `makeDeflated` and what comes after; else null.  Collective.
  RCP<const AssembledPreconditioner> makeAssembled() const;
  /// \brief The preconditioner with rigid motions and soft polynomials of subdomains deflated, several times cheaper; null where there are too many.
  /// Collective.
  RCP<const DeflatedPreconditioner> makeDeflatedByPolynomials() const;
  /// \brief Whether these are likely to help: most subdomains bend as plates do, none is slender.
  bool mayDeflateByPolynomials() const {
    return areFlat_ && kind_ == PreconditionerKind::Dirichlet && !needsDeflation() && G_->dimension() <= DeflatedMotions::kMostRigid;
  }

 private:
  static constexpr int kCheapSpectrum = 300;  ///< unknowns of a boundary: from the first step on only where dense S costs little (decisions/042)
  void useRows();
  void requireRoom(const Vector& c) const;
  template <class Holds>
  UnheldMotions motionsUnheldBy(Holds&& holds) const;
  void findSlender();
  void findLargestBoundary();
  bool hasSpectra(int largestSpectrum) const;
  bool mayContactBeDense() const;
  double sumOfCubes() const;
  void makePreconditioner(SurfaceOperators surface);
  RCP<const LocalSystems> assembleAgain(const std::shared_ptr<const SubdomainStiffness>& stiffness, SurfaceOperators& surface, bool dense,
                                        const std::function<void(const LocalSystems&, int congruenceClass)>& use = {}) const;

  SystemModel model_;
  ContactLaw law_;
  RCP<JumpOperator> jump_;
  std::unique_ptr<TouchedUnknowns> touched_;
  RCP<LocalSystems> systems_;
  RCP<NaturalCoarseSpace> G_;
  std::unique_ptr<BodyMotions> bodies_;
  UnheldMotions unheld_, floating_;
  StepData step_;
  DualProblem dual_;
  RCP<const DualPreconditioner> preconditioner_;
  CoarseOptions coarse_;
  LocalSolverMethod localMethod_ = LocalSolverMethod::Automatic;
  std::optional<PreconditionerKind> kind_;
  std::vector<char> slender_;  ///< [local subdomains]
  bool anySlender_ = false;
  bool areFlat_ = false;  // most subdomains of all ranks
  int largestBoundary_ = 0;
  double mayUse_ = 0;  // bytes of a rank, the same on all
};

}  // namespace Haptos
