// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_LinearElasticity.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Teuchos_Assert.hpp>
#include <array>
#include <cmath>
#include <sstream>

#include "Haptos_InputCheck.hpp"
#include "Haptos_ReferenceElement.hpp"

namespace Haptos {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

template <class Shape>
using NodeColumns = Eigen::Matrix<double, 3, Shape::numNodes, Eigen::ColMajor, 3, Shape::maxNodes>;

// The same 3 numNodes numbers as a vector and as columns of nodes.
template <class Shape>
Eigen::Map<const NodeColumns<Shape>> asColumns(const double* entries, int numNodes) {
  return Eigen::Map<const NodeColumns<Shape>>(entries, 3, numNodes);
}

// From the element's first node: a mesh far from the origin loses no digits of its edges.
template <class Shape>
NodeColumns<Shape> relativeCoordinates(const Coordinates& coordinates, const int* nodes, int numNodes) {
  NodeColumns<Shape> x(3, numNodes);
  const auto& origin = coordinates[std::size_t(nodes[0])];
  for (int a = 0; a < numNodes; ++a)
    for (int i = 0; i < 3; ++i)
      x(i, a) = coordinates[std::size_t(nodes[a])][std::size_t(i)] - origin[std::size_t(i)];
  return x;
}

// J_ik = dx_i/dxi_k
template <class Shape>
Matrix3d jacobian(const NodeColumns<Shape>& x, const ReferenceElement& rule, int point) {
  return x * asColumns<Shape>(rule.gradients.col(point).data(), int(x.cols())).transpose();
}

double determinantOf(const Matrix3d& j) { return j.col(0).dot(j.col(1).cross(j.col(2))); }

// Relative to the edges, so that thin needles pass and flat elements do not, in any unit of length.
bool isAcceptable(const Matrix3d& j, double determinant) {
  return determinant > 1e-12 * j.col(0).norm() * j.col(1).norm() * j.col(2).norm();
}

// Which of three mistakes it is, as each has a remedy of its own: nodes in mirrored order, a folded element, one without volume.
template <class Shape>
[[noreturn]] void throwBadElement(const NodeColumns<Shape>& x, const ElementGroup& group, int element) {
  const auto& rule = stiffnessRule(group.topology);
  int negative = 0, bad = 0, worst = 0;
  double lowest = std::numeric_limits<double>::infinity();
  for (int p = 0; p < rule.numPoints(); ++p) {
    const Matrix3d j = jacobian<Shape>(x, rule, p);
    const double determinant = determinantOf(j);
    if (isAcceptable(j, determinant)) continue;
    ++bad;
    if (isAcceptable(j, -determinant)) ++negative;
    if (determinant < lowest) lowest = determinant, worst = p;
  }
  std::ostringstream message;
  message << describeElement(group, element);
  if (!x.allFinite())
    message << " has a node whose coordinates are not finite; correct the mesh";
  else if (negative == rule.numPoints())
    message << " is inverted (Jacobian determinant " << lowest
            << " < 0 everywhere): its nodes are listed in mirrored order; reorder them as Exodus does";
  else if (negative > 0)
    message << " is folded (Jacobian determinant " << lowest << " < 0 at " << negative << " of "
            << rule.numPoints() << " integration points, lowest at point " << worst + 1
            << "); move its nodes so that the determinant is positive everywhere";
  else
    message << " is degenerate (Jacobian determinant " << lowest << " at " << bad << " of "
            << rule.numPoints() << " integration points: it has no volume there); merge or move its nodes";
  throw InputError(message.str());
}

// Along a straight edge x = a + (1 + xi) / 2 (b - a) + (1 - xi^2) (middle - (a + b) / 2): dx/dxi keeps its direction on [-1, 1] while
// the middle lies between 1/4 (a crack tip's) and 3/4.
template <class Shape>
void checkMiddles(const NodeColumns<Shape>& x, const ElementGroup& group, int element) {
  constexpr double kRoundOff = 1e-6;
  const ElementShape& shape = elementShape(group.topology);
  for (int i = 0; shape.hasMidNodes() && i < shape.numEdges; ++i) {
    const auto& edge = shape.edges[std::size_t(i)];
    const int middle = shape.numCorners + i;
    const Vector3d along = x.col(edge[1]) - x.col(edge[0]);
    const double place = (x.col(middle) - x.col(edge[0])).dot(along) / along.squaredNorm();
    HAPTOS_REFUSE_IF(std::abs(place - 0.5) > 0.25 + kRoundOff,
                     describeElement(group, element) << " has its node " << middle + 1 << ", which belongs in the middle between its nodes "
                                                     << edge[0] + 1 << " and " << edge[1] + 1 << ", at " << place
                                                     << " of the way; it must lie between 1/4 and 3/4, or the edge folds back: move it");
  }
}

// sigma = shear (H + H^T) + dilatational tr(H) I, where H_ij = du_i/dx_j
Matrix3d stressOf(const Matrix3d& h, double shear, double dilatational) {
  Matrix3d sigma = shear * (h + h.transpose());
  sigma.diagonal().array() += dilatational * h.trace();
  return sigma;
}

// u on the element's nodes.
template <class Shape>
ElementVector<Shape> gather(const Eigen::Ref<const Eigen::VectorXd>& u, const int* nodes, int numNodes) {
  ElementVector<Shape> local(3 * numNodes);
  for (int a = 0; a < numNodes; ++a)
    local.template segment<3>(3 * a) = u.segment<3>(3 * Eigen::Index(nodes[a]));
  return local;
}

// The stress of the mean gradient, h = sum_p V_p h_p / V: what B-bar and plain elements have in common, and free of locking.
template <class Shape>
void groupStresses(const Coordinates& coordinates, const ElementGroup& group, const ElasticModuli& moduli,
                   const Eigen::Ref<const Eigen::VectorXd>& u, std::vector<Stress>& stresses) {
  for (int e = 0; e < group.numElements(); ++e) {
    const auto gradients = elementGradients<Shape>(coordinates, group, e);
    const ElementVector<Shape> mean = gradients.at * gradients.volumes / gradients.volumes.sum();
    const int n = gradients.numNodes();
    const ElementVector<Shape> local = gather<Shape>(u, group.nodes(e), n);
    const Matrix3d h = asColumns<Shape>(local.data(), n) * asColumns<Shape>(mean.data(), n).transpose();
    const Matrix3d s = stressOf(h, moduli.shear, moduli.lambda);
    stresses.push_back({s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(2, 0)});
  }
}

// In the order of `Topology`: with 1, x, y and z HEX20 and HEX27 keep their order; others would lock, or their pressures oscillate.  WEDGE15 has 1 and z of
// the reference cell: with 1 alone a layer of them has a motion without energy (decisions/051).
constexpr std::array<int, kNumTopologies> kPressureModes{1, 1, 4, 4, 1, 1, 2, 1, 1};

// BBar leaves div u as it is in a part of the bulk modulus, that of a material with this Poisson's ratio.  With single pressures alone layers would bend as if
// volumes could change at will, at any nu; a cell of two wedges has a motion without energy with its two (decisions/051).
constexpr std::array<double, kNumTopologies> kUnprojected{-1, -1, -1, -1, 0.35, -1, -0.5, -1, 0.35};

// div u has the modulus c + 2/3 shear at every point and `projected` in its projection, together bulk.
struct Volumetric {
  double c, projected;
};
Volumetric volumetric(const ElasticModuli& moduli, Formulation formulation, double unprojected) {
  const double c = 2 * moduli.shear * unprojected / (1 - 2 * unprojected);
  if (formulation == Formulation::Standard || moduli.lambda <= c) return {moduli.lambda, 0.0};
  return {c, moduli.bulk - (c + 2.0 / 3.0 * moduli.shear)};
}

// At the cubature points, made orthonormal by the modified Gram-Schmidt method.
template <class Shape>
void setModes(const NodeColumns<Shape>& x, const ReferenceElement& rule, int count, ElementGradients<Shape>& result) {
  auto& modes = result.modes;
  modes.resize(rule.numPoints(), count);
  for (int i = 0; i < count; ++i) {
    if (i == 0) modes.col(0).setOnes();
    else if (count == 2) modes.col(i) = rule.points.row(2).transpose();
    else modes.col(i) = (x.row(i - 1) * rule.values).transpose();
    for (int k = 0; k < i; ++k) modes.col(i) -= modes.col(k).cwiseProduct(result.volumes).dot(modes.col(i)) * modes.col(k);
    modes.col(i) /= std::sqrt(modes.col(i).cwiseAbs2().dot(result.volumes));
  }
}

}  // namespace

