// SPDX-License-Identifier: BSD-3-Clause
#include "ScenarioBuilder.hpp"

#include <Teuchos_Array.hpp>
#include <Tpetra_Core.hpp>
#include <cmath>

#include "Haptos_Parameters.hpp"

namespace Haptos::Verification {
namespace {

Teuchos::Array<double> arrayOf(const Array3& v) { return Teuchos::tuple(v[0], v[1], v[2]); }

}  // namespace

ScenarioBuilder::ScenarioBuilder(Mesh mesh, std::vector<int> bricks) : source_{std::move(mesh), std::move(bricks)} {
  if (source_.bricks.empty()) parameters_.sublist("Mesh").set("File", std::string("in memory"));
  else nameBeams({});  // which alone may have bricks; the mesh in memory goes before
}

ScenarioBuilder::ScenarioBuilder(const TwoBeamsSpec& beams) : source_{makeTwoBeams(beams), brickSubdomains(beams)} { nameBeams(beams); }

void ScenarioBuilder::nameBeams(const TwoBeamsSpec& beams) {
  parameters_.sublist("Mesh")
      .sublist("Two Beams")
      .set("Subdomains Per Edge", beams.subdomainsPerEdge)
      .set("Elements Per Subdomain Edge", beams.elementsPerSubdomainEdge);
}

ScenarioBuilder& ScenarioBuilder::moveNodes(const std::function<Array3(const Array3&)>& map) {
  for (auto& x : source_.mesh.coordinates) x = map(x);
  return *this;
}

ScenarioBuilder& ScenarioBuilder::material(const std::string& block, double youngsModulus, double poissonsRatio) {
  parameters_.sublist("Materials")
      .sublist(block)
      .set("Element Blocks", Teuchos::Array<std::string>(1, block))
      .set("Young's Modulus", youngsModulus)
      .set("Poisson's Ratio", poissonsRatio);
  return *this;
}

Teuchos::ParameterList& ScenarioBuilder::newCondition(const std::string& type, const Names& sets) {
  auto& conditions = parameters_.sublist("Boundary Conditions");
  auto& list = conditions.sublist("condition " + std::to_string(conditions.numParams() + 1));
  list.set("Type", type).set("Sets", Teuchos::Array<std::string>(sets));
  return list;
}

ScenarioBuilder& ScenarioBuilder::displacement(const Names& sets, const std::string& components, const Array3& value) {
  newCondition("Displacement", sets).set("Components", components).set("Value", arrayOf(value));
  return *this;
}

ScenarioBuilder& ScenarioBuilder::displacementField(const Names& sets, const std::string& components,
                                                    const std::array<std::string, 3>& expressions) {
  newCondition("Displacement", sets).set("Components", components)
      .set("Value", Teuchos::Array<std::string>(expressions.begin(), expressions.end()));
  return *this;
}

ScenarioBuilder& ScenarioBuilder::pressure(const Names& sets, double value) {
  newCondition("Pressure", sets).set("Value", value);
  return *this;
}

ScenarioBuilder& ScenarioBuilder::pressure(const Names& sets, const std::string& expression) {
  newCondition("Pressure", sets).set("Value", expression);
  return *this;
}

ScenarioBuilder& ScenarioBuilder::traction(const Names& sets, const Array3& value) {
  newCondition("Traction", sets).set("Value", arrayOf(value));
  return *this;
}

ScenarioBuilder& ScenarioBuilder::nodalForces(NodalForces forces) {
  forces_.push_back(std::move(forces));
  return *this;
}

Teuchos::ParameterList& ScenarioBuilder::newContact(const std::string& secondary, const Friction* friction) {
  auto& list = parameters_.sublist("Contact").sublist("on " + secondary);
  list.set("Secondary Side Set", secondary);
  if (!friction) return list;
  auto& law = list.sublist("Friction");
  law.set("Law", friction->law)
      .set("Coefficients", Teuchos::Array<double>(Teuchos::tuple(friction->coefficients[0], friction->coefficients[1])))
      .set("Principal Direction", arrayOf(friction->principalDirection));
  if (friction->law == "Tresca") law.set("Slip Bound", friction->slipBound);
  return list;
}

ScenarioBuilder& ScenarioBuilder::contact(const std::string& secondary, const std::string& primary, const Friction* friction) {
  newContact(secondary, friction)
      .set("Primary Side Set", primary)
      .set("Discretization", std::string("Node To Node"));
  return *this;
}

ScenarioBuilder& ScenarioBuilder::contactOption(const std::string& name, const std::string& value) {
  auto& contacts = parameters_.sublist("Contact");
  for (const auto& entry : contacts) {
    auto& list = contacts.sublist(entry.first);
    if (list.isParameter("Primary Side Set")) list.set(name, value);
  }
  return *this;
}

ScenarioBuilder& ScenarioBuilder::frictionOptions(const Teuchos::ParameterList& list) {
  auto& contacts = parameters_.sublist("Contact");
  for (const auto& entry : contacts) {
    auto& friction = contacts.sublist(entry.first).sublist("Friction");
    if (list.isParameter("Principal Field") || list.isSublist("Cylindrical")) friction.remove("Principal Direction");
    friction.setParameters(list);
  }
  return *this;
}

ScenarioBuilder& ScenarioBuilder::rigidPlane(const std::string& secondary, const Array3& point, const Array3& normal,
                                             const Friction* friction) {
  newContact(secondary, friction).sublist("Rigid Plane").set("Point", arrayOf(point)).set("Normal", arrayOf(normal));
  return *this;
}

ScenarioBuilder& ScenarioBuilder::decomposition(const std::string& method, int subdomains) {
  parameters_.sublist("Decomposition").set("Method", method).set("Subdomains", subdomains);
  return *this;
}

ModelReport ScenarioBuilder::prepare() const {
  Simulation run(Tpetra::getDefaultComm(), validatedParameters(parameters_), nullptr, &source_);
  for (const auto& forces : forces_) run.addNodalForces(forces);
  run.prepare();
  return run.report().model;
}

SimulationResult ScenarioBuilder::solve() const {
  Simulation run(Tpetra::getDefaultComm(), validatedParameters(parameters_), nullptr, &source_);
  for (const auto& forces : forces_) run.addNodalForces(forces);
  run.prepare();
  SimulationResult result = run.solve();
  result.displacement = wholeOnRoot(*Tpetra::getDefaultComm(), result.displacement);
  return result;
}

std::vector<double> gradedAxis(double fine, int fineCells, double length, int n) {
  std::vector<double> x{0.0};
  const double h = fine / fineCells;
  for (int i = 1; i <= fineCells; ++i) x.push_back(h * i);
  // The ratio q of neighbouring cells: h (q + q^2 + ... + q^m) = length - fine, by bisection.
  double low = 1.0, high = 10.0;
  const auto reach = [&](double q) {
    double sum = 0, cell = h;
    for (int i = fineCells; i < n; ++i) sum += cell *= q;
    return fine + sum;
  };
  for (int i = 0; i < 100; ++i) (reach(0.5 * (low + high)) < length ? low : high) = 0.5 * (low + high);
  double cell = h;
  for (int i = fineCells; i < n; ++i) x.push_back(x.back() + (cell *= low));
  x.back() = length;
  return x;
}

std::array<Array3, 3> rotation(const Array3& axis, double angle) {
  const double length = std::sqrt(dot(axis, axis)), c = std::cos(angle), s = std::sin(angle);
  const Array3 a{axis[0] / length, axis[1] / length, axis[2] / length};
  std::array<Array3, 3> Q;
  for (int i = 0; i < 3; ++i) {
    Array3 e{0, 0, 0};
    e[i] = 1;
    const Array3 aXe = cross(a, e);
    for (int j = 0; j < 3; ++j) Q[j][i] = c * e[j] + s * aXe[j] + (1 - c) * a[i] * a[j];  // Rodrigues
  }
  return Q;
}

Array3 operator*(const std::array<Array3, 3>& Q, const Array3& x) { return {dot(Q[0], x), dot(Q[1], x), dot(Q[2], x)}; }

double dot(const Array3& a, const Array3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Array3 cross(const Array3& a, const Array3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Resultants resultants(const SimulationResult& result) {
  Resultants sum;
  for (const auto& pair : result.pairs) {
    sum.normal += pair.normalForce;
    for (int d = 0; d < 3; ++d) {
      sum.tangential[d] += pair.tangentialForce[d];
      sum.force[d] += pair.force[d];
    }
  }
  return sum;
}

}  // namespace Haptos::Verification
