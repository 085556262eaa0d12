// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "Haptos_ContactLaw.hpp"
#include "Haptos_ContactMatrix.hpp"

namespace Haptos {

/// \brief Vectors l and y of the second-order cone { x : x_0 >= | (x_1, x_2) | } on the way to l . y = 0, by a primal-dual interior
/// point method.
///
/// With the scaling matrix W of Nesterov and Todd, W y = l [alizadeh-goldfarb-2003], a step obeys  dl + W dy = rest.
struct ConePoint {
  Eigen::Vector3d l, y, dl, dy, rest;
  Eigen::Matrix3d W, root, inverseRoot;  ///< of W

  void scale();              ///< W at l, y
  void aim(double target);   ///< at l o y = target
  /// What the product dl o dy of the last step, which the linear equations leave out, adds to l o y is taken off.
  void correct();
  bool isInside() const;       ///< l and y, by their digits
  double longestStep() const;  ///< largest t <= 1 for which l + t dl and y + t dy stay inside, less a little
  Eigen::Vector2d coupling() const { return W.block<2, 1>(1, 0) / W(0, 0); }
  Eigen::Matrix2d tangentialW() const { return W.bottomRightCorner<2, 2>() - coupling() * W.block<1, 2>(0, 1); }  ///< where l_0 stays
  void advance(double t) { l += t * dl, y += t * dy; }
};

/// \brief What a step knows of |F s_T| in y_0: its value, which leaves K symmetric, or its derivative, too.
enum class SlipTerm { Value, Derivative };

/// \brief The law of one pair as cones: Coulomb's is  (lambda_N, F^-1 lambda_T) . (|F s_T| - s_N, - F s_T) = 0, both in the cone
/// [de-saxce-feng-1998]; Tresca's one for the normal and one for the tangential force, whose bound is given.
///
/// Components that the law holds at 0 (a coefficient 0, a pinned row) are no part of a cone.
class PairCones {
 public:
  /// \param force, length sizes of the start
  PairCones(const PairLaw& pair, double force, double length);

  double product() const;  ///< sum of l . y
  int count() const { return int(hasNormal_) + int(hasBall_); }

  /// \brief The pair's part of Newton's equation (M + K) d sigma = b at these forces and jumps, aiming at l . y = 0.
  void linearize(const Eigen::Vector3d& lambda, const Eigen::Vector3d& s, SlipTerm slip);
  /// \brief b for another l . y, knowing the step to 0.
  void aim(double target);
  const Eigen::Matrix3d& K() const { return K_; }
  Eigen::Vector3d b() const;

  bool isInside() const;
  bool hasLawOf(const PairCones& other) const;  ///< and bound of friction

  void setStep(const Eigen::Vector3d& dSigma);
  double longestStep() const;
  void advance(double t);

 private:
  Eigen::Vector3d normalD() const { return hasBall_ ? Eigen::Vector3d(1, 0, 0) : D_; }
  void linearizeCoulomb(const Eigen::Vector3d& lambda, const Eigen::Vector3d& s);
  void linearizeBall(const Eigen::Vector3d& lambda, const Eigen::Vector3d& s);

  bool hasNormal_, hasBall_;
  Eigen::Vector3d D_, inverseD_;  // (1, F1, F2), 0 where a component is no part of a cone
  Eigen::Matrix3d jumpChange_;    // dy of the normal cone by d sigma
  Eigen::Vector3d missing_;       // D^-1 lambda - l
  Eigen::Vector3d jumpMissing_;   // what the jumps ask of y, less y
  ConePoint normal_, ball_;
  Eigen::Matrix3d K_;
  Eigen::Vector3d known_;         // the part of b that no aim changes
};

/// \brief The path of interior points of all pairs for  lambda + M sigma, s - sigma:  from no start at all, and where Newton's
/// method on the law finds no way.
///
/// Models of one run differ little: the stages of a path are kept, and the next one may begin at the last of them that is as good for it.
class ConePath {
 public:
  using Residual = std::function<double(const Eigen::VectorXd& sigma)>;  ///< of the law.  Collective.
  struct Start {
    const std::vector<PairLaw>& pairs;
    const ContactMatrix& M;
    const Eigen::VectorXd &lambda, &s;  ///< [3 pairs]
    SlipTerm slip;
  };
  explicit ConePath(const SubspaceNewtonOptions::Condensed& options) : options_(options) {}

  /// \brief The sigma of least residual on the way, which ends at `target`, or where it is not lowered any more.  Collective.
  Eigen::VectorXd follow(const Start& start, const Residual& residual, double target, bool fromStages = false);
  bool hasStages() const { return !stages_.empty(); }

 private:
  class Point;
  struct Stage {
    std::vector<PairCones> cones;
    Eigen::VectorXd s;
    double norm;  // the residual there
  };
  int lastStage(const Start& start, const Residual& residual) const;
  struct End {
    double target;  // of the residual
    int patience;   // steps in a row that creep
  };
  Eigen::VectorXd walk(Point point, Eigen::VectorXd sigma, const Start& start, const Residual& residual, const End& end);

  SubspaceNewtonOptions::Condensed options_;
  std::vector<Stage> stages_;
};

}  // namespace Haptos
