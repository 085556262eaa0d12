// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

#include "Haptos_Mesh.hpp"

namespace Haptos {

/// \brief Shape functions N_a of a reference cell, tabulated at the points of one cubature rule.
///
/// Nodes are in Exodus order.  The tables come from Intrepid2's bases and cubature; a new element adds
/// one line to the tables in the .cpp (and a permutation where Intrepid2's node order differs from Exodus').
struct ReferenceElement {
  Eigen::MatrixXd points;     ///< [dimension x numPoints], reference coordinates xi
  Eigen::VectorXd weights;    ///< [numPoints], they sum to the volume of the reference cell
  Eigen::MatrixXd values;     ///< [numNodes x numPoints], N_a(xi_p)
  Eigen::MatrixXd gradients;  ///< [dimension numNodes x numPoints], row `dimension a + k`: dN_a/dxi_k

  int dimension() const { return int(points.rows()); }
  int numPoints() const { return int(points.cols()); }
  int numNodes() const { return int(values.rows()); }
};

/// \brief Rule for the stiffness: Hex8 2x2x2 Gauss, Tet4 one point.
///
/// This and the rules below are computed at the first call, which needs Kokkos to be initialised.
const ReferenceElement& stiffnessRule(Topology topology);

/// \brief Rule for loads in the volume, exact for linear loads on affine elements: Hex8 2x2x2, Tet4 four
/// points.
const ReferenceElement& bodyLoadRule(Topology topology);

/// \brief Rule on the sides of an element, exact for linear loads on flat parallelograms and triangles:
/// quadrilateral 2x2 Gauss, triangle three points.  Nodes as `sideNodes(topology, side)` lists them.
const ReferenceElement& sideRule(Topology topology);

}  // namespace Haptos
