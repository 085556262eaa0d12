// SPDX-License-Identifier: BSD-3-Clause
// Elements near incompressibility: a thick cylinder under internal pressure (Lame), a clamped block that is sheared (Cook), and a plate that bends.
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>

#include "DenseAlgebra.hpp"
#include "ElasticityFixtures.hpp"
#include "Haptos_NodalLoads.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Fixtures;
using Eigen::VectorXd;

constexpr double kPi = 3.14159265358979323846;

// u where isHeld(x, component) does not hold it at zero.
template <class IsHeld>
VectorXd solve(const Solid& solid, const Mesh& straight, const std::vector<IsotropicMaterial>& materials, Formulation formulation, const VectorXd& f,
               const IsHeld& isHeld) {
  const auto k = assembleStiffness(solid.coordinates, solid.groups, materials, formulation);
  std::vector<int> free;
  for (int i = 0; i < k.rows(); ++i)
    if (!isHeld(straight.coordinates[std::size_t(i / 3)], i % 3)) free.push_back(i);
  return solveFree(k, free, f, VectorXd::Zero(k.rows()));
}

// Sides whose nodes all fulfil a condition.
template <class Condition>
std::vector<GroupSide> sidesWhere(const ElementGroup& group, const Mesh& straight, const Condition& condition) {
  std::vector<GroupSide> sides;
  for (int e = 0; e < group.numElements(); ++e)
    for (int s = 0; s < sidesPerElement(group.topology); ++s) {
      const SideNodes& side = sideNodes(group.topology, s);
      if (std::all_of(side.begin(), side.end(), [&](int i) { return condition(straight.coordinates[std::size_t(group.nodes(e)[i])]); }))
        sides.push_back({e, s});
    }
  return sides;
}

struct CylinderErrors {
  double displacement;  // of u_r, the largest over all nodes, relative to the largest u_r
  double pressure;      // of the mean stress of elements, rms, relative to the internal pressure
};

// Radii 1 and 2, plane strain, internal pressure 1, E = 1:
// u_r = (1 + nu) a^2 / (b^2 - a^2) ((1 - 2 nu) r + b^2 / r),  sigma_rr + sigma_tt = 2 a^2 / (b^2 - a^2),  sigma_zz = nu times that
CylinderErrors cylinder(Topology topology, int n, double nu, Formulation formulation) {
  const Mesh straight = withElements(cubeOfHexahedra({n, 2 * n, 1}), topology);
  const Transform bend = [](std::array<double, 3> x) {
    const double r = 1 + x[0], angle = 0.5 * kPi * x[1];
    return std::array<double, 3>{r * std::cos(angle), r * std::sin(angle), 0.5 * x[2]};
  };
  const Solid solid = solidOf(straight, bend);
  const std::vector<IsotropicMaterial> materials{{"rubber", 1.0, nu}};
  VectorXd f = VectorXd::Zero(3 * Eigen::Index(solid.coordinates.size()));
  const auto isInner = [](const std::array<double, 3>& x) { return x[0] == 0; };
  for (const auto& group : solid.groups)
    addPressure(solid.coordinates, group, sidesWhere(group, straight, isInner), [](double, double, double) { return 1.0; }, f);
  const VectorXd u = solve(solid, straight, materials, formulation, f, [](const std::array<double, 3>& x, int c) {
    return (c == 1 && x[1] == 0) || (c == 0 && x[1] == 1) || c == 2;
  });
  const auto exact = [&](double r) { return (1 + nu) / 3 * ((1 - 2 * nu) * r + 4 / r); };
  CylinderErrors errors{0, 0};
  for (std::size_t i = 0; i < solid.coordinates.size(); ++i) {
    const auto& x = solid.coordinates[i];
    const double r = std::hypot(x[0], x[1]), radial = (x[0] * u[3 * Eigen::Index(i)] + x[1] * u[3 * Eigen::Index(i) + 1]) / r;
    errors.displacement = std::max(errors.displacement, std::abs(radial - exact(r)) / exact(1));
  }
  const double mean = 2.0 / 3 * (1 + nu) / 3;
  double sum = 0;
  const auto stresses = elementStresses(solid.coordinates, solid.groups[0], materials[0], u);
  for (const auto& s : stresses) sum += std::pow((s[0] + s[1] + s[2]) / 3 - mean, 2);
  errors.pressure = std::sqrt(sum / double(stresses.size()));
  return errors;
}

// Cook's membrane of thickness 1 in plane strain: 48 wide, 44 high at the clamped end, 16 at the loaded one; shear 1/16 per area.
double cook(Topology topology, int n, double nu, Formulation formulation) {
  const Mesh straight = withElements(cubeOfHexahedra({n, n, 1}), topology);
  const Transform taper = [](std::array<double, 3> x) {
    return std::array<double, 3>{48 * x[0], 44 * x[0] + x[1] * (44 - 28 * x[0]), 2 * x[2]};
  };
  const Solid solid = solidOf(straight, taper);
  VectorXd f = VectorXd::Zero(3 * Eigen::Index(solid.coordinates.size()));
  for (const auto& group : solid.groups)
    addTraction(solid.coordinates, group, sidesWhere(group, straight, [](const std::array<double, 3>& x) { return x[0] == 1; }),
                [](double, double, double) { return std::array<double, 3>{0, 1.0 / 16, 0}; }, f);
  const VectorXd u = solve(solid, straight, {{"rubber", 1.0, nu}}, formulation, f,
                           [](const std::array<double, 3>& x, int c) { return x[0] == 0 || c == 2; });
  return f.dot(u) / 2;  // the work of the load, thickness 2: the mean displacement of the end
}

