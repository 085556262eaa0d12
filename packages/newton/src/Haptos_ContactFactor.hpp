// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "Haptos_ContactNumbering.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_ForceFactor.hpp"

namespace Haptos {

/// \brief A M + B of a dense M, factored: by LU, of jumps or of forces, or by Cholesky's method where A = 1 and B is symmetric.  Serial.
///
/// Vectors have all contact values [n], three a pair.  Rows that pairs solve by themselves are no part of the factor, and motions of the
/// kernel of M, which only B resists, are solved for by themselves.
class ContactFactor {
 public:
  enum class Shape { General, Symmetric };

  /// \param M [n x n] symmetric; \param kernel [n x k] orthonormal, M kernel = 0: both kept by reference
  /// \param blocks [n x 6] row by row A_i and B_i of the row's pair
  ContactFactor(const Eigen::MatrixXd& M, const Eigen::MatrixXd& kernel, Eigen::MatrixXd blocks, Shape shape);
  /// \brief By forces.  \param C of `ForceFactor`, as good as M allows: `isSolution` tells
  ContactFactor(const Eigen::MatrixXd& M, const Eigen::MatrixXd& kernel, const Eigen::MatrixXd& C, Eigen::MatrixXd blocks);
  /// \brief Whether pairs tell more forces by themselves than jumps: the other rows are what is factored.
  static bool isSmallerByForces(const Eigen::MatrixXd& blocks);

  /// \brief Where motions of the kernel are free: of what can be solved of b, motions resting.  By forces b must be such.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// \brief Whether x, of the `solve` of b, is a solution as good as round-off lets it be: another singular matrix has none, and no factor tells.
  bool isSolution(const Eigen::VectorXd& x, const Eigen::VectorXd& b) const;
  /// \brief That of least norm, where there is none.
  Eigen::VectorXd solveLeastSquares(const Eigen::VectorXd& b) const;

  bool hasFree() const { return impossible_.cols() > 0; }  ///< motions that neither M nor B feels; not by forces
  Eigen::Index numFactored() const { return forces_ ? forces_->numFactored() : Eigen::Index(rest_.size()); }  ///< rows

  /// \brief Pairs whose other blocks differ from these by more than a tenth.
  int numChanged(const Eigen::MatrixXd& blocks) const;

 private:
  double A(Eigen::Index row, Eigen::Index k) const { return blocks_(row, k); }
  double B(Eigen::Index row, Eigen::Index k) const { return blocks_(row, 3 + k); }
  bool isSolvedByPair(Eigen::Index row) const { return !forces_ && isKnown(blocks_, row); }
  void findRest();
  Eigen::VectorXd solvedByPairs(const Eigen::VectorXd& b) const;
  Eigen::VectorXd residual(const Eigen::VectorXd& b, const Eigen::VectorXd& x) const;
  double sizeOfProducts(const Eigen::VectorXd& x) const;
  Eigen::VectorXd withRest(Eigen::VectorXd x, const Eigen::VectorXd& rest) const;
  Eigen::MatrixXd restMatrix() const;
  Eigen::MatrixXd symmetricRestMatrix() const;
  Eigen::MatrixXd timesOnRest(double (ContactFactor::*block)(Eigen::Index, Eigen::Index) const, const Eigen::MatrixXd& X) const;
  Eigen::MatrixXd kernelOnRest() const;
  void prepareKernel(const Eigen::MatrixXd& held);
  void prepareImpossible(const Eigen::MatrixXd& free);
  Eigen::VectorXd possible(const Eigen::VectorXd& b) const;

  const Eigen::MatrixXd &M_, &kernel_;
  Eigen::MatrixXd blocks_;
  std::optional<ForceFactor> forces_;
  std::vector<Eigen::Index> rest_;  // rows that are left to be solved for
  DenseFactor factor_;              // of G, their part, or nothing
  // Of motions that B resists, on the rest: N, G^-1 B N, and N^T G^-1 B N scaled to unit diagonal.
  Eigen::MatrixXd held_, answers_, small_;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd impossible_;  // Z on the rest, orthonormal
};

}  // namespace Haptos
