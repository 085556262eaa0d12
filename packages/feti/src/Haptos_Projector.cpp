// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Projector.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

namespace Haptos {

Projector::Projector(RCP<const NaturalCoarseSpace> G, RCP<const CoarseProblem> GGT, Onto onto)
    : G_(std::move(G)), GGT_(std::move(GGT)), onto_(onto) {}

// Q x = G^T (G G^T)^-1 G x
void Projector::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  const Eigen::MatrixXd a = GGT_->solveSum(G_->partOfG(x));
  if (onto_ == Onto::ImageOfGT) {
    G_->applyGT(a, y, alpha, beta);  // y := alpha Q x + beta y
  } else {
    y.update(alpha, x, beta);
    G_->applyGT(a, y, -alpha, 1.0);  // y := alpha (x - Q x) + beta y
  }
}

ProjectedDualOperator::ProjectedDualOperator(RCP<const DualOperator> F, RCP<const NaturalCoarseSpace> G,
                                             RCP<const CoarseProblem> GGT)
    : F_(std::move(F)), G_(std::move(G)), GGT_(std::move(GGT)) {}

void ProjectedDualOperator::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  MultiVector Ax(x.getMap(), x.getNumVectors()), Qx(x.getMap(), x.getNumVectors());
  applyWithProjection(x, Ax, Qx);
  y.update(alpha, Ax, beta);
}

// Q x is what SMALSE adds rho times of; P F P x costs nothing more: a = Q x, F (x - a), less its Q part.
void ProjectedDualOperator::applyWithProjection(const MultiVector& x, MultiVector& Ax, MultiVector& Qx) const {
  G_->applyGT(GGT_->solveSum(G_->partOfG(x)), Qx);
  MultiVector Px(x, Teuchos::Copy);
  Px.update(-1.0, Qx, 1.0);
  F_->apply(Px, Ax);
  G_->applyGT(GGT_->solveSum(G_->partOfG(Ax)), Ax, -1.0, 1.0);
}

}  // namespace Haptos
