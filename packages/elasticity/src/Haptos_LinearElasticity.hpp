// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "Haptos_ElementGroup.hpp"

namespace Haptos {

/// \brief Isotropic linear elasticity; Young's modulus in force per area, Poisson's ratio [-].
struct IsotropicMaterial {
  std::string name;
  double youngsModulus = 0.0;
  double poissonsRatio = 0.0;
};

/// \brief sigma = 2 shear dev(eps) + bulk tr(eps) I = 2 shear eps + lambda tr(eps) I; all in force per area.
struct ElasticModuli {
  double lambda;
  double shear;
  double bulk;
};

/// \throws InputError unless E > 0 and -1 < nu < 1/2, both finite.
ElasticModuli elasticModuli(const IsotropicMaterial& material);

/// \brief Standard: eps = sym grad u.  BBar: its trace is replaced by its mean over the element, in HEX20 and HEX27 by its best
/// linear approximation, in WEDGE15 by its best one on 1 and z of the reference cell; in TETRA10 and PYRAMID13 for that part of the bulk modulus
/// which a material of nu = .35 has not, in WEDGE15 of nu = -.5.
///
/// BBar (T. J. R. Hughes, Int. J. Numer. Meth. Engng 15 (1980) 1413) frees Hex8 and the quadratic elements from volumetric locking
/// near nu = 1/2 (doc/decisions/032, 051).  On Tet4 the two are the same; Wedge6 and Pyramid5 it does not free.
enum class Formulation { Standard, BBar };

/// \name Sizes of an element with its stiffness rule, fixed for the most frequent ones and at run time for all others
///@{
struct Hex8Shape {
  static constexpr int numNodes = 8, numPoints = 8, maxNodes = 8, maxPoints = 8;
};
struct Tet4Shape {
  static constexpr int numNodes = 4, numPoints = 1, maxNodes = 4, maxPoints = 1;
};
struct AnyShape {
  static constexpr int numNodes = Eigen::Dynamic, numPoints = Eigen::Dynamic, maxNodes = 27, maxPoints = 27;
};
///@}

/// \brief visit(Shape) with the sizes for a topology.
template <class Visit>
void withShape(Topology topology, const Visit& visit) {
  if (topology == Topology::Hex8) visit(Hex8Shape{});
  else if (topology == Topology::Tet4) visit(Tet4Shape{});
  else visit(AnyShape{});
}

template <class Shape>
inline constexpr int kDofs = Shape::numNodes == Eigen::Dynamic ? Eigen::Dynamic : 3 * Shape::numNodes;

/// \brief Entry `3 a + i` belongs to node a (Exodus order) and direction i.
template <class Shape>
using ElementVector = Eigen::Matrix<double, kDofs<Shape>, 1, Eigen::ColMajor, 3 * Shape::maxNodes, 1>;
template <class Shape>
using ElementStiffness = Eigen::Matrix<double, kDofs<Shape>, kDofs<Shape>, Eigen::ColMajor, 3 * Shape::maxNodes, 3 * Shape::maxNodes>;

/// \brief Shape function gradients of one element at its cubature points.
template <class Shape>
struct ElementGradients {
  /// column p, row 3 a + i: dN_a/dx_i
  Eigen::Matrix<double, kDofs<Shape>, Shape::numPoints, Eigen::ColMajor, 3 * Shape::maxNodes, Shape::maxPoints> at;
  Eigen::Matrix<double, Shape::numPoints, 1, Eigen::ColMajor, Shape::maxPoints, 1> volumes;  ///< w_p det J_p > 0
  /// [numPoints x modes] what BBar projects div u on, orthonormal with the weights `volumes`; left out for fixed sizes: a constant
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, AnyShape::maxPoints, 4> modes;
  /// BBar leaves div u as it is in a part of the stiffness, that of a material with this Poisson's ratio; -1: in none
  double unprojected = -1;

  int numNodes() const { return int(at.rows()) / 3; }
  int numPoints() const { return int(at.cols()); }
};

/// \brief Gradients of one element of `group`, whose topology has the sizes of `Shape`.
///
/// Coordinates enter relative to the element's first node, so that translated copies give the same
/// digits as far as the coordinates themselves do.
///
/// \throws InputError naming the element if a coordinate is not finite, or if the element is inverted,
///   folded or flat (det J <= 1e-12 times the product of the lengths of the columns of J) at a cubature
///   point, or if the node in the middle of an edge does not lie in the middle half of it (the edge would fold back).
template <class Shape>
ElementGradients<Shape> elementGradients(const Coordinates& coordinates, const ElementGroup& group,
                                         int element);

/// \brief Element stiffness, exactly symmetric: integral of B^T C B.
template <class Shape>
void elementStiffness(const ElementGradients<Shape>& gradients, const ElasticModuli& moduli,
                      Formulation formulation, ElementStiffness<Shape>& stiffness);

/// \brief Internal force K u by way of strain and stress at every point, without K.
template <class Shape>
ElementVector<Shape> elementForce(const ElementGradients<Shape>& gradients, const ElasticModuli& moduli,
                                  Formulation formulation, const ElementVector<Shape>& displacement);

/// \brief Stress components in the order xx, yy, zz, xy, yz, zx.
using Stress = std::array<double, 6>;

/// \brief elementGradients of every element of a group, for what it throws.
void checkElements(const Coordinates& coordinates, const ElementGroup& group);

/// \brief Stress of every element of a group [numElements], averaged over its volume.
///
/// The average is the same for both formulations; on parallelepipeds it is the stress at the centroid.
/// \param displacement [3 numNodes of the subdomain], node by node.
/// \throws InputError as `elementGradients` and `elasticModuli`.
std::vector<Stress> elementStresses(const Coordinates& coordinates, const ElementGroup& group,
                                    const IsotropicMaterial& material,
                                    const Eigen::Ref<const Eigen::VectorXd>& displacement);

/// \brief sqrt(3/2) || dev sigma ||.
double vonMises(const Stress& stress);

}  // namespace Haptos
