// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Tpetra_Operator.hpp>

#include "Haptos_DualOperator.hpp"
#include "Haptos_NaturalCoarseSpace.hpp"

namespace Haptos {

/// \brief Q = G^T (G G^T)^-1 G, or P = I - Q: the orthogonal projectors on Im G^T and Ker G.
///
/// apply is Collective: one reduction of l numbers and one coarse solve.
class Projector final : public Operator {
 public:
  enum class Onto { ImageOfGT /*Q*/, KernelOfG /*P*/ };

  Projector(RCP<const NaturalCoarseSpace> G, RCP<const CoarseProblem> GGT, Onto onto);

  RCP<const Map> getDomainMap() const override { return G_->getDomainMap(); }
  RCP<const Map> getRangeMap() const override { return G_->getDomainMap(); }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0,
             double beta = 0.0) const override;

 private:
  RCP<const NaturalCoarseSpace> G_;
  RCP<const CoarseProblem> GGT_;
  Onto onto_;
};

/// \brief A = P F P on the dual map; two coarse solves an application, Q x comes with them.  Collective.
class ProjectedDualOperator final : public Operator {
 public:
  ProjectedDualOperator(RCP<const DualOperator> F, RCP<const NaturalCoarseSpace> G, RCP<const CoarseProblem> GGT);

  RCP<const Map> getDomainMap() const override { return F_->getDomainMap(); }
  RCP<const Map> getRangeMap() const override { return F_->getDomainMap(); }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0,
             double beta = 0.0) const override;

  /// \brief Ax := P F P x and Qx := Q x; the coarse solve for Q x is that of the first P.
  void applyWithProjection(const MultiVector& x, MultiVector& Ax, MultiVector& Qx) const;

 private:
  RCP<const DualOperator> F_;
  RCP<const NaturalCoarseSpace> G_;
  RCP<const CoarseProblem> GGT_;
};

}  // namespace Haptos
