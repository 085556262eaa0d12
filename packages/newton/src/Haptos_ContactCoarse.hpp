// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "Haptos_ContactKrylov.hpp"
#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {

/// \brief Y_i := A_i X_i of pairs
template <class Values>
Values multiplyBlocks(const std::vector<Eigen::Matrix3d>& A, const Values& X) {
  Values Y(X.rows(), X.cols());
  for (std::size_t i = 0; i < A.size(); ++i) Y.template middleRows<3>(3 * Eigen::Index(i)) = A[i] * X.template middleRows<3>(3 * Eigen::Index(i));
  return Y;
}

/// \brief A coarse space Q of jumps for Krylov methods on contact rows, with M Q: jumps of many pairs that M resists little (thin bodies bend).
///
/// All matrices have this rank's contact values [3 pairs].
class ContactCoarse {
 public:
  using Blocks = std::vector<Eigen::Matrix3d>;  ///< [pairs]
  using Product = std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>;  ///< M times columns.  Collective.

  /// \param jumps [3 pairs x any], maybe dependent
  /// \param diagonal [3 pairs] about M's, > 0, which says how jumps are compared
  /// \param kernel [3 pairs x k], M kernel = 0; it is left out of Q.  Collective.
  ContactCoarse(const DualVectors& vectors, const Eigen::MatrixXd& jumps, const Eigen::VectorXd& diagonal, const Eigen::MatrixXd& kernel, const Product& M);

  ContactCoarse scaled(double factor) const;  ///< for `factor` times M and the diagonal

  const Eigen::MatrixXd& Q() const { return Q_; }  ///< orthonormal in the diagonal's product
  const Eigen::VectorXd& diagonal() const { return diagonal_; }
  const DualVectors& vectors() const { return vectors_; }

  /// \brief Appends Q to motions W with W^T K W = 1, M W = 0, without their part in these, and makes `solve` of (W, Q)^T (M + K) (W, Q).  Collective.
  void appendTo(KnownMotions& known, const Blocks& K) const;

 private:
  const DualVectors& vectors_;
  Eigen::VectorXd diagonal_;
  Eigen::MatrixXd Q_, MQ_;
};

/// \brief Preconditioner of G = A M + B on two levels, by Galerkin's method in what pairs solve by themselves:
///
///   P r = z + (Z - P_1 G Z) C^-1 R^T z,   z = P_1 r,   Z = (A D + B)^-1 A D Q,   R = D Z,   C = R^T P_1 G Z,
///
/// D the diagonal, P_1 the first level (`SchwarzPreconditioner`).  Z is what the law lets of the coarse jumps: nothing of those of pairs that stick.
/// Source of the form: Tang, Nabben, Vuik, Erlangga, J. Sci. Comput. 39 (2009) 340 (A-DEF2).
class TwoLevelPreconditioner {
 public:
  using Level = std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>;
  /// \param coarse stays with the caller
  TwoLevelPreconditioner(const ContactCoarse& coarse, ContactCoarse::Product M, Level first) : coarse_(coarse), M_(std::move(M)), first_(std::move(first)) {}

  /// \brief For another system and its P_1; products with M are made where many pairs have changed.  \param inverse (A D + B)^-1.  Collective.
  void renew(const ContactCoarse::Blocks& A, const ContactCoarse::Blocks& B, const ContactCoarse::Blocks& inverse);

  Eigen::VectorXd apply(const Eigen::VectorXd& r) const;  ///< Collective: one reduction, and what P_1 has

 private:
  const ContactCoarse& coarse_;
  ContactCoarse::Product M_;
  Level first_;                  // P_1
  bool isMade_ = false;          // Z, by products with M
  ContactCoarse::Blocks free_;   // (A D + B)^-1 A D that Z was made with
  Eigen::MatrixXd Z_, MZ_, step_;  // step: Z - P_1 G Z
  DenseFactor factor_;           // of C
};

}  // namespace Haptos
