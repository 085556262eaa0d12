// SPDX-License-Identifier: BSD-3-Clause
// Friction that differs from place to place: a block on a floor whose coefficient grows along x, a sleeve on a shaft with
// other coefficients around the axis than along it.
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>

#include "Ring.hpp"
#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

// ---- a block, 2 x 1 x 1, pressed by p = 1 and drawn along x at the height h of its front face ----

constexpr double kA = 0.1, kB = 0.05, kHeight = 0.5, kWeight = 2.0;

Mesh blockOn(bool isFloorElastic) {
  BoxSpec block, floor;
  block.blockName = "block";
  block.upper = {2, 1, 1};
  block.divisions = {6, 2, 2};
  block.sideSetNames = {"", "", "south", "", "bottom", "top"};
  floor.blockName = "floor";
  floor.lower = {-1, -0.5, -1};
  floor.upper = {3, 1.5, 0};
  floor.divisions = {5, 3, 2};
  floor.sideSetNames = {"", "", "", "", "base", "ground"};
  Mesh mesh = isFloorElastic ? makeBoxes({block, floor}) : makeBoxes({block});
  NodeSet front{1, "front", {}};
  for (std::size_t i = 0; i < mesh.numNodes(); ++i)
    if (mesh.coordinates[i][0] == 2 && mesh.coordinates[i][2] == kHeight) front.nodes.push_back(std::int64_t(i));
  mesh.nodeSets.push_back(front);
  return mesh;
}

enum class Given { Expression, Field };

SimulationResult slideBlock(bool isFloorElastic, Given given) {
  const Friction friction{"Coulomb", {0, 0}};
  Mesh mesh = blockOn(isFloorElastic);
  NodalField field{"MU", {}};
  for (const auto& x : mesh.coordinates) field.values.push_back(kA + kB * x[0]);
  mesh.nodalFields = {{"OTHER", {}}, field};
  ScenarioBuilder scene(mesh);
  scene.material("block", 1e4, 0.3)
      .displacement({"front"}, "x", {0.5, 0, 0})
      .displacement({"south"}, "y", {0, 0, 0})
      .pressure({"top"}, 1.0)
      .decomposition("METIS", 4)
      .tolerance(1e-10);
  if (isFloorElastic)
    scene.material("floor", 3e4, 0.2).clamp({"base"}).contact("bottom", "ground", &friction).contactOption("Discretization", "Mortar")
        .contactOption("Sides", "As Given");
  else scene.rigidPlane("bottom", {0, 0, 0}, {0, 0, 1}, &friction);
  Teuchos::ParameterList list;
  const std::string first = given == Given::Field ? "MU" : "0.1 + 0.05*x";
  list.set("Coefficients", Teuchos::Array<std::string>(Teuchos::tuple<std::string>(first, "0")));
  return scene.frictionOptions(list).solve();
}

// ANALYTIC: T = sum (a + b x_i) lambda_i = a P + b sum x_i lambda_i, and the moments about y balance: sum x_i lambda_i = P x_c + h T, whatever
// the distribution of pressure; hence T = P (a + b x_c) / (1 - b h).  It is int mu p, p the contact pressure.
TEUCHOS_UNIT_TEST(FrictionFields, ACoefficientThatGrowsAlongTheFloor) {
  const double closed = kWeight * (kA + kB * 1.0) / (1 - kB * kHeight);
  for (const bool isFloorElastic : {false, true}) {
    const auto result = slideBlock(isFloorElastic, Given::Expression);
    TEST_ASSERT(result.solved);
    if (result.pairs.empty()) continue;  // not the root
    const auto sum = resultants(result);
    TEST_FLOATING_EQUALITY(sum.normal, kWeight, 1e-8);
    TEST_FLOATING_EQUALITY(-sum.tangential[0], closed, 1e-7);
    TEST_COMPARE(std::abs(closed - kWeight * (kA + kB)), >, 1e-3);  // pressure is not uniform: the moment counts
    double least = 1, most = 0;
    for (const auto& pair : result.pairs) {
      TEST_ASSERT(pair.status == ContactStatus::Slip);
      least = std::min(least, pair.coefficients[0]);
      most = std::max(most, pair.coefficients[0]);
    }
    TEST_FLOATING_EQUALITY(least, kA, 1e-14);
    TEST_FLOATING_EQUALITY(most, kA + 2 * kB, 1e-14);
    out << "T " << -sum.tangential[0] << ", closed form " << closed << "\n";
  }
}

TEUCHOS_UNIT_TEST(FrictionFields, AnExpressionEqualsItsValuesAtTheNodes) {
  for (const bool isFloorElastic : {false, true}) {
    const auto a = slideBlock(isFloorElastic, Given::Expression), b = slideBlock(isFloorElastic, Given::Field);
    TEST_ASSERT(a.solved && b.solved);
    TEST_EQUALITY(a.report.solver.hessianMultiplications, b.report.solver.hessianMultiplications);
    double difference = 0;
    for (std::size_t i = 0; i < a.displacement.size(); ++i) difference = std::max(difference, std::abs(a.displacement[i] - b.displacement[i]));
    TEST_COMPARE(difference, <=, 1e-14);
  }
}

// ---- a sleeve, pressed on a shaft that is 1e-3 too thick, moved along and turned about it ----

constexpr double kRadius = 0.5, kFit = 1e-3, kAround = 0.3, kAlong = 0.12;

Mesh sleeveOnShaft(bool isMortar) {
  Mesh mesh;
  addRing(mesh, {"shaft", 0.25, kRadius + kFit, 1.0, {12, 1, 2}, 0});
  addRing(mesh, {"sleeve", kRadius, 1.0, 1.0, {12, 1, isMortar ? 3 : 2}, 0});
  return mesh;
}

