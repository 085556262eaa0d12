// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_LinearElasticity.hpp"
#include "Haptos_StiffnessAssembler.hpp"
#include "Haptos_SubdomainStiffness.hpp"

namespace Haptos {

/// \brief Stiffnesses assembled from elements.
///
/// Subdomains that are translated copies node by node share one assembly (`copyOf`).
class ElasticStiffness final : public SubdomainStiffness {
 public:
  /// \brief Nodes and elements of one subdomain; both must outlive this object.
  struct Piece {
    const Coordinates* coordinates;
    const std::vector<ElementGroup>* groups;
  };

  ElasticStiffness(std::vector<Piece> pieces, std::vector<IsotropicMaterial> materials, Formulation formulation);

  /// \brief Of anything that has `coordinates` and `groups`.
  template <class Subdomains>
  ElasticStiffness(const Subdomains& subdomains, std::vector<IsotropicMaterial> materials, Formulation formulation)
      : ElasticStiffness(piecesOf(subdomains), std::move(materials), formulation) {}

  int size() const override { return int(pieces_.size()); }
  const Coordinates& coordinates(int i) const override { return *pieces_[std::size_t(i)].coordinates; }
  /// \throws InputError on an inverted element.
  Eigen::SparseMatrix<double> assemble(int i) const override;
  Eigen::MatrixXd kernel(int i) const override;
  std::vector<int> surface(int i) const override;
  int copyOf(int i) const override { return copyOf_[std::size_t(i)]; }
  void multiply(int i, const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Ref<Eigen::VectorXd> Ku) const override;

 private:
  template <class Subdomains>
  static std::vector<Piece> piecesOf(const Subdomains& subdomains) {
    std::vector<Piece> pieces;
    for (const auto& sub : subdomains) pieces.push_back({&sub.coordinates, &sub.groups});
    return pieces;
  }

  std::vector<Piece> pieces_;
  std::vector<IsotropicMaterial> materials_;
  Formulation formulation_;
  std::vector<int> copyOf_;
};

}  // namespace Haptos
