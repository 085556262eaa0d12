// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "Haptos_IndexLists.hpp"
#include "Haptos_SubdomainStiffness.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief What is wrong with a matrix of so many nodes as it stands on its rank, for "The stiffness ... "; empty where nothing is.
std::string problemOfMatrix(const RCP<const CrsMatrix>& K, std::size_t numNodes);

/// \brief Stiffnesses that a caller made: matrices of subdomains, shared and not copied.
class OwnStiffness final : public SubdomainStiffness {
 public:
  struct Part {
    std::string name;  ///< for messages
    Coordinates coordinates;
    RCP<const CrsMatrix> K;  ///< [3 nodes], on one rank; its values may change between factorisations
    Eigen::MatrixXd kernel;  ///< [3 nodes x k], or empty: found among the rigid motions
  };

  /// \throws InputError for a matrix of another size, one that is not symmetric or not finite, one without a motion that
  /// costs no energy, or a kernel that K does not have.
  explicit OwnStiffness(std::vector<Part> parts);

  int size() const override { return int(parts_.size()); }
  const Coordinates& coordinates(int i) const override { return part(i).coordinates; }
  Eigen::SparseMatrix<double> assemble(int i) const override;
  Eigen::MatrixXd kernel(int i) const override { return kernels_[std::size_t(i)]; }
  std::vector<int> surface(int) const override { return {}; }  ///< what rows of B touch is all that is known
  bool isAssembled() const override { return true; }
  void multiply(int i, const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Ref<Eigen::VectorXd> Ku) const override;

  double aspect(int i) const { return aspects_[std::size_t(i)]; }  ///< see `aspectOfPart`
  IndexLists neighbours(int i) const;  ///< nodes that K couples a node with, itself included

  /// \brief Means of the diagonal at every node [nodes]: what the subdomain holds a node with.
  std::vector<double> nodalStiffness(int i) const;

 private:
  void look(int i, const Eigen::Ref<const Eigen::SparseMatrix<double>>& K);
  const Part& part(int i) const { return parts_[std::size_t(i)]; }

  std::vector<Part> parts_;
  std::vector<Eigen::MatrixXd> kernels_;
  std::vector<double> aspects_;
};

/// \brief Orthonormal basis of the rigid motions that cost no energy, measured against diag K; none: no columns.
Eigen::MatrixXd rigidKernel(const Eigen::Ref<const Eigen::SparseMatrix<double>>& K, const Coordinates& coordinates);

}  // namespace Haptos
