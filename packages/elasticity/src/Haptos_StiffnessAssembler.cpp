// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_StiffnessAssembler.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <limits>

#include "Haptos_ElementShape.hpp"
#include "Haptos_InputCheck.hpp"
#include "Haptos_NodeNeighbours.hpp"

namespace Haptos {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

// K = 0 with the pattern of full 3 x 3 blocks.
SparseMatrix blockPattern(int numNodes, const IndexLists& neighbours) {
  const std::int64_t numEntries = 9 * std::int64_t(neighbours.items.size());
  HAPTOS_REFUSE_IF(numEntries > std::numeric_limits<int>::max(),
                   "A subdomain of " << numNodes << " nodes has " << numEntries
                                     << " stiffness entries, more than 32-bit indices can count; "
                                        "use more subdomains");
  SparseMatrix k(3 * numNodes, 3 * numNodes);
  k.resizeNonZeros(numEntries);
  std::fill_n(k.valuePtr(), numEntries, 0.0);
  int* outer = k.outerIndexPtr();
  int* inner = k.innerIndexPtr();
  *outer = 0;
  for (int node = 0; node < numNodes; ++node)
    for (int j = 0; j < 3; ++j, ++outer) {
      for (const int* row = neighbours.begin(node); row != neighbours.end(node); ++row)
        for (int i = 0; i < 3; ++i) *inner++ = 3 * *row + i;
      outer[1] = outer[0] + 3 * neighbours.size(node);
    }
  return k;
}

// K_ab += k_ab, 3 x 3 blocks: the three rows of a node lie side by side in each of three columns, so one search a block is enough.
template <class Shape>
void scatter(const ElementStiffness<Shape>& element, const int* nodes, const IndexLists& neighbours,
             SparseMatrix& k) {
  const int numNodes = int(element.rows()) / 3;
  for (int b = 0; b < numNodes; ++b) {
    const int* first = neighbours.begin(nodes[b]);
    const int* last = neighbours.end(nodes[b]);
    double* column = k.valuePtr() + k.outerIndexPtr()[3 * nodes[b]];
    const std::ptrdiff_t stride = 3 * (last - first);
    for (int a = 0; a < numNodes; ++a) {
      double* entry = column + 3 * (std::lower_bound(first, last, nodes[a]) - first);
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) entry[j * stride + i] += element(3 * a + i, 3 * b + j);
    }
  }
}

template <class Shape>
void addGroup(const Coordinates& coordinates, const ElementGroup& group, const ElasticModuli& moduli,
              Formulation formulation, const IndexLists& neighbours, SparseMatrix& k) {
  ElementStiffness<Shape> element;
  for (int e = 0; e < group.numElements(); ++e) {
    elementStiffness<Shape>(elementGradients<Shape>(coordinates, group, e), moduli, formulation, element);
    scatter<Shape>(element, group.nodes(e), neighbours, k);
  }
}

// K u element by element by way of stresses: it shares nothing with the assembled K but the gradients.  Where nothing moves there
// is nothing to do: corrections of an answer live near the surfaces of subdomains.
template <class Shape>
void applyGroup(const Coordinates& coordinates, const ElementGroup& group, const ElasticModuli& moduli,
                Formulation formulation, const Eigen::Ref<const Eigen::VectorXd>& u,
                Eigen::Ref<Eigen::VectorXd> Ku) {
  const int n = nodesPerElement(group.topology);
  ElementVector<Shape> local(3 * n);
  for (int e = 0; e < group.numElements(); ++e) {
    const int* nodes = group.nodes(e);
    for (int a = 0; a < n; ++a) local.template segment<3>(3 * a) = u.segment<3>(3 * nodes[a]);
    if ((local.array() == 0).all()) continue;
    const auto force =
        elementForce<Shape>(elementGradients<Shape>(coordinates, group, e), moduli, formulation, local);
    for (int a = 0; a < n; ++a) Ku.segment<3>(3 * nodes[a]) += force.template segment<3>(3 * a);
  }
}

ElasticModuli moduliOf(const ElementGroup& group, const std::vector<IsotropicMaterial>& materials) {
  TEUCHOS_ASSERT(group.material >= 0 && std::size_t(group.material) < materials.size());
  return elasticModuli(materials[std::size_t(group.material)]);
}

// The mean square of its corners' distances is 3 times that of all its points in a box, 5 times in a tetrahedron.
void addElement(const Coordinates& coordinates, const ElementGroup& group, int element, double volume, PartVolume& part) {
  const int corners = elementShape(group.topology).numCorners;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  const auto corner = [&](int a) { return Eigen::Map<const Eigen::Vector3d>(coordinates[std::size_t(group.nodes(element)[a])].data()); };
  for (int a = 0; a < corners; ++a) mean += corner(a) / corners;
  for (int a = 0; a < corners; ++a) squares += (corner(a) - mean) * (corner(a) - mean).transpose() / corners;
  part.volume += volume;
  part.first += volume * mean;
  part.second += volume * (mean * mean.transpose() + squares / (corners == 4 ? 5 : 3));
}

}  // namespace

// The pattern once, full 3 x 3 blocks between nodes of an element, then the values in place: no triplets, no sorting.
SparseMatrix assembleStiffness(const Coordinates& coordinates, const std::vector<ElementGroup>& groups,
                               const std::vector<IsotropicMaterial>& materials, Formulation formulation) {
  TEUCHOS_ASSERT(coordinates.size() < std::size_t(std::numeric_limits<int>::max() / 3));
  const auto numNodes = int(coordinates.size());
  const auto neighbours = nodeNeighbours(numNodes, groups);
  auto k = blockPattern(numNodes, neighbours);
  for (const auto& group : groups) {
    const auto moduli = moduliOf(group, materials);
    withShape(group.topology, [&](auto shape) { addGroup<decltype(shape)>(coordinates, group, moduli, formulation, neighbours, k); });
  }
  return k;
}

void applyStiffness(const Coordinates& coordinates, const std::vector<ElementGroup>& groups,
                    const std::vector<IsotropicMaterial>& materials, Formulation formulation,
                    const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Ref<Eigen::VectorXd> Ku) {
  const auto n = 3 * Eigen::Index(coordinates.size());
  TEUCHOS_ASSERT(u.size() == n && Ku.size() == n);
  Ku.setZero();
  for (const auto& group : groups) {
    const auto moduli = moduliOf(group, materials);
    withShape(group.topology, [&](auto shape) { applyGroup<decltype(shape)>(coordinates, group, moduli, formulation, u, Ku); });
  }
}

std::vector<double> nodalStiffness(const Coordinates& coordinates, const std::vector<ElementGroup>& groups,
                                   const std::vector<double>& youngsModulus, PartVolume* volume) {
  std::vector<double> weights(coordinates.size(), 0.0);
  for (const auto& group : groups)
    withShape(group.topology, [&](auto shape) {
      for (int e = 0; e < group.numElements(); ++e) {
        const auto gradients = elementGradients<decltype(shape)>(coordinates, group, e);
        if (volume) addElement(coordinates, group, e, gradients.volumes.sum(), *volume);
        const Eigen::VectorXd squares = gradients.at.cwiseAbs2() * gradients.volumes * youngsModulus[std::size_t(group.material)];
        for (int a = 0; a < gradients.numNodes(); ++a) weights[std::size_t(group.nodes(e)[a])] += squares.segment<3>(3 * a).sum();
      }
    });
  return weights;
}

}  // namespace Haptos
