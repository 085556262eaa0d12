// SPDX-License-Identifier: BSD-3-Clause
// What tests compute references with: Eigen's decompositions of dense matrices, compiled once.  Each costs 2 to 10 seconds wherever one line uses
// it.  Nothing of the library under test is in them.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

namespace Haptos::Testing {

/// Eigenvalues ascend; eigenvectors are orthonormal columns.  The lower triangle counts.
struct SymmetricSpectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
  explicit SymmetricSpectrum(const Eigen::MatrixXd& A);
};

Eigen::VectorXd symmetricEigenvalues(const Eigen::MatrixXd& A);
Eigen::VectorXd generalizedEigenvalues(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);  ///< of A v = theta B v
Eigen::VectorXd realEigenvalues(const Eigen::MatrixXd& A);                                   ///< real parts, A not symmetric
Eigen::VectorXd singularValues(const Eigen::MatrixXd& A);                                    ///< in descending order

Eigen::MatrixXd inverse(const Eigen::MatrixXd& A);
Eigen::VectorXd luSolve(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);         ///< partial pivoting
Eigen::MatrixXd choleskySolve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
double choleskyRcond(const Eigen::MatrixXd& A);                                      ///< 0 where A is not definite
Eigen::MatrixXd ldltSolve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);
Eigen::VectorXd qrSolve(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);         ///< least squares, column pivoting
Eigen::MatrixXd leastNormSolve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B);  ///< complete orthogonal decomposition
Eigen::MatrixXd pseudoInverse(const Eigen::MatrixXd& A);                             ///< the same

/// x of A x = b for many b.
using Solve = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;
Solve luFactor(const Eigen::MatrixXd& A);
Solve ldltFactor(const Eigen::MatrixXd& A);

Eigen::MatrixXd squareQ(const Eigen::MatrixXd& A);          ///< all columns of Q, A = Q R by Householder
Eigen::MatrixXd thinQ(const Eigen::MatrixXd& A);            ///< as many as A has
std::vector<int> pivotedColumns(const Eigen::MatrixXd& A);  ///< in the order in which QR with column pivoting takes them
Eigen::MatrixXd nullSpace(const Eigen::MatrixXd& A, double threshold);  ///< by LU with complete pivoting; columns as they come

}  // namespace Haptos::Testing