// lambda = E nu / ((1 + nu)(1 - 2 nu)), shear = E / (2 (1 + nu)), bulk = E / (3 (1 - 2 nu)): nu = 1/2 has no lambda
ElasticModuli elasticModuli(const IsotropicMaterial& material) {
  const double e = material.youngsModulus, nu = material.poissonsRatio;
  HAPTOS_REFUSE_IF(!(e > 0.0) || std::isinf(e),
                   "material \"" << material.name << "\": Young's Modulus is " << e << "; it must be finite and > 0");
  HAPTOS_REFUSE_IF(!(nu > -1.0 && nu < 0.5),
                   "material \"" << material.name << "\": Poisson's Ratio is " << nu << "; it must be > -1 and < 0.5");
  const double shear = e / (2.0 * (1.0 + nu));
  return {e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), shear, e / (3.0 * (1.0 - 2.0 * nu))};
}

// grad N_a = J^-T dN_a/dxi at every point, and what each point stands for, w det J.
template <class Shape>
ElementGradients<Shape> elementGradients(const Coordinates& coordinates, const ElementGroup& group,
                                         int element) {
  const auto& rule = stiffnessRule(group.topology);
  const int n = rule.numNodes();
  const auto x = relativeCoordinates<Shape>(coordinates, group.nodes(element), n);
  if constexpr (Shape::numNodes == Eigen::Dynamic) checkMiddles<Shape>(x, group, element);
  ElementGradients<Shape> result;
  result.at.resize(3 * n, rule.numPoints());
  result.volumes.resize(rule.numPoints());
  for (int p = 0; p < rule.numPoints(); ++p) {
    const Matrix3d j = jacobian<Shape>(x, rule, p);
    Matrix3d cofactor;  // J^-T = cofactor / det J
    cofactor << j.col(1).cross(j.col(2)), j.col(2).cross(j.col(0)), j.col(0).cross(j.col(1));
    const double determinant = j.col(0).dot(cofactor.col(0));
    if (!isAcceptable(j, determinant)) throwBadElement<Shape>(x, group, element);
    const Matrix3d inverseTranspose = cofactor / determinant;
    Eigen::Map<NodeColumns<Shape>>(result.at.col(p).data(), 3, n).noalias() =
        inverseTranspose * asColumns<Shape>(rule.gradients.col(p).data(), n);
    result.volumes(p) = rule.weights(p) * determinant;
  }
  result.unprojected = kUnprojected[std::size_t(group.topology)];
  if constexpr (Shape::numNodes == Eigen::Dynamic) setModes<Shape>(x, rule, kPressureModes[std::size_t(group.topology)], result);
  return result;
}

