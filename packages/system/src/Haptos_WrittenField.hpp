// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_Accuracy.hpp"

namespace Haptos {

/// \brief The displacements v that are written, one value for all copies of a node, and what they lack of equilibrium:
///
///   r = sum over copies of f - K v - B^T lambda,  0 where a displacement is prescribed,
///
/// since what is left there is the force of the support; gluing forces cancel in the sum.  It begins with the means of the copies of u.
/// What copies differ by costs force, the more the stiffer they are: `smooth` takes that away as far as it varies from element to element.
class WrittenField {
 public:
  /// \param u on the primal map [length], \param residual f - K u - B^T lambda [force].  Collective.
  WrittenField(const AccuracyInput& model, const Vector& u, const Vector& residual);

  double imbalance() const { return imbalance_; }        ///< || r ||_2 over the nodes [force]
  std::int64_t worstNode() const { return worstNode_; }  ///< mesh node with the largest r; -1: r = 0
  const RCP<Vector>& v() const { return v_; }            ///< on the primal map [length]

  /// \brief Sweeps of the Chebyshev method of the fourth kind on D^-1 K, D the row sums of |K_ij|, until || r ||_2 <= enough [force].
  ///
  /// It needs no bound of the spectrum but 1 and damps every body by itself, whatever their stiffnesses [lottes-2023].
  /// Contact forces stay as they are.  Collective.
  void smooth(double enough);

 private:
  enum class Keep { Means, UnsupportedMeans };
  void project(Vector& x, Keep keep) const;
  RCP<Vector> makeDiagonal() const;
  void measure();

  const AccuracyInput& model_;
  RCP<Vector> v_, r_;          // r_: what the change from u to v costs; each copy has the same share
  RCP<const Vector> residual_;  // of u
  double imbalance_ = 0;
  std::int64_t worstNode_ = -1;
};

}  // namespace Haptos
