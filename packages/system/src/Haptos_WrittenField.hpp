// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_Accuracy.hpp"

namespace Haptos {

/// \brief Beyond the usual one multiplications by F are the cheaper way; the last one is for what they cannot better.
enum class SmoothingEffort { Usual, Last };

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

  /// \brief Steps of conjugate residuals for K v = f - B^T lambda, preconditioned by D, the row sums of |K_ij|, until
  /// || r ||_2 <= enough [force] or what `effort` bounds; v is the best of all steps, and r what it lacks as its digits are.
  ///
  /// Contact forces stay as they are.  Collective: five reductions a step.
  void smooth(double enough, SmoothingEffort effort = SmoothingEffort::Usual);

 private:
  enum class Keep { Means, UnsupportedMeans };
  void project(Vector& x, Keep keep) const;
  RCP<Vector> makeDiagonal() const;
  void multiply(const Vector& x, Vector& y, const StiffnessProduct& product) const;
  void updateSince(const Vector& before);
  void measure();

  const AccuracyInput& model_;
  RCP<Vector> v_, r_;  // each copy has the same share of r_
  double imbalance_ = 0;
  std::int64_t worstNode_ = -1;
};

}  // namespace Haptos
