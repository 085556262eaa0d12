// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "Haptos_LinearElasticity.hpp"
#include "Haptos_LocalSolver.hpp"
#include "Haptos_Subdomain.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief K and R of one subdomain; dof = 3 x local node + component.
struct LocalSystem {
  Eigen::SparseMatrix<double> K;  ///< [n x n], both triangles
  Eigen::MatrixXd R;              ///< [n x 6], orthonormal columns, K R = 0
  int congruenceClass = 0;        ///< local to the rank; members share K, R and the factor
};

/// \brief Stiffnesses, kernels and factors of this rank's subdomains.
///
/// Subdomains whose K, up to 1e-12 of its largest entry, and local numbering agree are congruent: they share one
/// factor and are solved together, many right-hand sides at once.  Nothing here communicates.
class LocalSystems {
 public:
  LocalSystems() = default;

  /// \brief Assembles K and R of every subdomain.  \throws InputError on an inverted element.
  void assemble(const std::vector<Subdomain>& subdomains, const std::vector<IsotropicMaterial>& materials,
                Formulation formulation);

  /// \brief Finds congruent subdomains; part of `factor`, enough where only K is wanted.
  void findClasses();

  /// \brief Finds congruent subdomains and factors one of each class.
  void factor(const std::vector<Subdomain>& subdomains, LocalSolverMethod method);

  int size() const { return int(systems_.size()); }
  int numClasses() const { return int(representative_.size()); }
  const LocalSystem& operator[](int i) const { return systems_[i]; }
  const LocalSolver& solver(int i) const { return *solvers_[systems_[i].congruenceClass]; }
  const std::vector<std::vector<int>>& members() const { return members_; }  ///< [classes] local subdomains

  /// \brief U := K^+ F for vectors on the primal map; `offsets` [size + 1] locates the subdomains.
  void applyPseudoInverse(const std::vector<std::size_t>& offsets, const MultiVector& f, MultiVector& u) const;

  /// \brief Vectors that went through a K^+ so far.
  long localSolves() const { return localSolves_; }

 private:
  std::vector<LocalSystem> systems_;
  std::vector<int> representative_;         // [classes] local subdomain
  std::vector<std::vector<int>> members_;   // [classes]
  std::vector<std::unique_ptr<LocalSolver>> solvers_;  // [classes]
  mutable long localSolves_ = 0;
};

}  // namespace Haptos