bool isFreed(Topology topology) { return topology == Topology::Hex8 || elementShape(topology).hasMidNodes(); }

// B-bar at nu = .4999 is as good as plain elements are at .3; plain ones lock there.
TEUCHOS_UNIT_TEST(Incompressible, ThickCylinder) {
  constexpr double nu = 0.4999;
  for (const Topology topology : allTopologies()) {
    const int n = elementShape(topology).hasMidNodes() ? 4 : 8;
    const auto easy = cylinder(topology, n, 0.3, Formulation::Standard), locked = cylinder(topology, n, nu, Formulation::Standard),
               freed = cylinder(topology, n, nu, Formulation::BBar);
    out << topologyName(topology) << ": u " << easy.displacement << " at nu = .3; " << locked.displacement << ", B-bar " << freed.displacement
        << "; mean stress " << easy.pressure << "; " << locked.pressure << ", B-bar " << freed.pressure << "\n";
    if (!isFreed(topology)) {
      TEST_COMPARE(freed.displacement, >, 9 * easy.displacement);  // TET4, WEDGE6, PYRAMID5: the summary says that they lock
      continue;
    }
    TEST_COMPARE(locked.displacement, >, 8 * freed.displacement);
    TEST_COMPARE(freed.displacement, <, 2.1 * easy.displacement);
    TEST_COMPARE(freed.pressure, <, 10 * easy.pressure);
  }
}

// Displacement of the end; 18.5 by HEX27 with a linear pressure, 18.2 and 18.4 on coarser meshes.
TEUCHOS_UNIT_TEST(Incompressible, CooksMembrane) {
  constexpr double nu = 0.4999;
  for (const Topology topology : allTopologies()) {
    if (!isFreed(topology)) continue;
    const int n = elementShape(topology).hasMidNodes() ? 8 : 16;
    const double locked = cook(topology, n / 2, nu, Formulation::Standard), freed = cook(topology, n, nu, Formulation::BBar);
    out << topologyName(topology) << ": " << locked << ", B-bar " << freed << "\n";
    TEST_COMPARE(std::abs(freed - 18.5), <, 0.02 * 18.5);
    TEST_COMPARE(locked, <, 17.0);
  }
}

// A clamped plate 4 x 2 x .3, one brick thick, with a load on top: bending changes volumes above and below its middle.
double plate(Topology topology, int n, double nu) {
  const Mesh straight = withElements(cubeOfHexahedra({2 * n, n, 1}), topology);
  const Solid solid = solidOf(straight, [](std::array<double, 3> x) { return std::array<double, 3>{4 * x[0], 2 * x[1], 0.3 * x[2]}; });
  VectorXd f = VectorXd::Zero(3 * Eigen::Index(solid.coordinates.size()));
  for (const auto& group : solid.groups)
    addTraction(solid.coordinates, group, sidesWhere(group, straight, [](const std::array<double, 3>& x) { return x[2] == 1; }),
                [](double, double, double) { return std::array<double, 3>{0, 0, 1}; }, f);
  const auto isHeld = [](const std::array<double, 3>& x, int) { return x[0] == 0; };
  return f.dot(solve(solid, straight, {{"rubber", 1.0, nu}}, Formulation::BBar, f, isHeld));
}

// With nothing but one pressure an element layers of WEDGE15 bend without energy, those of TETRA10 and PYRAMID13 a third too easily, at any nu.
TEUCHOS_UNIT_TEST(Incompressible, LayersBend) {
  for (const double nu : {0.3, 0.4999}) {
    const double wanted = plate(Topology::Hex27, 12, nu);
    for (const Topology topology : allTopologies()) {
      if (!elementShape(topology).hasMidNodes()) continue;
      const double coarse = plate(topology, 5, nu) / wanted - 1, fine = plate(topology, 10, nu) / wanted - 1;
      out << topologyName(topology) << ", nu " << nu << ": " << coarse << ", " << fine << "\n";
      TEST_COMPARE(std::abs(coarse), <, 0.08);
      TEST_COMPARE(std::abs(fine), <, nu < 0.4 ? 0.015 : 0.045);
    }
  }
}

// One cell and a layer, of straight elements, have six motions without energy: the others that have no deviatoric strain cost some.
TEUCHOS_UNIT_TEST(Incompressible, LayersHaveSixZeros) {
  for (const Topology topology : allTopologies())
    for (const int n : {1, 2}) {
      const Solid solid = solidOf(withElements(cubeOfHexahedra({n, n, 1}), topology), [](std::array<double, 3> x) { return x; });
      const VectorXd eigenvalues = Testing::symmetricEigenvalues(
          Eigen::MatrixXd(assembleStiffness(solid.coordinates, solid.groups, {{"rubber", 1.0, 0.4999}}, Formulation::BBar)));
      TEST_COMPARE(eigenvalues.head(6).cwiseAbs().maxCoeff(), <, 1e-12 * eigenvalues.tail<1>()[0]);
      out << topologyName(topology) << ", " << n << ": " << eigenvalues[6] << "\n";
      TEST_COMPARE(eigenvalues[6], >, 1e-3);  // E = 1
    }
}

}  // namespace
