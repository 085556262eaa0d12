// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_FoundationStart.hpp"

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {
namespace {

constexpr double kUnfelt = 1e-12;  // rank: a motion that nothing resists today stays where it is

struct State {
  Eigen::VectorXd a, forces, h;  // h = H^T P - load, in orthonormal motions
  Eigen::MatrixXd J;
};

class Foundation {
 public:
  Foundation(const std::vector<PairLaw>& pairs, const Eigen::VectorXd& x, const Eigen::VectorXd& r, const Eigen::MatrixXd& H,
             const Eigen::VectorXd& load, const DualVectors& vectors)
      : pairs_(pairs), x_(x), r_(r), rH_(H), H_(H), load_(load), vectors_(vectors) {
    for (Eigen::Index i = 0; i < r.size(); ++i) rH_.middleRows<3>(3 * i) *= r[i];
    Eigen::Vector2d sums(r.sum(), double(r.size()));
    vectors.sum(sums);
    meanR_ = sums[0] / std::max(1.0, sums[1]);
  }

  // P(x + r H a), h = H^T P - load and dh/da = H^T P' r H; P(y) = y - phi of the law with r = 1, s = 0
  State evaluate(const Eigen::VectorXd& a) const {
    const Eigen::VectorXd x = x_ + rH_ * a;
    const auto law = linearizeLaw(pairs_, x, Eigen::VectorXd::Zero(x.size()), Eigen::VectorXd::Ones(r_.size()));
    State state{a, x - law.phi, {}, {}};
    Eigen::MatrixXd PH(H_.rows(), H_.cols());
    for (std::size_t i = 0; i < law.dP.size(); ++i)
      PH.middleRows<3>(3 * Eigen::Index(i)) = law.dP[i] * rH_.middleRows<3>(3 * Eigen::Index(i));
    Eigen::MatrixXd sums(H_.cols(), H_.cols() + 1);
    sums << H_.transpose() * PH, H_.transpose() * state.forces;
    vectors_.sum(sums);
    state.J = sums.leftCols(H_.cols());
    state.h = sums.rightCols(1) - load_;
    return state;
  }

  // Everything closed and sticking, P = 1: H^T r H a = load - H^T x.
  Eigen::VectorXd stuck() const {
    Eigen::MatrixXd sums(H_.cols(), H_.cols() + 1);
    sums << H_.transpose() * rH_, H_.transpose() * x_;
    vectors_.sum(sums);
    return solveLeastSquares(sums.leftCols(H_.cols()), load_ - sums.rightCols(1));
  }

  // Newton, damped by springs to the ground until something descends: a body whose pairs all slip or are open has J singular.
  bool step(State& state, const SubspaceNewtonOptions::Foundation& options) const {
    for (double mu : options.dampings) {
      Eigen::MatrixXd J = state.J;
      J.diagonal().array() += mu * meanR_;
      const Eigen::VectorXd da = -solveLeastSquares(J, state.h, kUnfelt);
      if (!da.allFinite()) continue;
      for (double t = 1; t > options.shortestStep; t /= 2) {
        State next = evaluate(state.a + t * da);
        if (next.h.norm() < (1 - options.armijo * t) * state.h.norm()) {
          state = std::move(next);
          return true;
        }
      }
    }
    return false;
  }

 private:
  const std::vector<PairLaw>& pairs_;
  const Eigen::VectorXd& x_;
  const Eigen::VectorXd& r_;
  double meanR_;
  Eigen::MatrixXd rH_;
  const Eigen::MatrixXd& H_;
  const Eigen::VectorXd& load_;
  const DualVectors& vectors_;
};

}  // namespace

FoundationState solveFoundation(const std::vector<PairLaw>& pairs, const Eigen::VectorXd& x, const Eigen::VectorXd& r,
                                const GluingBalance& balance, const SubspaceNewtonOptions::Foundation& options) {
  const DualVectors& vectors = balance.vectors();
  // In motions that are orthonormal on the contact surface, H := H S with (H S)^T H S = 1, the equations are well scaled: lengths and
  // angles are no longer mixed.  Motions that the surface does not feel get S = 0.
  Eigen::MatrixXd HH = balance.H().transpose() * balance.H();
  vectors.sum(HH);
  const SymmetricEigen eigen(HH);
  Eigen::VectorXd scale = eigen.values;
  for (double& value : scale) value = value > 1e-14 * eigen.values.maxCoeff() ? 1 / std::sqrt(value) : 0.0;
  const Eigen::MatrixXd S = eigen.vectors * scale.asDiagonal();
  const Eigen::MatrixXd H = balance.H() * S;
  const Eigen::VectorXd load = S.transpose() * balance.load();
  const Foundation foundation(pairs, x, r, H, load, vectors);
  const double loadNorm = load.norm();
  State state = foundation.evaluate(foundation.stuck());
  for (int i = 0; i < options.steps && state.h.norm() > options.tolerance * loadNorm; ++i)
    if (!foundation.step(state, options)) break;
  return {S * state.a, state.forces, loadNorm > 0 ? state.h.norm() / loadNorm : state.h.norm()};
}

}  // namespace Haptos
