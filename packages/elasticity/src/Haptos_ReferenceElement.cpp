// SPDX-License-Identifier: BSD-3-Clause
// The only unit that includes Intrepid2 and Shards (they are slow to compile).
#include "Haptos_ReferenceElement.hpp"

#include <Intrepid2_DefaultCubatureFactory.hpp>
#include <Intrepid2_HGRAD_HEX_C1_FEM.hpp>
#include <Intrepid2_HGRAD_HEX_C2_FEM.hpp>
#include <Intrepid2_HGRAD_PYR_C1_FEM.hpp>
#include <Intrepid2_HGRAD_QUAD_C1_FEM.hpp>
#include <Intrepid2_HGRAD_QUAD_C2_FEM.hpp>
#include <Intrepid2_HGRAD_TET_C1_FEM.hpp>
#include <Intrepid2_HGRAD_TET_C2_FEM.hpp>
#include <Intrepid2_HGRAD_TRI_C1_FEM.hpp>
#include <Intrepid2_HGRAD_TRI_C2_FEM.hpp>
#include <Intrepid2_HGRAD_WEDGE_C1_FEM.hpp>
#include <Intrepid2_HGRAD_WEDGE_C2_FEM.hpp>
#include <Kokkos_Core.hpp>
#include <Teuchos_Assert.hpp>
#include <array>
#include <vector>

