// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_UnitTestHarness.hpp>
#include <random>

#include "Haptos_LawLinearization.hpp"

namespace {

using namespace Haptos;

PairLaw makePair(FrictionLaw law, double F1, double F2) { return {0, {1, 2}, {F1, F2}, 0.7, law, false}; }

std::vector<PairLaw> variedPairs() {
  return {makePair(FrictionLaw::Coulomb, 0.3, 0.3),  makePair(FrictionLaw::Coulomb, 0.5, 5e-4), makePair(FrictionLaw::Coulomb, 0.4, 0.0),
          makePair(FrictionLaw::Tresca, 0.3, 0.1), makePair(FrictionLaw::Coulomb, 2.0, 1.0)};
}

Eigen::VectorXd random(Eigen::Index n, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd x(n);
  for (double& value : x) value = normal(generator);
  return x;
}

LawLinearization linearize(const std::vector<PairLaw>& pairs, const Eigen::VectorXd& lambda, const Eigen::VectorXd& s, double r) {
  return linearizeLaw(pairs, lambda, s, Eigen::VectorXd::Constant(Eigen::Index(pairs.size()), r));
}

// J = A V + B S is the derivative of phi along (V, S), wherever phi is smooth.
TEUCHOS_UNIT_TEST(LawLinearization, MultiplyIsTheDerivativeOfTheResidual) {
  const auto pairs = variedPairs();
  const Eigen::Index n = 3 * Eigen::Index(pairs.size());
  int stick = 0, slip = 0, open = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const Eigen::VectorXd lambda = 2 * random(n, 10 * seed), s = random(n, 10 * seed + 1);
    const Eigen::VectorXd dLambda = random(n, 10 * seed + 2), dS = random(n, 10 * seed + 3);
    const double h = 1e-7;
    const Eigen::VectorXd r = Eigen::VectorXd::LinSpaced(Eigen::Index(pairs.size()), 0.3, 1.5);
    const auto law = linearizeLaw(pairs, lambda, s, r);
    const auto plus = linearizeLaw(pairs, lambda + h * dLambda, s + h * dS, r);
    const auto minus = linearizeLaw(pairs, lambda - h * dLambda, s - h * dS, r);
    const Eigen::VectorXd difference = (plus.phi - minus.phi) / (2 * h), J = law.multiply(dLambda, dS);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const Eigen::Index at = 3 * Eigen::Index(i);
      const bool smooth = plus.closed[i] == minus.closed[i] && (plus.dP[i] - minus.dP[i]).norm() < 1e-3;
      if (!smooth) continue;
      TEST_COMPARE((difference - J).segment<3>(at).norm(), <=, 1e-5 * (1 + J.segment<3>(at).norm()));
      const bool sticks = (law.dP[i] - Eigen::Matrix3d::Identity()).norm() < 1e-12;
      ++(!law.closed[i] ? open : sticks ? stick : slip);
    }
  }
  TEST_COMPARE(stick, >, 5);
  TEST_COMPARE(slip, >, 20);
  TEST_COMPARE(open, >, 20);
}

TEUCHOS_UNIT_TEST(LawLinearization, ResidualVanishesExactlyAtTheLaw) {
  const auto pairs = std::vector<PairLaw>{makePair(FrictionLaw::Coulomb, 0.3, 0.15)};
  // sliding at 45 degrees: lambda_T = g F^2 t / || F t ||
  Eigen::Vector3d lambda(1.0, 0.2683281572999748, 0.0670820393249937), s(0.0, 0.4, 0.4);
  TEST_COMPARE(linearize(pairs, lambda, s, 0.3).phi.norm(), <=, 1e-14);
  lambda = {1.0, 0.1, 0.05};  // sticking
  TEST_COMPARE(linearize(pairs, lambda, Eigen::Vector3d::Zero(), 0.3).phi.norm(), <=, 1e-15);
  lambda = {1.0, 0.2121, 0.1061};  // another law's traction: not ours
  TEST_COMPARE(linearize(pairs, lambda, s, 0.3).phi.norm(), >=, 1e-2);
  lambda.setZero();  // open
  TEST_COMPARE(linearize(pairs, lambda, Eigen::Vector3d(-0.1, 5, 5), 0.3).phi.norm(), <=, 0.0);
}

TEUCHOS_UNIT_TEST(TangentialModes, StickTakesThePreconditionerAndSlipHoldsOneDirection) {
  const auto stick = TangentialModes::of(Eigen::Matrix3d::Identity(), 1.0, 4.0);
  TEST_FLOATING_EQUALITY(stick.theta[0], 1.0, 1e-12);
  TEST_FLOATING_EQUALITY(stick.theta[1], 1.0, 1e-12);
  const auto pair = makePair(FrictionLaw::Coulomb, 0.3, 0.15);
  const auto law = linearize({pair}, Eigen::Vector3d(1.0, 2.0, 1.0), Eigen::Vector3d::Zero(), 1.0);
  const auto slip = TangentialModes::of(law.dP[0], 1.0, 4.0);
  TEST_EQUALITY(slip.isHeld(0), true);
  TEST_EQUALITY(slip.isHeld(1), false);
  TEST_COMPARE(slip.theta[1], <, 1.0);
  TEST_COMPARE(slip.theta[1], >, 0.0);
  TEST_COMPARE((slip.E * slip.sigma.asDiagonal() * slip.E.transpose() - law.dP[0].bottomRightCorner<2, 2>()).norm(), <=, 1e-14);
}

}  // namespace
