// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Tpetra_Operator.hpp>
#include <memory>
#include <vector>

#include "Haptos_JumpOperator.hpp"

namespace Haptos {

class LocalSystems;
class RowGram;
class SurfaceOperators;

/// \brief M = B_D S B_D^T with B_D = (B W B^T)^+ B W; S the Schur complements (Dirichlet) or K_bb (lumped).
///
/// S acts on the unknowns that B touches; all others follow with least energy.  Congruent subdomains share one S and are multiplied
/// together.  apply is Collective: one Import, one Export, and what `RowGram` sends where rows of pairs meet across ranks.
/// Sources: Farhat and Roux 1991 (lumped), Farhat, Mandel and Roux 1994 (Dirichlet), Rixen and Farhat 1999 (scaling).
class DualPreconditioner final : public Operator {
 public:
  /// \param surface of all classes of `systems`
  DualPreconditioner(RCP<const JumpOperator> jump, RCP<const LocalSystems> systems, SurfaceOperators surface);
  ~DualPreconditioner();

  RCP<const Map> getDomainMap() const override { return jump_->getRangeMap(); }
  RCP<const Map> getRangeMap() const override { return jump_->getRangeMap(); }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0,
             double beta = 0.0) const override;

  /// \brief Diagonal of M up to the coupling of different rows at one node: sum of B_D^2 diag(S) [force/length], S as
  /// `SurfaceOperators::diagonal` has it.  Collective.
  RCP<Vector> diagonal() const;

  long applications() const { return applications_; }

  /// \brief t := B_D^T x, dual to primal.  Collective.
  void spread(const MultiVector& x, MultiVector& t) const;
  /// \brief y := B_D t, primal to dual; t is changed.  Collective.
  void collect(MultiVector& t, MultiVector& y) const;
  /// \brief t := t - B_D^T B t, primal: the mean of copies weighted by stiffness, at closed contact of both sides too; B t = 0 after it,
  /// as B B_D^T = 1.  Collective.
  void average(MultiVector& t) const;

  const JumpOperator& jump() const { return *jump_; }
  const RowGram& gram() const { return *gram_; }
  const LocalSystems& systems() const { return *systems_; }
  const SurfaceOperators& surface() const { return *surface_; }  ///< S, class by class

 private:
  void applyLocal(MultiVector& t) const;
  void scale(MultiVector& t) const;  // t := W t
  void spreadInPlace(MultiVector& z, MultiVector& t) const;  // z is changed

  RCP<const JumpOperator> jump_;
  RCP<const LocalSystems> systems_;
  std::unique_ptr<const RowGram> gram_;
  std::vector<double> weights_;                // [local primal] W, 0 where B has no entry
  std::unique_ptr<const SurfaceOperators> surface_;
  mutable RCP<MultiVector> t_;  // of the last application: other memory would be other pages each time
  mutable long applications_ = 0;
};

}  // namespace Haptos
