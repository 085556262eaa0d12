// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoarseProblem.hpp"

#include "Haptos_CoarseBlocks.hpp"

namespace Haptos {

CoarseProblem::CoarseProblem(const Communicator& comm, const CoarseRows& C, const std::vector<double>& q, const Holds& holds) {
  CoarseBlocks mine;
  mine.addGram(C, q);
  const CoarseBlocks all = mine.sumOverRanks(comm);
  factor_ = std::make_unique<LocalSolverFactor>(all.toMatrix(C.cols(), holds, all.largestDiagonal()), LocalSolverMethod::Automatic);
  factor_->releaseMatrix();
}

Eigen::MatrixXd CoarseProblem::solve(const Eigen::MatrixXd& b) const {
  Eigen::MatrixXd x(b.rows(), b.cols());
  factor_->solve(b, x);
  solves_ += long(b.cols());
  return x;
}

}  // namespace Haptos
