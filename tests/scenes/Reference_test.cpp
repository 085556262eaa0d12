// SPDX-License-Identifier: BSD-3-Clause
// The dense reference against what does not come from it.
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>
#include <random>
#include <set>

#include "Haptos_BoxMesh.hpp"
#include "Scenes.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Scenes;

double distance(const std::array<double, 2>& a, const std::array<double, 2>& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }

TEUCHOS_UNIT_TEST(Reference, NearestPointOnEllipseIsNearestAndFeasible) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-6, 0), direction(0, 2 * M_PI), far(-2, 3);
  int moved = 0;
  for (int i = 0; i < 2000; ++i) {
    const std::array<double, 2> a{std::pow(10, exponent(random)), 1.0};
    const double t = direction(random), size = std::pow(10, far(random));
    const std::array<double, 2> y{size * std::cos(t), size * std::sin(t)};
    double tau;
    const auto p = nearestOnEllipse(y, a, tau);
    moved += tau > 0;
    TEST_COMPARE(std::hypot(p[0] / a[0], p[1] / a[1]), <=, 1 + 1e-14);
    for (int k = 0; k < 64; ++k) {  // no boundary point is nearer
      const double angle = 2 * M_PI * k / 64;
      TEST_COMPARE(distance(y, p), <=, distance(y, {a[0] * std::cos(angle), a[1] * std::sin(angle)}) * (1 + 1e-14));
    }
    // y - p is normal to the boundary: (y1 - p1) p2 / a2^2 = (y2 - p2) p1 / a1^2
    if (tau > 0) {
      const double left = (y[0] - p[0]) * a[0] * a[0] * p[1], right = (y[1] - p[1]) * a[1] * a[1] * p[0];
      TEST_COMPARE(std::abs(left - right), <=, 1e-9 * (std::abs(left) + std::abs(right)) + 1e-15 * size);
    }
  }
  TEST_COMPARE(moved, >, 1000);
}

TEUCHOS_UNIT_TEST(Reference, LawDerivativeAgreesWithDifferences) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const ReferenceLaw laws[] = {{{0.3, 0.3}}, {{0.5, 0.01}}, {{0.4, 0.0}}, {{0.5, 0.2}, 0.7}};
  for (const ReferenceLaw& law : laws) {
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d x(normal(random), normal(random), normal(random));
      const auto P = projectOnLaw(law, x);
      const double h = 1e-7;
      for (int d = 0; d < 3; ++d) {
        const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(d);
        const Eigen::Vector3d up = projectOnLaw(law, x + e).point, down = projectOnLaw(law, x - e).point;
        if (projectOnLaw(law, x + e).derivative.isApprox(projectOnLaw(law, x - e).derivative, 1e-3))  // no kink between
          TEST_COMPARE(((up - down) / (2 * h) - P.derivative.col(d)).norm(), <=, 1e-5);
      }
    }
  }
}

// A cube pressed and sheared on a rigid plane; resultants of an independent computation.
struct SlippingCube {
  int n;
  std::array<double, 2> friction;
  Eigen::Vector3d resultant;
  int stick, slip;
};

ReferenceProblem cubeOnPlane(const SlippingCube& cube) {
  ReferenceProblem problem;
  BoxSpec spec;
  spec.blockName = "cube";
  spec.divisions = {cube.n, cube.n, cube.n};
  problem.mesh = makeBoxes({spec});
  problem.materials = {{"unit", 1.0, 0.3}};
  problem.materialOfBlock = {0};
  problem.loads = Eigen::VectorXd::Zero(3 * Eigen::Index(problem.mesh.numNodes()));
  const double move[3] = {4e-4, 4e-4, -1e-3};
  for (std::size_t i = 0; i < problem.mesh.numNodes(); ++i) {
    const auto& x = problem.mesh.coordinates[i];
    if (x[2] == 1.0)
      for (int d = 0; d < 3; ++d) problem.held.push_back({std::int64_t(i), d, move[d]});
    if (x[2] == 0.0)
      problem.pairs.push_back({std::int64_t(i), -1, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, 0.0, {cube.friction}});
  }
  return problem;
}

TEUCHOS_UNIT_TEST(Reference, PartialSlipOfACube) {
  const SlippingCube cubes[] = {{4, {0.3, 0.3}, {-1.09116274e-4, -1.09116274e-4, 1.07812329e-3}, 8, 17},
                                {4, {0.3, 0.15}, {-1.07334043e-4, -9.28951386e-5, 1.06474424e-3}, 3, 22},
                                {8, {0.3, 0.15}, {-1.02947571e-4, -9.02654912e-5, 1.05664891e-3}, 8, 73}};
  for (const auto& cube : cubes) {
    DenseReference dense(cubeOnPlane(cube));
    const auto solution = dense.solve();
    TEST_ASSERT(solution.converged);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < dense.problem().pairs.size(); ++i) sum += solution.force(dense.problem().pairs[i], Eigen::Index(i));
    TEST_COMPARE((sum - cube.resultant).norm(), <=, 2e-8 * cube.resultant.norm());
    TEST_EQUALITY(solution.states[0], cube.stick);
    TEST_EQUALITY(solution.states[1], cube.slip);
    out << solution.how << ", " << solution.newtonSteps << " Newton steps, kkt " << solution.kkt << "\n";
  }
}

TEUCHOS_UNIT_TEST(Reference, DoesNotCallARunawaySolved) {
  for (const char* name : {"floating-beyond-limit", "floating-frictionless-pushed", "floating-pulled-off"}) {
    Scene small = findScene(name);
    small.k = 1;
    const auto solution = DenseReference(makeReferenceProblem(small, Formulation::Standard)).solve();
    TEST_ASSERT(!solution.converged);
  }
}

TEUCHOS_UNIT_TEST(Reference, BBarFreesNearlyIncompressibleBodies) {
  const Scene& scene = findScene("nu-0.4999");
  const auto locked = DenseReference(makeReferenceProblem(scene, Formulation::Standard)).solve();
  const auto freed = DenseReference(makeReferenceProblem(scene, Formulation::BBar)).solve();
  TEST_ASSERT(locked.converged && freed.converged);
  TEST_COMPARE(freed.uRef, >, 1.5 * locked.uRef);
  TEST_COMPARE(freed.amplification, <, 0.1 * locked.amplification);
  out << "largest displacement " << locked.uRef << " -> " << freed.uRef << ", amplification " << locked.amplification << " -> "
      << freed.amplification << "\n";
}

TEUCHOS_UNIT_TEST(Reference, AdmmAndNewtonAgreeOnATrescaStep) {
  const DenseReference dense(makeReferenceProblem(findScene("base-small"), Formulation::Standard));
  std::vector<ReferenceLaw> laws;
  for (const auto& pair : dense.problem().pairs) {
    laws.push_back({pair.law.coefficients, 0.5});
    laws.back().normalPinned = dense.contact().C.diagonal()[3 * Eigen::Index(laws.size() - 1)] == 0;
    if (laws.back().normalPinned) laws.back().coefficients = {0, 0};
  }
  ContactState admm = tiedBodies(dense.contact()), newton = admm;
  TEST_COMPARE(solveTrescaByAdmm(dense.contact(), laws, 1e-13, 50000, admm), <=, 1e-13);
  TEST_COMPARE(solveBySemismoothNewton(dense.contact(), laws, 1.0, newton).residual, <=, 1e-13);
  TEST_COMPARE((admm.lambda - newton.lambda).norm(), <=, 1e-9 * newton.lambda.norm());
  TEST_COMPARE(newton.lambda.norm(), >, 0.0);
}

}  // namespace