namespace Haptos {
namespace {

using Device = Kokkos::HostSpace::device_type;
using View = Kokkos::DynRankView<double, Device>;
using Hex8Basis = Intrepid2::Basis_HGRAD_HEX_C1_FEM<Device, double, double>;
using Hex27Basis = Intrepid2::Basis_HGRAD_HEX_C2_FEM<Device, double, double>;
using Tet4Basis = Intrepid2::Basis_HGRAD_TET_C1_FEM<Device, double, double>;
using Tet10Basis = Intrepid2::Basis_HGRAD_TET_C2_FEM<Device, double, double>;
using Wedge6Basis = Intrepid2::Basis_HGRAD_WEDGE_C1_FEM<Device, double, double>;
using Wedge18Basis = Intrepid2::Basis_HGRAD_WEDGE_C2_FEM<Device, double, double>;
using Pyramid5Basis = Intrepid2::Basis_HGRAD_PYR_C1_FEM<Device, double, double>;
using Quad4Basis = Intrepid2::Basis_HGRAD_QUAD_C1_FEM<Device, double, double>;
using Quad9Basis = Intrepid2::Basis_HGRAD_QUAD_C2_FEM<Device, double, double>;
using Triangle3Basis = Intrepid2::Basis_HGRAD_TRI_C1_FEM<Device, double, double>;
using Triangle6Basis = Intrepid2::Basis_HGRAD_TRI_C2_FEM<Device, double, double>;

shards::CellTopology cellOf(int numCorners, int dimension) {
  if (dimension == 2 && numCorners == 3) return shards::getCellTopologyData<shards::Triangle<3>>();
  if (dimension == 2) return shards::getCellTopologyData<shards::Quadrilateral<4>>();
  switch (numCorners) {
    case 4: return shards::getCellTopologyData<shards::Tetrahedron<4>>();
    case 5: return shards::getCellTopologyData<shards::Pyramid<5>>();
    case 6: return shards::getCellTopologyData<shards::Wedge<6>>();
    default: return shards::getCellTopologyData<shards::Hexahedron<8>>();
  }
}

// Points and weights alone.
ReferenceElement cubature(int numCorners, int dimension, int degree) {
  TEUCHOS_TEST_FOR_EXCEPTION(!Kokkos::is_initialized(), std::logic_error,
                             "ReferenceElement: initialise Kokkos (Tpetra::ScopeGuard) before the first use");
  const auto rule = Intrepid2::DefaultCubatureFactory::create<Device, double, double>(cellOf(numCorners, dimension), degree);
  const int numPoints = rule->getNumPoints();
  View points("points", numPoints, dimension), weights("weights", numPoints);
  rule->getCubature(points, weights);
  ReferenceElement table;
  table.points.resize(dimension, numPoints);
  table.weights.resize(numPoints);
  for (int p = 0; p < numPoints; ++p) {
    table.weights(p) = weights(p);
    for (int k = 0; k < dimension; ++k) table.points(k, p) = points(p, k);
  }
  return table;
}

// Copies into Eigen arrays, so that no view outlives Kokkos::finalize.
template <class Basis>
ReferenceElement tabulate(ReferenceElement table) {
  const Basis basis;
  const int dimension = table.dimension(), numPoints = table.numPoints(), numNodes = int(basis.getCardinality());
  View points("points", numPoints, dimension);
  View values("values", numNodes, numPoints), gradients("gradients", numNodes, numPoints, dimension);
  for (int p = 0; p < numPoints; ++p)
    for (int k = 0; k < dimension; ++k) points(p, k) = table.points(k, p);
  basis.getValues(values, points, Intrepid2::OPERATOR_VALUE);
  basis.getValues(gradients, points, Intrepid2::OPERATOR_GRAD);
  table.values.resize(numNodes, numPoints);
  table.gradients.resize(dimension * numNodes, numPoints);
  for (int p = 0; p < numPoints; ++p)
    for (int a = 0; a < numNodes; ++a) {
      table.values(a, p) = values(a, p);
      for (int k = 0; k < dimension; ++k) table.gradients(dimension * a + k, p) = gradients(a, p, k);
    }
  return table;
}

/// A centre node that a serendipity element leaves out: there its functions take the value `corner` at the corners around, `mid` at
/// the middles of the edges.
struct Centre {
  double corner, mid;
  std::vector<int> corners, mids;
};

// N_a of the smaller space = N_a of the complete one + sum over centres c of N_a(c) N_c: the smaller space lies in the complete one.
ReferenceElement withoutCentres(const ReferenceElement& complete, const std::vector<Centre>& centres) {
  const int n = complete.numNodes() - int(centres.size()), dimension = complete.dimension();
  ReferenceElement result{complete.points, complete.weights, complete.values.topRows(n), complete.gradients.topRows(dimension * n)};
  for (int c = 0; c < int(centres.size()); ++c) {
    const auto add = [&](const std::vector<int>& nodes, double value) {
      for (int a : nodes) {
        result.values.row(a) += value * complete.values.row(n + c);
        result.gradients.middleRows(dimension * a, dimension) += value * complete.gradients.middleRows(dimension * (n + c), dimension);
      }
    };
    add(centres[std::size_t(c)].corners, centres[std::size_t(c)].corner);
    add(centres[std::size_t(c)].mids, centres[std::size_t(c)].mid);
  }
  return result;
}

Centre centreOf(const SideNodes& side) { return {-0.25, 0.5, {side.begin(), side.begin() + 4}, {side.begin() + 4, side.begin() + 8}}; }

// Nodes 20 .. 26 of HEX27: its centre, then those of the sides in an order of their own.
ReferenceElement tabulateHex20(ReferenceElement table) {
  std::vector<Centre> centres(7, {-0.25, 0.25, {0, 1, 2, 3, 4, 5, 6, 7}, {8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19}});
  for (int side = 0; side < 6; ++side) {
    const SideNodes& nodes = sideNodes(Topology::Hex27, side);
    centres[std::size_t(nodes[8] - 20)] = centreOf(nodes);
  }
  return withoutCentres(tabulate<Hex27Basis>(std::move(table)), centres);
}

// Nodes 15 .. 17 of WEDGE18: the centres of its first three sides.
ReferenceElement tabulateWedge15(ReferenceElement table) {
  std::vector<Centre> centres;
  for (int side = 0; side < 3; ++side) centres.push_back(centreOf(sideNodes(Topology::Wedge15, side)));
  return withoutCentres(tabulate<Wedge18Basis>(std::move(table)), centres);
}

/// A function of PYRAMID13: that of PYRAMID5 at node `linear` times the affine function constant + slope . xi.
struct PyramidProduct {
  int linear;
  double constant;
  std::array<double, 3> slope;
};

constexpr std::array<PyramidProduct, 13> pyramidProducts{{{0, -1, {-1, -1, 0}},
                                                          {1, -1, {1, -1, 0}},
                                                          {2, -1, {1, 1, 0}},
                                                          {3, -1, {-1, 1, 0}},
                                                          {4, -1, {0, 0, 2}},
                                                          {0, 2, {2, 0, -2}},
                                                          {1, 2, {0, 2, -2}},
                                                          {2, 2, {-2, 0, -2}},
                                                          {3, 2, {0, -2, -2}},
                                                          {0, 0, {0, 0, 4}},
                                                          {1, 0, {0, 0, 4}},
                                                          {2, 0, {0, 0, 4}},
                                                          {3, 0, {0, 0, 4}}}};

ReferenceElement tabulatePyramid13(ReferenceElement table) {
  const ReferenceElement linear = tabulate<Pyramid5Basis>(table);
  table.values.resize(13, linear.numPoints());
  table.gradients.resize(39, linear.numPoints());
  for (int p = 0; p < linear.numPoints(); ++p)
    for (int a = 0; a < 13; ++a) {
      const PyramidProduct& product = pyramidProducts[std::size_t(a)];
      const Eigen::Vector3d slope(product.slope.data());
      const double factor = product.constant + slope.dot(linear.points.col(p)), value = linear.values(product.linear, p);
      table.values(a, p) = value * factor;
      table.gradients.block<3, 1>(3 * a, p) = factor * linear.gradients.block<3, 1>(3 * product.linear, p) + value * slope;
    }
  return table;
}

// The functions at the points that are there.
ReferenceElement withFunctions(Topology topology, ReferenceElement table) {
  switch (topology) {
    case Topology::Hex8: return tabulate<Hex8Basis>(std::move(table));
    case Topology::Tet4: return tabulate<Tet4Basis>(std::move(table));
    case Topology::Hex20: return tabulateHex20(std::move(table));
    case Topology::Hex27: return tabulate<Hex27Basis>(std::move(table));
    case Topology::Tet10: return tabulate<Tet10Basis>(std::move(table));
    case Topology::Wedge6: return tabulate<Wedge6Basis>(std::move(table));
    case Topology::Wedge15: return tabulateWedge15(std::move(table));
    case Topology::Pyramid5: return tabulate<Pyramid5Basis>(std::move(table));
    case Topology::Pyramid13: break;
  }
  return tabulatePyramid13(std::move(table));
}

ReferenceElement withFunctions(SideShape shape, ReferenceElement table) {
  switch (shape) {
    case SideShape::Triangle3: return tabulate<Triangle3Basis>(std::move(table));
    case SideShape::Triangle6: return tabulate<Triangle6Basis>(std::move(table));
    case SideShape::Quad4: return tabulate<Quad4Basis>(std::move(table));
    case SideShape::Quad9: return tabulate<Quad9Basis>(std::move(table));
    case SideShape::Quad8: break;
  }
  return withoutCentres(tabulate<Quad9Basis>(std::move(table)), {{-0.25, 0.5, {0, 1, 2, 3}, {4, 5, 6, 7}}});
}

ReferenceElement elementRule(Topology topology, int degree) {
  return withFunctions(topology, cubature(elementShape(topology).numCorners, 3, degree));
}

}  // namespace

ReferenceElement shapeFunctionsAt(Topology topology, const Eigen::Matrix3Xd& points) {
  return withFunctions(topology, {points, {}, {}, {}});
}

// Twice the degree of the gradients in every direction, counted for pyramids in the cube that is collapsed to them.  TET10: its four
// points of degree 2 see 24 strains, of which BBar takes three; degrees 3 and 4 have negative weights.
const ReferenceElement& stiffnessRule(Topology topology) {
  static const auto rules = [] {
    constexpr std::array<int, kNumTopologies> degrees{3, 1, 5, 5, 5, 2, 4, 3, 5};
    std::vector<ReferenceElement> all;
    for (int t = 0; t < kNumTopologies; ++t) all.push_back(elementRule(Topology(t), degrees[std::size_t(t)]));
    return all;
  }();
  return rules[std::size_t(topology)];
}

// A load that varies linearly, times N_a: one degree more than the stiffness of a TET4, whose gradients are constant.
const ReferenceElement& bodyLoadRule(Topology topology) {
  static const auto tet4 = elementRule(Topology::Tet4, 2);
  return topology == Topology::Tet4 ? tet4 : stiffnessRule(topology);
}

// The same on sides; in the order of `SideShape`.
const ReferenceElement& sideRule(SideShape shape) {
  static const std::array<ReferenceElement, 5> rules{
      withFunctions(SideShape::Triangle3, cubature(3, 2, 2)), withFunctions(SideShape::Triangle6, cubature(3, 2, 4)),
      withFunctions(SideShape::Quad4, cubature(4, 2, 3)), withFunctions(SideShape::Quad8, cubature(4, 2, 5)),
      withFunctions(SideShape::Quad9, cubature(4, 2, 5))};
  return rules[std::size_t(shape)];
}

}  // namespace Haptos
