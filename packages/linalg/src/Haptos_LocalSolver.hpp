// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCore>
#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "Haptos_LocalSolverFactor.hpp"

namespace Haptos {

/// \brief The action of K^+ for one subdomain's stiffness K, symmetric positive semidefinite with kernel R.
///
///   K^+ = (I - R R^T) K_reg^-1 (I - R R^T),   K_reg = K + N (R_f^T N)^-1 N^T
///
/// the Moore-Penrose inverse up to round-off; R_f is R on a few fixing nodes and N = W R_f, W the diagonal of
/// K (Haptos_FixingNodes.hpp).
/// K is factored once, at construction; congruent subdomains may share one solver.  Nothing communicates.
///
/// Source: Brzobohaty, Dostal, Kozubek, Kovar, Markopoulos, Int. J. Numer. Meth. Engng. 88 (2011) 493.
class LocalSolver {
 public:
  /// \param K           n x n [N/m in any consistent units], n = 3 x nodes, node-major xyz, both triangles stored.
  /// \param kernel      R, n x k, orthonormal columns; 6 for every piece of the subdomain, k = 0 if K is definite.
  /// \param coordinates one per node, in any unit of length.
  /// \throws InputError if CHOLMOD is asked for and not built in.
  /// \throws std::runtime_error if K R is not zero, or if K has a zero-energy motion outside R.
  LocalSolver(const Eigen::SparseMatrix<double>& K, const Eigen::MatrixXd& kernel,
              const std::vector<std::array<double, 3>>& coordinates,
              LocalSolverMethod method = LocalSolverMethod::Automatic);
  /// \brief With a kernel that others keep, too.
  LocalSolver(const Eigen::SparseMatrix<double>& K, std::shared_ptr<const Eigen::MatrixXd> kernel,
              const std::vector<std::array<double, 3>>& coordinates, LocalSolverMethod method = LocalSolverMethod::Automatic);
  ~LocalSolver();
  LocalSolver(LocalSolver&&) noexcept;

  /// \brief X := K^+ B, both n x m; one call for many columns is far cheaper than many calls.
  ///
  /// \param refinements steps of Y += K_reg^-1 (B - K_reg Y), for the last digits; seldom of use with CHOLMOD.
  /// B and X must not overlap.  May be called from several threads; they then wait for each other.
  void solve(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X, int refinements = 0) const;

  /// \brief Frees K_reg; `regularized` and refinements are not to be had after it.
  void releaseMatrix() { factor_.releaseMatrix(); }

  const Eigen::MatrixXd& kernel() const;         ///< R, n x k
  const std::vector<int>& fixingNodes() const;   ///< local node numbers, ascending
  LocalSolverFactor::MatrixView regularized() const;  ///< K_reg, valid as long as this object
  const char* methodName() const;                ///< "CHOLMOD" or "KLU2"
  std::size_t factorEntries() const;             ///< of L for CHOLMOD, of L and U for KLU2
  FactorWork work() const { return factor_.work(); }  ///< bytes: of one block of right-hand sides
  LocalSolverFactor::Counts counts() const;      ///< phases run, one solve counted by the construction's check

 private:
  void solveBlock(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X, int refinements) const;
  void removeKernel(Eigen::Ref<Eigen::MatrixXd> X) const;
  void checkKernel(const Eigen::SparseMatrix<double>& K) const;
  void checkAccuracy() const;

  std::shared_ptr<const Eigen::MatrixXd> kernel_;
  std::vector<int> fixingNodes_;
  LocalSolverFactor factor_;
};

}  // namespace Haptos