// \param fieldOfAxes axes by nodal fields in place of cylindrical ones
SimulationResult moveSleeve(double along, double around, bool isMortar, bool fieldOfAxes) {
  Mesh mesh = sleeveOnShaft(isMortar);
  std::array<NodalField, 3> axes{NodalField{"AX", {}}, {"AY", {}}, {"AZ", {}}};
  for (const auto& x : mesh.coordinates) {
    axes[0].values.push_back(-3 * x[1]);
    axes[1].values.push_back(3 * x[0]);
    axes[2].values.push_back(0);
  }
  mesh.nodalFields.assign(axes.begin(), axes.end());
  const Friction friction{"Coulomb", {kAround, kAlong}};
  const auto text = [](double v) { return std::to_string(v); };
  ScenarioBuilder scene(mesh);
  scene.material("shaft", 1e3, 0.3)
      .material("sleeve", 1e3, 0.3)
      .clamp({"shaft_inner"})
      .displacementField({"sleeve_outer"}, "xyz", {"-(" + text(around) + ")*y", "(" + text(around) + ")*x", text(along)})
      .contact("sleeve_inner", "shaft_outer", &friction)
      .contactOption("Discretization", isMortar ? "Mortar" : "Node To Node")
      .contactOption("Sides", "As Given")
      .decomposition("METIS", 4)
      .tolerance(1e-10);
  Teuchos::ParameterList list;
  if (fieldOfAxes) {
    list.set("Principal Field", Teuchos::Array<std::string>(Teuchos::tuple<std::string>("AX", "AY", "AZ")));
  } else {
    list.sublist("Cylindrical")
        .set("Point", Teuchos::Array<double>(Teuchos::tuple(0.0, 0.0, 7.0)))
        .set("Axis", Teuchos::Array<double>(Teuchos::tuple(0.0, 0.0, 2.0)))
        .set("Direction", std::string("Circumferential"));
  }
  return scene.frictionOptions(list).solve();
}

// Force along the axis and torque about it, on the sleeve, and the sum of normal forces.
struct Resistance {
  double normal = 0, force = 0, torque = 0;
};

Resistance resistanceOf(const SimulationResult& result, const Mesh& sleeve) {
  Resistance sum;
  for (const auto& pair : result.pairs) {
    sum.normal += pair.normalForce;
    for (const auto& [node, weight] : pair.secondary) {
      const auto& x = sleeve.coordinates[std::size_t(node)];
      sum.force += weight * pair.force[2];
      sum.torque += weight * (x[0] * pair.force[1] - x[1] * pair.force[0]);
    }
  }
  return sum;
}

// ANALYTIC: all slip; along the axis F_along sum lambda_N, around it F_around R sum lambda_N.
TEUCHOS_UNIT_TEST(FrictionFields, ASleeveAlongAndAroundItsShaft) {
  for (const bool isMortar : {false, true}) {
    const auto pushed = moveSleeve(0.2, 0, isMortar, false), turned = moveSleeve(0, 0.4, isMortar, false);
    TEST_ASSERT(pushed.solved && turned.solved);
    if (pushed.pairs.empty()) continue;
    const auto push = resistanceOf(pushed, sleeveOnShaft(isMortar)), turn = resistanceOf(turned, sleeveOnShaft(isMortar));
    TEST_COMPARE(push.normal, >, 1.0);
    TEST_FLOATING_EQUALITY(-push.force, kAlong * push.normal, 1e-7);
    TEST_COMPARE(std::abs(push.torque), <=, 1e-7 * push.normal);
    TEST_FLOATING_EQUALITY(-turn.torque, kAround * kRadius * turn.normal, 1e-7);
    TEST_COMPARE(std::abs(turn.force), <=, 1e-7 * turn.normal);
    for (const auto& pair : pushed.pairs) TEST_ASSERT(pair.status == ContactStatus::Slip);
    out << "N " << push.normal << ", along " << -push.force << ", torque " << -turn.torque << "\n";
  }
}

// ANALYTIC: lambda_T = lambda_N F^2 s / |F s| at every pair, with the slip s around and along.
TEUCHOS_UNIT_TEST(FrictionFields, AScrewedSleeveObeysTheLawAtEveryPair) {
  const auto result = moveSleeve(0.1, 0.3, false, false), same = moveSleeve(0.1, 0.3, false, true);
  TEST_ASSERT(result.solved && same.solved);
  const Mesh mesh = sleeveOnShaft(false);
  for (std::size_t i = 0; i < result.pairs.size(); ++i) {
    const auto& pair = result.pairs[i];
    const auto& x = mesh.coordinates[std::size_t(pair.secondaryNode)];
    const Array3 around{-x[1] / kRadius, x[0] / kRadius, 0};
    TEST_COMPARE(std::abs(dot(pair.axis, around)), >=, 1 - 1e-12);
    const double s1 = dot(pair.slip, around), s2 = pair.slip[2], length = std::hypot(kAround * s1, kAlong * s2);
    TEST_FLOATING_EQUALITY(-dot(pair.force, around), pair.normalForce * kAround * kAround * s1 / length, 1e-6);
    TEST_FLOATING_EQUALITY(-pair.force[2], pair.normalForce * kAlong * kAlong * s2 / length, 1e-6);
    for (int d = 0; d < 3; ++d) TEST_COMPARE(std::abs(pair.force[d] - same.pairs[i].force[d]), <=, 1e-9);
  }
}

}  // namespace
