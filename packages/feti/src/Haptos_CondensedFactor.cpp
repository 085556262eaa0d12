// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CondensedFactor.hpp"

#include <Teuchos_Assert.hpp>
#include <stdexcept>

namespace Haptos {

void CondensedFactor::renew(const CoarseBlocks& E) {
  for (const auto& [key, block] : E.blocks())
    TEUCHOS_ASSERT(A_->isLast(CoarseBlocks::row(key)) && A_->isLast(CoarseBlocks::column(key)));
  Eigen::MatrixXd L = A_->schur();
  A_->addLast(E, L);
  TEUCHOS_TEST_FOR_EXCEPTION(!Lapack::choleskyInPlace(L), std::runtime_error,
                             "the coarse matrix of " << A_->order().size() << " unknowns is not positive definite in the " << schurSize()
                                                     << " that change");
  changing_ = DenseCholesky(std::move(L), DenseSymmetric::Storage::Full);
}

Eigen::MatrixXd CondensedFactor::solve(const Eigen::MatrixXd& B) const {
  Eigen::MatrixXd Y = A_->eliminate(B);
  solveSchur(Y.bottomRows(schurSize()));
  return A_->substituteBack(Y);
}

}  // namespace Haptos
