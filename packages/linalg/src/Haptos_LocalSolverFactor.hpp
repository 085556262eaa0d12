// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/SparseCore>
#include <cstddef>
#include <memory>
#include <stdexcept>

#include "Haptos_Options.hpp"

namespace Haptos {

/// What a factor is kept in once computed; CHOLMOD of ours only, elsewhere it is double.  Single serves preconditioners.
enum class FactorPrecision { Double, Single };

/// Whether this build can factor by CHOLMOD.
bool hasCholmod();

/// \brief A matrix is singular in double precision, or so nearly that its factor solves nothing.
class UselessFactor : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// \brief What factors cost: multiplications to make them, entries kept, bytes that solves read.
struct FactorWork {
  double flops = 0;  ///< as CHOLMOD counts them; 0 of others
  double entries = 0;
  double bytesRead = 0;  ///< of one solve, forward and backward, or of all solves so far

  FactorWork& operator+=(const FactorWork& other) {
    flops += other.flops;
    entries += other.entries;
    bytesRead += other.bytesRead;
    return *this;
  }
};

/// \brief Factor of one symmetric positive definite sparse matrix A [n x n] on this process, by Amesos2.
///
/// Keeps A (both triangles stored).  Amesos2 and Tpetra stay behind this class.  No function communicates.
class LocalSolverFactor {
 public:
  /// Numbers of phases run, as Amesos2 counts them.
  struct Counts {
    int symbolic, numeric, solves;
  };

  using MatrixView = Eigen::Map<const Eigen::SparseMatrix<double>>;

  /// \throws InputError if CHOLMOD is asked for and not built in.
  /// \throws UselessFactor if A is not positive definite; CHOLMOD names the column, of others std::runtime_error.
  LocalSolverFactor(Eigen::SparseMatrix<double> A, LocalSolverMethod method, FactorPrecision precision = FactorPrecision::Double);
  /// \brief The analysis alone: `work` tells what a factor takes, and `renew` makes it.
  static LocalSolverFactor analysed(Eigen::SparseMatrix<double> A, LocalSolverMethod method);
  ~LocalSolverFactor();
  LocalSolverFactor(LocalSolverFactor&&) noexcept;

  /// \brief Factors another matrix of the same pattern; the analysis of the first one serves it too.
  /// \throws UselessFactor if it is not positive definite.
  void renew(const Eigen::SparseMatrix<double>& A);

  /// X := A^-1 B, both n x m, in one call to the solver.  B and X must not overlap.  May be called from
  /// several threads; they then wait for each other.
  void solve(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X) const;

  /// \brief S := S - B^T A^-1 B, B [n x m] sparse, S [m x m], of which the lower triangle is taken and both are given.
  void subtractGram(const Eigen::SparseMatrix<double>& B, Eigen::MatrixXd& S) const;

  /// \brief Frees A where the solver can do without it (CHOLMOD of ours); `matrix` must not be called after it.
  void releaseMatrix();

  Eigen::Index rows() const;          ///< n
  MatrixView matrix() const;          ///< A, valid until it is released
  const char* methodName() const;     ///< "CHOLMOD" or "KLU2"
  std::size_t factorEntries() const;  ///< stored entries: of L for CHOLMOD, of L and U for KLU2
  FactorWork work() const;            ///< bytes: of one solve
  Counts counts() const;

 private:
  struct Impl;
  explicit LocalSolverFactor(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace Haptos
