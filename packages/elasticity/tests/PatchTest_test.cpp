// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <map>

#include "ElasticityFixtures.hpp"
#include "Haptos_NodalLoads.hpp"
#include "Haptos_ReferenceElement.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Fixtures;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

struct Patch {
  std::string name;
  Solid solid;
};

// Every topology by itself and two mixed meshes, inner nodes moved by a quarter of the mesh width.
std::vector<Patch> distortedPatches(std::array<int, 3> n) {
  std::vector<Patch> patches;
  for (const Topology topology : allTopologies()) patches.push_back({topologyName(topology), makeSolid(topology, n, 0.25)});
  patches.push_back({"mixed linear", mixedSolid(n[0], 0.25, ElementOrder::Linear)});
  patches.push_back({"mixed quadratic", mixedSolid(n[0], 0.25, ElementOrder::Quadratic)});
  return patches;
}

// The elements of a distorted patch have different volumes: the patch tests something.
bool isDistorted(const Solid& solid) {
  const auto& group = solid.groups[0];
  double smallest = 1.0, largest = 0.0;
  for (int e = 0; e < group.numElements(); ++e) {
    double volume = 0;
    withShape(group.topology, [&](auto shape) { volume = elementGradients<decltype(shape)>(solid.coordinates, group, e).volumes.sum(); });
    smallest = std::min(smallest, volume);
    largest = std::max(largest, volume);
  }
  return largest > 1.2 * smallest;
}

// u at inner nodes from u at all others and the load f.
VectorXd solveInside(const Solid& solid, const VectorXd& onSurface, const VectorXd& f, Formulation formulation) {
  const auto k = assembleStiffness(solid.coordinates, solid.groups, steel(), formulation);
  std::vector<int> free;
  for (int i = 0; i < k.rows(); ++i)
    if (solid.interior[std::size_t(i / 3)]) free.push_back(i);
  return solveFree(k, free, f, onSurface);
}

using Field = std::function<Vector3d(const Vector3d&)>;

VectorXd nodalValues(const Solid& solid, const Field& field) {
  VectorXd u(3 * Eigen::Index(solid.coordinates.size()));
  for (std::size_t i = 0; i < solid.coordinates.size(); ++i)
    u.segment<3>(3 * Eigen::Index(i)) = field(Vector3d(solid.coordinates[i].data()));
  return u;
}

VectorXd bodyLoad(const Solid& solid, const Field& force) {
  VectorXd f = VectorXd::Zero(3 * Eigen::Index(solid.coordinates.size()));
  for (const auto& group : solid.groups)
    addBodyForce(solid.coordinates, group,
                 [&](double x, double y, double z) {
                   const Vector3d b = force(Vector3d(x, y, z));
                   return std::array<double, 3>{b[0], b[1], b[2]};
                 },
                 f);
  return f;
}

TEUCHOS_UNIT_TEST(PatchTest, LinearDisplacementLeavesInnerNodesInEquilibrium) {
  for (const auto& [name, solid] : distortedPatches({3, 3, 3}))
    for (const auto formulation : {Formulation::Standard, Formulation::BBar}) {
      TEST_ASSERT(isDistorted(solid));
      const auto k = assembleStiffness(solid.coordinates, solid.groups, steel(), formulation);
      const VectorXd u = linearField(solid.coordinates, someGradient(), {0.1, -0.2, 0.3});
      const VectorXd force = k * u;
      double inner = 0.0;
      int numInner = 0;
      for (std::size_t i = 0; i < solid.interior.size(); ++i)
        if (solid.interior[i]) inner = std::max(inner, force.segment<3>(3 * Eigen::Index(i)).norm()), ++numInner;
      TEST_COMPARE(numInner, >=, 8);
      TEST_ASSERT(force.norm() > 1.0);  // the surface is loaded
      TEST_ASSERT(inner < 1e-12 * k.norm() * u.cwiseAbs().maxCoeff());
      TEST_ASSERT(inner < 1e-10 * force.norm());
    }
}

