// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ElasticStiffness.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "Haptos_RigidBodyModes.hpp"
#include "Haptos_SubdomainSurface.hpp"

namespace Haptos {
namespace {

using Piece = ElasticStiffness::Piece;

std::vector<std::size_t> sizesOf(const Piece& piece) {
  std::vector<std::size_t> sizes{piece.coordinates->size()};
  for (const auto& group : *piece.groups) sizes.push_back(group.connectivity.size());
  return sizes;
}

bool haveSameElements(const std::vector<ElementGroup>& a, const std::vector<ElementGroup>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const ElementGroup& x, const ElementGroup& y) {
    return x.topology == y.topology && x.material == y.material && x.connectivity == y.connectivity;
  });
}

// Same elements, same materials, nodes moved by one vector: K is the same to round-off.  The bound leaves K within 1e-12 of
// its largest entry while an edge is not below 1/50 of the subdomain.
bool isTranslatedCopy(const Piece& a, const Piece& b) {
  constexpr double kSamePlace = 0.02 * 1e-12;  // of the subdomain's extent
  const Coordinates &p = *a.coordinates, &q = *b.coordinates;
  if (p.size() != q.size() || !haveSameElements(*a.groups, *b.groups)) return false;
  double extent = 0, difference = 0;
  for (std::size_t i = 1; i < p.size(); ++i)
    for (std::size_t d = 0; d < 3; ++d) {
      const double x = p[i][d] - p[0][d], y = q[i][d] - q[0][d];
      extent = std::max(extent, std::abs(x));
      if (!(std::abs(x - y) <= difference)) difference = std::abs(x - y);  // keeps a NaN
    }
  return difference <= kSamePlace * extent;
}

}  // namespace

ElasticStiffness::ElasticStiffness(std::vector<Piece> pieces, std::vector<IsotropicMaterial> materials, Formulation formulation)
    : pieces_(std::move(pieces)), materials_(std::move(materials)), formulation_(formulation), copyOf_(pieces_.size(), -1) {
  std::map<std::vector<std::size_t>, std::vector<int>> bySize;  // cheap hash: nodes, elements of the groups
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    auto& candidates = bySize[sizesOf(pieces_[i])];
    const auto found = std::find_if(candidates.begin(), candidates.end(),
                                    [&](int c) { return isTranslatedCopy(pieces_[std::size_t(c)], pieces_[i]); });
    if (found != candidates.end()) copyOf_[i] = *found;
    else candidates.push_back(int(i));
  }
}

Eigen::SparseMatrix<double> ElasticStiffness::assemble(int i) const {
  return assembleStiffness(coordinates(i), *pieces_[std::size_t(i)].groups, materials_, formulation_);
}

Eigen::MatrixXd ElasticStiffness::kernel(int i) const { return rigidBodyModes(coordinates(i), {}); }

std::vector<int> ElasticStiffness::surface(int i) const {
  return surfaceDofs(*pieces_[std::size_t(i)].groups, int(coordinates(i).size()));
}

void ElasticStiffness::multiply(int i, const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Ref<Eigen::VectorXd> Ku) const {
  applyStiffness(coordinates(i), *pieces_[std::size_t(i)].groups, materials_, formulation_, u, Ku);
}

}  // namespace Haptos
