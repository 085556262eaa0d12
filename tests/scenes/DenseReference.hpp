// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "AssembledBodies.hpp"
#include "ReferenceSolvers.hpp"

namespace Haptos::Scenes {

/// \brief One node and what it may touch, as the contract defines it.
struct ReferencePair {
  std::int64_t secondary;
  std::int64_t primary;  ///< -1: rigid plane
  Eigen::Vector3d n, t1, t2;
  double gap;
  ReferenceLaw law;
};

/// \brief A small contact problem in plain terms; nothing of it is decomposed.
struct ReferenceProblem {
  Mesh mesh;
  std::vector<IsotropicMaterial> materials;
  std::vector<int> materialOfBlock;
  Formulation formulation = Formulation::Standard;
  std::vector<HeldComponent> held;
  Eigen::VectorXd loads;  ///< [3 nodes]
  std::vector<ReferencePair> pairs;
};

/// \brief Solution with the measures by which it was accepted.
struct ReferenceSolution {
  bool converged = false;
  std::string how;          ///< which way led there
  double kkt = 0;           ///< largest relative error of the contact law and of the balance
  double equilibrium = 0;   ///< || f - K u - B^T lambda || / ext
  double roundOff = 0;      ///< the equilibrium that double precision allows
  Eigen::VectorXd u;        ///< [3 nodes]
  Eigen::MatrixX3d lambda;  ///< [pairs] N, T1, T2
  Eigen::MatrixX3d jump;    ///< [pairs] N u - gap, T u
  double uRef = 0, lRef = 0;
  std::array<int, 3> states{0, 0, 0};  ///< stick, slip, open
  int newtonSteps = 0;
  double amplification = 0;  ///< change of lambda / l_ref for a change of the jumps by u_ref: what kkt leaves open

  /// \brief Force on the secondary node of a pair.
  Eigen::Vector3d force(const ReferencePair& pair, Eigen::Index i) const {
    return -(lambda(i, 0) * pair.n + lambda(i, 1) * pair.t1 + lambda(i, 2) * pair.t2);
  }
};

/// \brief Independent, slow and plain: whole bodies, dense compliance on the contact nodes, Newton's method.
///
/// A solution counts only when u, computed anew from lambda, obeys balance and contact law to 1e-11 and no
/// displacement has run away (some formulations report a tiny residual on huge jumps).  Where Newton's method
/// fails at once, the friction coefficients are approached in steps; after that, successive Tresca steps.
class DenseReference {
 public:
  explicit DenseReference(ReferenceProblem problem);

  ReferenceSolution solve();
  const ReferenceProblem& problem() const { return problem_; }
  const CondensedContact& contact() const { return contact_; }
  bool floats() const { return contact_.e.size() > 0; }

 private:
  using Laws = std::vector<ReferenceLaw>;
  void condense();
  Laws lawsWith(double factor, double floor) const;
  ReferenceSolution tryPath(const std::string& name, const std::vector<Laws>& path, ContactState state);
  ReferenceSolution trySuccessiveTresca(ContactState state);
  ReferenceSolution polish(const std::string& name, ContactState state, int steps);
  ReferenceSolution check(const ContactState& state, Eigen::VectorXd& trueJump) const;
  void measureLaw(ReferenceSolution& solution) const;
  double largestAllowedDisplacement() const;

  ReferenceProblem problem_;
  AssembledBodies bodies_;
  Eigen::SparseMatrix<double> B_;  ///< [3 pairs x free]
  Eigen::VectorXd f_, d_;          ///< reduced load; B u_held - gap
  CondensedContact contact_;
  Laws laws_;
};

}  // namespace Haptos::Scenes