// With M_ab = integral of grad N_a (x) grad N_b, the block of nodes a and b is
//   K_ab = c M_ab + shear (M_ab^T + tr(M_ab) I),            c = lambda,
// and for BBar, whose volumetric part is bulk q_a (x) q_b with q_a = integral of psi grad N_a summed over the modes psi, c = -2/3 shear,
// or a part of both (`volumetric`); linear elements have psi = 1 / sqrt(V).
template <class Shape>
void elementStiffness(const ElementGradients<Shape>& gradients, const ElasticModuli& moduli,
                      Formulation formulation, ElementStiffness<Shape>& stiffness) {
  const auto [c, projected] = volumetric(moduli, formulation, gradients.unprojected);

  // Scaled by square roots, M = S S^T is symmetric to the last digit, and so is K.
  const decltype(gradients.at) s = gradients.at * gradients.volumes.cwiseSqrt().asDiagonal();
  ElementStiffness<Shape> m;
  if constexpr (Shape::numNodes != Eigen::Dynamic) {
    m.noalias() = s.lazyProduct(s.transpose());
  } else {
    m.setZero(s.rows(), s.rows());
    m.template selfadjointView<Eigen::Lower>().rankUpdate(s);
    m.template triangularView<Eigen::StrictlyUpper>() = m.transpose();
    stiffness.resize(s.rows(), s.rows());
  }
  for (int b = 0; b < gradients.numNodes(); ++b)
    for (int a = 0; a < gradients.numNodes(); ++a) {
      const Matrix3d block = m.template block<3, 3>(3 * a, 3 * b);
      Matrix3d k = c * block + moduli.shear * block.transpose();
      k.diagonal().array() += moduli.shear * block.trace();
      stiffness.template block<3, 3>(3 * a, 3 * b) = k;
    }
  if (projected == 0) return;
  if constexpr (Shape::numNodes == Eigen::Dynamic) {
    for (int i = 0; i < gradients.modes.cols(); ++i) {
      const ElementVector<Shape> q = gradients.at * gradients.volumes.cwiseProduct(gradients.modes.col(i)) * std::sqrt(projected);
      stiffness += q.lazyProduct(q.transpose());
    }
    return;
  }
  const ElementVector<Shape> q =
      gradients.at * gradients.volumes * std::sqrt(projected / gradients.volumes.sum());
  stiffness += q.lazyProduct(q.transpose());
}

