// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

#include "Haptos_Mesh.hpp"

namespace Haptos {

/// \brief Shape functions N_a of a reference cell, tabulated at the points of one cubature rule.
///
/// Nodes are in Exodus order, which is Intrepid2's, too.  The tables come from Intrepid2's bases and cubature.  The serendipity
/// functions of HEX20, WEDGE15 and QUAD8, which Intrepid2 13.2 lacks, are combinations of those of HEX27, WEDGE18 and QUAD9; those
/// of PYRAMID13 are products of the linear ones with affine functions (G. Bedrosian, Int. J. Numer. Meth. Engng 35 (1992) 95).
/// Reference cells: [-1, 1]^3; the unit tetrahedron; unit triangle x [-1, 1]; base [-1, 1]^2 with its apex at (0, 0, 1).
struct ReferenceElement {
  Eigen::MatrixXd points;     ///< [dimension x numPoints], reference coordinates xi
  Eigen::VectorXd weights;    ///< [numPoints], they sum to the volume of the reference cell
  Eigen::MatrixXd values;     ///< [numNodes x numPoints], N_a(xi_p)
  Eigen::MatrixXd gradients;  ///< [dimension numNodes x numPoints], row `dimension a + k`: dN_a/dxi_k

  int dimension() const { return int(points.rows()); }
  int numPoints() const { return int(points.cols()); }
  int numNodes() const { return int(values.rows()); }
};

/// \brief The functions at points of the reference cell, without weights.
ReferenceElement shapeFunctionsAt(Topology topology, const Eigen::Matrix3Xd& points);

/// \brief Rule for the stiffness, exact on affine elements; all its weights are positive.
///
/// HEX8 2x2x2 Gauss, TET4 one point, TET10 14, WEDGE6 six, PYRAMID5 2x2x2, HEX20, HEX27 and PYRAMID13 3x3x3, WEDGE15 18.
/// This and the rules below are computed at the first call, which needs Kokkos to be initialised.
const ReferenceElement& stiffnessRule(Topology topology);

/// \brief Rule for loads in the volume, exact for linear loads on affine elements.
const ReferenceElement& bodyLoadRule(Topology topology);

/// \brief Rule on sides, exact for linear loads on flat parallelograms and straight triangles, and for uniform pressure on
/// curved sides.  Nodes as `SideNodes` list them.
const ReferenceElement& sideRule(SideShape shape);

}  // namespace Haptos
