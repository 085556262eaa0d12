// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NodalLoads.hpp"

#include <Eigen/Geometry>
#include <Teuchos_Assert.hpp>
#include <cmath>
#include <sstream>

#include "Haptos_Error.hpp"
#include "Haptos_ReferenceElement.hpp"

namespace Haptos {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr int kMaxNodes = 27;

// Nodes of an element or a side: first node, and places relative to it.
struct Patch {
  std::array<int, kMaxNodes> nodes{};
  int numNodes = 0;
  Vector3d origin = Vector3d::Zero();
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxNodes> relative;
};

// One cubature point of a patch: place x, N_a(x), and the weighted normal or volume there.
struct PatchPoint {
  Vector3d place;
  Vector3d areaVector;  // sides: outward normal times area
  double measure;       // area or volume
  const double* values;
};

// Places relative to the first node keep their digits far from the origin.
Patch makePatch(const Coordinates& coordinates, const int* nodes, int numNodes) {
  Patch patch;
  patch.numNodes = numNodes;
  patch.relative.resize(3, numNodes);
  for (int a = 0; a < numNodes; ++a) {
    patch.nodes[std::size_t(a)] = nodes[a];
    const Vector3d x(coordinates[std::size_t(nodes[a])].data());
    if (a == 0) patch.origin = x;
    patch.relative.col(a) = x - patch.origin;
  }
  return patch;
}

// dx/dxi_k at a point
Vector3d tangent(const Patch& patch, const ReferenceElement& rule, int point, int k) {
  Vector3d t = Vector3d::Zero();
  for (int a = 0; a < patch.numNodes; ++a)
    t += rule.gradients(rule.dimension() * a + k, point) * patch.relative.col(a);
  return t;
}

// x = sum_a N_a x_a; on a side dx/dxi_1 x dx/dxi_2, outward as sides list their nodes, in a body dotted with dx/dxi_3
PatchPoint evaluate(const Patch& patch, const ReferenceElement& rule, int point) {
  PatchPoint result;
  result.values = rule.values.col(point).data();
  Vector3d offset = Vector3d::Zero();
  for (int a = 0; a < patch.numNodes; ++a) offset += result.values[a] * patch.relative.col(a);
  result.place = patch.origin + offset;
  const Vector3d normal = tangent(patch, rule, point, 0).cross(tangent(patch, rule, point, 1));
  result.areaVector = rule.weights(point) * normal;
  result.measure = rule.dimension() == 2 ? result.areaVector.norm()
                                         : result.areaVector.dot(tangent(patch, rule, point, 2));
  return result;
}

template <class Visit>
void visitPoints(const Patch& patch, const ReferenceElement& rule, const Visit& visit) {
  for (int p = 0; p < rule.numPoints(); ++p) visit(evaluate(patch, rule, p));
}

template <class Visit>
void visitSidePoints(const Coordinates& coordinates, const ElementGroup& group,
                     const std::vector<GroupSide>& sides, const Visit& visit) {
  for (const auto& side : sides) {
    TEUCHOS_ASSERT(side.element >= 0 && side.element < group.numElements());
    const auto& positions = sideNodes(group.topology, side.side);
    const auto& rule = sideRule(positions.shape);
    std::array<int, 9> nodes{};
    for (int a = 0; a < positions.numNodes; ++a) nodes[std::size_t(a)] = group.nodes(side.element)[positions[a]];
    const auto patch = makePatch(coordinates, nodes.data(), positions.numNodes);
    visitPoints(patch, rule, [&](const PatchPoint& point) { visit(side, patch, point); });
  }
}

// f_a += N_a times the force at the point
void addForce(const Patch& patch, const PatchPoint& point, const Vector3d& force,
              Eigen::Ref<Eigen::VectorXd> f) {
  for (int a = 0; a < patch.numNodes; ++a)
    f.segment<3>(3 * Index(patch.nodes[std::size_t(a)])) += point.values[a] * force;
}

// An expression may be good everywhere but at one point: that is named.
[[noreturn]] void throwNotFinite(const char* load, const Vector3d& x, const std::string& where) {
  std::ostringstream message;
  message << load << " at (" << x.x() << ", " << x.y() << ", " << x.z() << ") on " << where
          << " is not a finite number; correct the Value of the boundary condition";
  throw InputError(message.str());
}

Vector3d valueAt(const VectorField& field, const Vector3d& x) {
  const auto value = field(x.x(), x.y(), x.z());
  return {value[0], value[1], value[2]};
}

}  // namespace

void addBodyForce(const Coordinates& coordinates, const ElementGroup& group, const VectorField& force,
                  Eigen::Ref<Eigen::VectorXd> f) {
  TEUCHOS_ASSERT(f.size() == 3 * Index(coordinates.size()));
  const auto& rule = bodyLoadRule(group.topology);
  for (int e = 0; e < group.numElements(); ++e) {
    const auto patch = makePatch(coordinates, group.nodes(e), rule.numNodes());
    visitPoints(patch, rule, [&](const PatchPoint& point) {
      const Vector3d value = valueAt(force, point.place);
      if (!value.allFinite()) throwNotFinite("the body force", point.place, describeElement(group, e));
      addForce(patch, point, point.measure * value, f);
    });
  }
}

// f_a += sum over points of N_a t |dA|
void addTraction(const Coordinates& coordinates, const ElementGroup& group,
                 const std::vector<GroupSide>& sides, const VectorField& traction,
                 Eigen::Ref<Eigen::VectorXd> f) {
  TEUCHOS_ASSERT(f.size() == 3 * Index(coordinates.size()));
  visitSidePoints(coordinates, group, sides,
                  [&](GroupSide side, const Patch& patch, const PatchPoint& point) {
                    const Vector3d value = valueAt(traction, point.place);
                    if (!value.allFinite())
                      throwNotFinite("the traction", point.place, describeElement(group, side.element));
                    addForce(patch, point, point.measure * value, f);
                  });
}

// f_a -= sum over points of N_a p dA: pressure pushes against the outward normal, warped sides included.
void addPressure(const Coordinates& coordinates, const ElementGroup& group,
                 const std::vector<GroupSide>& sides, const ScalarField& pressure,
                 Eigen::Ref<Eigen::VectorXd> f) {
  TEUCHOS_ASSERT(f.size() == 3 * Index(coordinates.size()));
  visitSidePoints(coordinates, group, sides,
                  [&](GroupSide side, const Patch& patch, const PatchPoint& point) {
                    const double value = pressure(point.place.x(), point.place.y(), point.place.z());
                    if (!std::isfinite(value))
                      throwNotFinite("the pressure", point.place, describeElement(group, side.element));
                    addForce(patch, point, -value * point.areaVector, f);
                  });
}

}  // namespace Haptos
