// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ExactContact.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "Haptos_ContactCoarse.hpp"
#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {
namespace {

// What of K is symmetric and positive, apart in the normal and in the tangential directions.
Eigen::Matrix3d symmetricPart(const Eigen::Matrix3d& K) {
  Eigen::Matrix3d D = Eigen::Matrix3d::Zero();
  const Eigen::Matrix2d T = 0.5 * (K.bottomRightCorner<2, 2>() + K.bottomRightCorner<2, 2>().transpose());
  const SymmetricEigen2 eigen(T);
  D(0, 0) = std::max(0.0, K(0, 0));
  D.bottomRightCorner<2, 2>() = eigen.vectors * eigen.values.cwiseMax(0).asDiagonal() * eigen.vectors.transpose();
  return D;
}

}  // namespace

const Eigen::VectorXd* ExactContact::productOfLast(const Eigen::VectorXd& x) const {
  const bool isLast = x.size() == last_.x.size() && (x.array() == last_.x.array()).all();
  return vectors_.sum(double(!isLast)) == 0 ? &last_.Mx : nullptr;
}

ExactContact::Map ExactContact::solverWith(const Blocks& K) const {
  return [this, K, solve = M_.solverWith(K)](const Eigen::VectorXd& b) {
    last_.x = solve(b);
    last_.Mx = b - multiplyBlocks(K, last_.x);
    return last_.x;
  };
}

ExactContact::Map ExactContact::solverNear(const Blocks& K) const {
  constexpr double kLittle = 1e-8;
  Blocks more = K;
  for (std::size_t i = 0; i < more.size(); ++i) more[i].diagonal() += kLittle * diagonal_.segment<3>(3 * Eigen::Index(i));
  return solverWith(more);
}

// With A_e = A + e B / diag M, which has an inverse where pairs stick, A_e^-1 (A M + B) is about M + A_e^-1 B.  By the part of it that is not symmetric
// tangential forces follow normal ones, which bodies hardly answer by normal forces: ten steps of GMRES.  With the symmetric part of the whole block,
// where the stiffness of closed pairs meets no tangential one, they were a hundred.
void ExactContact::prepare(ContactEquations& equations, const Blocks& A, const Blocks& B) const {
  constexpr double kLittle = 1e-3;
  Blocks inverse, D;
  for (std::size_t i = 0; i < A.size(); ++i) {
    const Eigen::Vector3d diagonal = diagonal_.segment<3>(3 * Eigen::Index(i));
    inverse.push_back((A[i] + kLittle * B[i] * diagonal.cwiseInverse().asDiagonal()).inverse());
    D.push_back(symmetricPart(inverse.back() * B[i]));
  }
  equations.matrix = [this, &A, &B](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    const Eigen::VectorXd* known = productOfLast(x);
    return multiplyBlocks(A, known ? *known : multiply(x)) + multiplyBlocks(B, x);
  };
  equations.preconditioner = [inverse = std::move(inverse), solve = solverNear(D)](const Eigen::VectorXd& r) { return solve(multiplyBlocks(inverse, r)); };
}

}  // namespace Haptos
