// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {

/// \brief Combinations of motions that B resists, and of those that it does not feel (a coefficient 0), by its images of them [any x k].
struct MotionsOfB {
  Eigen::MatrixXd held, free;  ///< [k x some], orthonormal
  /// \param images the same on all ranks, or R of their QR; all are held where they are not finite, by a step that is given up
  explicit MotionsOfB(const Eigen::MatrixXd& images);
};

/// \brief (A M + B) d = b by forces f = M d, d = C f + N a: an LU of the rows alone whose force no pair tells by itself.  Serial.
///
/// Where most pairs are open that is a small part of M.  Vectors have all contact values [n], three a pair.
class ForceFactor {
 public:
  /// \param C [n x n] with M C f = f for f orthogonal to the kernel, 0 where M has nothing: kept by reference
  /// \param kernel [n x k] orthonormal, M kernel = 0
  /// \param blocks [n x 6] row by row A_i and B_i of the row's pair
  ForceFactor(const Eigen::MatrixXd& C, const Eigen::MatrixXd& kernel, const Eigen::MatrixXd& blocks);

  /// \brief d, as good as C is; NaN where the matrix is singular.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

  Eigen::Index numFactored() const { return Eigen::Index(unknown_.size()) + kernel_.cols(); }  ///< rows

  /// \brief Whether a row says A f = b by itself: open pairs, tangential forces without friction.
  static bool isKnown(const Eigen::MatrixXd& blocks, Eigen::Index row);

 private:
  Eigen::VectorXd knownForces(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd matrix() const;
  double times(int first, Eigen::Index row, const Eigen::Ref<const Eigen::VectorXd>& x) const;

  const Eigen::MatrixXd& C_;
  Eigen::MatrixXd kernel_, blocks_;            // of the kernel what B resists
  std::vector<Eigen::Index> known_, unknown_;  // rows of which M has something
  double length_ = 1;                          // of a, so that rows of balance are as large as others
  DenseFactor factor_;                         // of (f, a)
};

}  // namespace Haptos