TEUCHOS_UNIT_TEST(PatchTest, LinearDisplacementIsReproduced) {
  for (const auto& [name, solid] : distortedPatches({3, 3, 3})) {
    const VectorXd exact = linearField(solid.coordinates, someGradient(), {0.1, -0.2, 0.3});
    const VectorXd u = solveInside(solid, exact, VectorXd::Zero(exact.size()), Formulation::Standard);
    out << name << ": " << (u - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff() << "\n";
    TEST_COMPARE((u - exact).cwiseAbs().maxCoeff(), <, 1e-13 * exact.cwiseAbs().maxCoeff());
  }
}

// On affine elements the quadratic types have every quadratic field; its stress is balanced by a uniform body force.
TEUCHOS_UNIT_TEST(PatchTest, QuadraticDisplacementIsReproduced) {
  const auto moduli = elasticModuli(steel()[0]);
  Matrix3d a[3];
  a[0] << 0.5, 0.2, -0.3, 0.2, -0.8, 0.6, -0.3, 0.6, 0.1;
  a[1] << -0.4, 0.7, 0.1, 0.7, 0.3, 0.2, 0.1, 0.2, 0.9;
  a[2] << 0.6, -0.1, 0.4, -0.1, 0.5, -0.7, 0.4, -0.7, -0.2;
  const Field exact = [&](const Vector3d& x) { return Vector3d(x.dot(a[0] * x), x.dot(a[1] * x), x.dot(a[2] * x)); };
  // -div sigma = -(lambda + shear) grad div u - shear laplace u
  Vector3d force;
  for (int i = 0; i < 3; ++i)
    force[i] = -(moduli.lambda + moduli.shear) * 2 * (a[0](0, i) + a[1](1, i) + a[2](2, i)) - moduli.shear * 2 * a[i].trace();
  const Transform shear = [](std::array<double, 3> x) { return std::array<double, 3>{1.1 * x[0] + 0.3 * x[1], x[1] - 0.2 * x[2], 0.9 * x[2]}; };
  std::vector<Patch> patches{{"mixed quadratic", mixedSolid(2, 0.0, ElementOrder::Quadratic)}};
  for (const Topology topology : allTopologies())
    if (elementShape(topology).hasMidNodes()) patches.push_back({topologyName(topology), makeSolid(topology, {2, 2, 2}, 0.0, shear)});
  patches.push_back({"TETRA10, distorted", makeSolid(Topology::Tet10, {2, 2, 2}, 0.25)});
  for (const auto& [name, solid] : patches) {
    const VectorXd wanted = nodalValues(solid, exact);
    const VectorXd u = solveInside(solid, wanted, bodyLoad(solid, [&](const Vector3d&) { return force; }), Formulation::Standard);
    out << name << ": " << (u - wanted).cwiseAbs().maxCoeff() / wanted.cwiseAbs().maxCoeff() << "\n";
    TEST_COMPARE((u - wanted).cwiseAbs().maxCoeff(), <, 1e-12 * wanted.cwiseAbs().maxCoeff());
  }
}

// || u_h - u || in L2, by the rule for loads.
double distance(const Solid& solid, const VectorXd& u, const Field& exact) {
  double sum = 0;
  for (const auto& group : solid.groups) {
    const auto& rule = bodyLoadRule(group.topology);
    for (int e = 0; e < group.numElements(); ++e)
      for (int p = 0; p < rule.numPoints(); ++p) {
        Vector3d x = Vector3d::Zero(), value = Vector3d::Zero();
        Matrix3d j = Matrix3d::Zero();
        for (int n = 0; n < rule.numNodes(); ++n) {
          const int node = group.nodes(e)[n];
          const Vector3d at(solid.coordinates[std::size_t(node)].data());
          x += rule.values(n, p) * at;
          value += rule.values(n, p) * u.segment<3>(3 * node);
          j += at * rule.gradients.block<3, 1>(3 * n, p).transpose();
        }
        sum += rule.weights(p) * j.determinant() * (value - exact(x)).squaredNorm();
      }
  }
  return std::sqrt(sum);
}

// u = sin(x + 2 y) (1, 0, 0) + cos(2 z - x) (0, 1, 1) on a bent cube: orders at least 1.8 (2) and 2.7 (3).
TEUCHOS_UNIT_TEST(PatchTest, ErrorFallsWithTheOrderOfTheElements) {
  const auto moduli = elasticModuli(steel()[0]);
  const Field exact = [](const Vector3d& x) { return Vector3d(std::sin(x[0] + 2 * x[1]), std::cos(2 * x[2] - x[0]), std::cos(2 * x[2] - x[0])); };
  const Field force = [&](const Vector3d& x) {
    const double s = std::sin(x[0] + 2 * x[1]), c = std::cos(2 * x[2] - x[0]);
    // div u = cos(x + 2 y) - 2 sin(2 z - x);  its gradient, and the Laplacian of u
    const Vector3d gradDiv(-s + 2 * c, -2 * s, -4 * c), laplace(-5 * s, -5 * c, -5 * c);
    return Vector3d(-(moduli.lambda + moduli.shear) * gradDiv - moduli.shear * laplace);
  };
  const Transform bend = [](std::array<double, 3> x) { return std::array<double, 3>{x[0] + 0.2 * x[1] * x[1], x[1] - 0.1 * x[0] * x[2], x[2] + 0.15 * x[0] * x[1]}; };
  for (const Topology topology : allTopologies()) {
    std::array<double, 2> errors{};
    for (std::size_t level = 0; level < 2; ++level) {
      const int n = level == 0 ? 2 : 4;
      const Solid solid = makeSolid(topology, {n, n, n}, 0.0, bend);
      const VectorXd u = solveInside(solid, nodalValues(solid, exact), bodyLoad(solid, force), Formulation::Standard);
      errors[level] = distance(solid, u, exact);
    }
    const double order = std::log2(errors[0] / errors[1]);
    out << topologyName(topology) << ": " << errors[0] << ", " << errors[1] << ", order " << order << "\n";
    TEST_COMPARE(order, >, elementShape(topology).hasMidNodes() ? 2.7 : 1.8);
  }
}

TEUCHOS_UNIT_TEST(PatchTest, StressOfLinearDisplacementIsExact) {
  const Matrix3d H = someGradient();
  const auto moduli = elasticModuli(steel()[0]);
  const Matrix3d sigma = moduli.shear * (H + H.transpose()) + moduli.lambda * H.trace() * Matrix3d::Identity();
  const Stress expected{sigma(0, 0), sigma(1, 1), sigma(2, 2), sigma(0, 1), sigma(1, 2), sigma(2, 0)};
  for (const auto& [name, solid] : distortedPatches({3, 3, 3}))
    for (const auto& group : solid.groups) {
      const auto stresses = elementStresses(solid.coordinates, group, steel()[0], linearField(solid.coordinates, H));
      TEST_EQUALITY(int(stresses.size()), group.numElements());
      for (const auto& stress : stresses)
        for (std::size_t c = 0; c < 6; ++c) TEST_FLOATING_EQUALITY(stress[c], expected[c], 1e-12);
    }
}

TEUCHOS_UNIT_TEST(PatchTest, VonMisesOfKnownStates) {
  TEST_FLOATING_EQUALITY(vonMises({7, 0, 0, 0, 0, 0}), 7.0, 1e-15);                 // uniaxial
  TEST_ASSERT(vonMises({5, 5, 5, 0, 0, 0}) == 0.0);                                 // hydrostatic
  TEST_FLOATING_EQUALITY(vonMises({0, 0, 0, 0, 2, 0}), 2 * std::sqrt(3.0), 1e-15);  // shear
}

}  // namespace