// f_a = sum over points of V_p sigma_p grad N_a(p), sigma_p from h = sum_a u_a (x) grad N_a; for BBar the deviator there and the
// pressure bulk P(div u), P the projection on the modes, or a part of both: the same K u without K.  From the first node's displacement, as
// far as a body goes as a whole costs no digits.
template <class Shape>
ElementVector<Shape> elementForce(const ElementGradients<Shape>& gradients, const ElasticModuli& moduli,
                                  Formulation formulation, const ElementVector<Shape>& displacement) {
  const auto [c, projected] = volumetric(moduli, formulation, gradients.unprojected);
  const int n = gradients.numNodes();
  const auto absolute = asColumns<Shape>(displacement.data(), n);
  const NodeColumns<Shape> u = absolute.colwise() - Vector3d(absolute.col(0));
  NodeColumns<Shape> force = NodeColumns<Shape>::Zero(3, n);
  decltype(gradients.volumes) dilatations(gradients.numPoints());  // their sum is the integral of div u
  for (int p = 0; p < gradients.numPoints(); ++p) {
    const auto gradient = asColumns<Shape>(gradients.at.col(p).data(), n);
    const Matrix3d h = u * gradient.transpose();
    const Matrix3d weightedStress = gradients.volumes(p) * stressOf(h, moduli.shear, c);
    force += weightedStress * gradient;
    dilatations(p) = gradients.volumes(p) * h.trace();
  }
  ElementVector<Shape> result = Eigen::Map<const ElementVector<Shape>>(force.data(), 3 * n);
  if (projected != 0) {
    if constexpr (Shape::numNodes == Eigen::Dynamic) {
      const auto pressure = (projected * gradients.modes * (gradients.modes.transpose() * dilatations)).eval();
      result += gradients.at * gradients.volumes.cwiseProduct(pressure);
    } else {
      const double pressure = projected * dilatations.sum() / gradients.volumes.sum();
      result += pressure * (gradients.at * gradients.volumes);
    }
  }
  return result;
}

void checkElements(const Coordinates& coordinates, const ElementGroup& group) {
  withShape(group.topology, [&](auto shape) {
    for (int e = 0; e < group.numElements(); ++e) elementGradients<decltype(shape)>(coordinates, group, e);
  });
}

// One stress an element.
std::vector<Stress> elementStresses(const Coordinates& coordinates, const ElementGroup& group,
                                    const IsotropicMaterial& material,
                                    const Eigen::Ref<const Eigen::VectorXd>& displacement) {
  TEUCHOS_ASSERT(displacement.size() == 3 * Eigen::Index(coordinates.size()));
  const auto moduli = elasticModuli(material);
  std::vector<Stress> stresses;
  stresses.reserve(std::size_t(group.numElements()));
  withShape(group.topology, [&](auto shape) { groupStresses<decltype(shape)>(coordinates, group, moduli, displacement, stresses); });
  return stresses;
}

double vonMises(const Stress& s) {
  const double xy = s[0] - s[1], yz = s[1] - s[2], zx = s[2] - s[0];
  return std::sqrt(0.5 * (xy * xy + yz * yz + zx * zx) + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

#define HAPTOS_INSTANTIATE(Shape)                                                                                               \
  template ElementGradients<Shape> elementGradients(const Coordinates&, const ElementGroup&, int);                              \
  template void elementStiffness(const ElementGradients<Shape>&, const ElasticModuli&, Formulation, ElementStiffness<Shape>&);  \
  template ElementVector<Shape> elementForce(const ElementGradients<Shape>&, const ElasticModuli&, Formulation,                 \
                                             const ElementVector<Shape>&);
HAPTOS_INSTANTIATE(Hex8Shape)
HAPTOS_INSTANTIATE(Tet4Shape)
HAPTOS_INSTANTIATE(AnyShape)
#undef HAPTOS_INSTANTIATE

}  // namespace Haptos
