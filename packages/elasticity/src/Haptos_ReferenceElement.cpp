// SPDX-License-Identifier: BSD-3-Clause
// The only unit that includes Intrepid2 and Shards (they are slow to compile).
#include "Haptos_ReferenceElement.hpp"

#include <Intrepid2_DefaultCubatureFactory.hpp>
#include <Intrepid2_HGRAD_HEX_C1_FEM.hpp>
#include <Intrepid2_HGRAD_QUAD_C1_FEM.hpp>
#include <Intrepid2_HGRAD_TET_C1_FEM.hpp>
#include <Intrepid2_HGRAD_TRI_C1_FEM.hpp>
#include <Kokkos_Core.hpp>
#include <Teuchos_Assert.hpp>

namespace Haptos {
namespace {

using Device = Kokkos::HostSpace::execution_space;
using View = Kokkos::DynRankView<double, Device>;
using HexBasis = Intrepid2::Basis_HGRAD_HEX_C1_FEM<Device, double, double>;
using TetBasis = Intrepid2::Basis_HGRAD_TET_C1_FEM<Device, double, double>;
using QuadBasis = Intrepid2::Basis_HGRAD_QUAD_C1_FEM<Device, double, double>;
using TriBasis = Intrepid2::Basis_HGRAD_TRI_C1_FEM<Device, double, double>;

// Copies into Eigen arrays, so that no view outlives Kokkos::finalize.
template <class Basis>
ReferenceElement tabulate(int cubatureDegree) {
  TEUCHOS_TEST_FOR_EXCEPTION(!Kokkos::is_initialized(), std::logic_error,
                             "ReferenceElement: initialise Kokkos (Tpetra::ScopeGuard) before the first use");
  const Basis basis;
  const auto cell = basis.getBaseCellTopology();
  const auto cubature =
      Intrepid2::DefaultCubatureFactory::create<Device, double, double>(cell, cubatureDegree);
  const int dimension = int(cell.getDimension()), numPoints = cubature->getNumPoints();
  const int numNodes = int(basis.getCardinality());

  View points("points", numPoints, dimension), weights("weights", numPoints);
  View values("values", numNodes, numPoints), gradients("gradients", numNodes, numPoints, dimension);
  cubature->getCubature(points, weights);
  basis.getValues(values, points, Intrepid2::OPERATOR_VALUE);
  basis.getValues(gradients, points, Intrepid2::OPERATOR_GRAD);

  ReferenceElement table;
  table.points.resize(dimension, numPoints);
  table.weights.resize(numPoints);
  table.values.resize(numNodes, numPoints);
  table.gradients.resize(dimension * numNodes, numPoints);
  for (int p = 0; p < numPoints; ++p) {
    table.weights(p) = weights(p);
    for (int k = 0; k < dimension; ++k) table.points(k, p) = points(p, k);
    for (int a = 0; a < numNodes; ++a) {
      table.values(a, p) = values(a, p);
      for (int k = 0; k < dimension; ++k) table.gradients(dimension * a + k, p) = gradients(a, p, k);
    }
  }
  return table;
}

}  // namespace

const ReferenceElement& stiffnessRule(Topology topology) {
  static const ReferenceElement hex = tabulate<HexBasis>(3), tet = tabulate<TetBasis>(1);
  return topology == Topology::Hex8 ? hex : tet;
}

// A load that varies linearly, times N_a: one degree more than the stiffness of a TET4, whose gradients are constant.
const ReferenceElement& bodyLoadRule(Topology topology) {
  static const ReferenceElement hex = tabulate<HexBasis>(3), tet = tabulate<TetBasis>(2);
  return topology == Topology::Hex8 ? hex : tet;
}

// The same on sides.
const ReferenceElement& sideRule(Topology topology) {
  static const ReferenceElement quad = tabulate<QuadBasis>(3), tri = tabulate<TriBasis>(2);
  return topology == Topology::Hex8 ? quad : tri;
}

}  // namespace Haptos
