// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "Haptos_Vec3.hpp"

namespace Haptos {

/// \brief Where the stiffnesses of this rank's subdomains come from: elements, or somebody's own matrices.
///
/// K is symmetric and positive semidefinite, [3 nodes x 3 nodes], row 3 x local node + component, of the subdomain by itself:
/// nothing held, nothing added from neighbours.  Indices are local to the rank.  Nothing here communicates.
class SubdomainStiffness {
 public:
  virtual ~SubdomainStiffness() = default;

  virtual int size() const = 0;
  virtual const Coordinates& coordinates(int i) const = 0;

  /// \brief K with both triangles; asked for once or again, and let go as soon as it is factored.
  virtual Eigen::SparseMatrix<double> assemble(int i) const = 0;

  /// \brief R [n x k] with orthonormal columns, K R = 0 and nothing else without energy; k >= 1.
  virtual Eigen::MatrixXd kernel(int i) const = 0;

  /// \brief Unknowns on the surface, ascending: those of the Dirichlet preconditioner where rows of B alone do not hold the subdomain.
  virtual std::vector<int> surface(int i) const = 0;

  /// \brief An earlier subdomain that has the same K and R, as far as that is known without them; -1: none.
  virtual int copyOf(int) const { return -1; }

  /// \brief Whether `multiply` reads a matrix that is kept anyway: to assemble another saves nothing.
  virtual bool isAssembled() const { return false; }

  /// \brief Ku += K u, not from the factor: what the check of an answer is made by.
  virtual void multiply(int i, const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Ref<Eigen::VectorXd> Ku) const = 0;
};

}  // namespace Haptos
