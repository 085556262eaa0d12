// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoarseSchurFactor.hpp"

#include <Teuchos_Assert.hpp>
#include <stdexcept>

namespace Haptos {

// S + E = L L^T, dense.  In single precision where three digits of a known solution come back, and else in double: it shapes
// directions, their balance is restored with a factor in double.
void CoarseSchurFactor::renew(const CoarseBlocks& E) {
  for (const auto& [key, block] : E.blocks())
    TEUCHOS_ASSERT(A_->isLast(CoarseBlocks::row(key)) && A_->isLast(CoarseBlocks::column(key)));
  Eigen::MatrixXd sum(schurSize(), schurSize());
  Lapack::unpackLower(A_->packedSchur(), sum);
  A_->addLast(E, sum);
  isSingle_ = precision_ == FactorPrecision::Single && single_.factor(sum);
  if (isSingle_) return;
  TEUCHOS_TEST_FOR_EXCEPTION(!Lapack::choleskyInPlace(sum), std::runtime_error,
                             "the coarse matrix of " << A_->order().size() << " unknowns is not positive definite in the " << schurSize()
                                                     << " that change");
  double_ = DenseCholesky(std::move(sum), DenseSymmetric::Storage::Packed);
}

void CoarseSchurFactor::solveSchur(Eigen::Ref<Eigen::MatrixXd> last) const {
  if (isSingle_) single_.solve(last);
  else double_.solve(last);
}

// y_o = L_oo^-1 b_o,  x_c = (S + E)^-1 (b_c - L_co y_o),  x_o = L_oo^-T (y_o - L_co^T x_c)
Eigen::MatrixXd CoarseSchurFactor::solve(const Eigen::MatrixXd& B) const {
  Eigen::MatrixXd Y = A_->eliminate(B);
  solveSchur(Y.bottomRows(schurSize()));
  return A_->substituteBack(Y);
}

}  // namespace Haptos
