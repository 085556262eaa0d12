// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "Haptos_DenseSurfaceMatrices.hpp"
#include "Haptos_LocalSolver.hpp"
#include "Haptos_Options.hpp"
#include "Haptos_SubdomainStiffness.hpp"
#include "Haptos_TouchedUnknowns.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief K and R of one subdomain; dof = 3 x local node + component.
struct LocalSystem {
  Eigen::SparseMatrix<double> K;  ///< [n x n], both triangles; of one member of a class, and until LocalSystems lets it go
  std::shared_ptr<const Eigen::MatrixXd> kernel;  ///< R, shared by copies and with the factor
  Eigen::MatrixX3d magnitude;  ///< see LocalSystems::magnitude
  std::uint64_t pattern = 0;  ///< fingerprint of the places of the entries of K
  int congruenceClass = 0;        ///< local to the rank; members share K, R and the factor

  const Eigen::MatrixXd& R() const { return *kernel; }  ///< [n x k], orthonormal columns, K R = 0
};

/// \brief Stiffnesses, kernels and factors of this rank's subdomains.
///
/// Subdomains whose K, up to 1e-12 of its largest entry, and local numbering agree are congruent: they share one
/// factor and are solved together, many right-hand sides at once.  Nothing here communicates.
class LocalSystems {
 public:
  explicit LocalSystems(std::shared_ptr<const SubdomainStiffness> source) : source_(std::move(source)) {}

  /// \brief Gets K and R of every subdomain, once for those that are copies.  \throws what the source throws.
  void assemble();

  /// \brief Finds congruent subdomains; part of `factor`, enough where only K is wanted.
  void findClasses();

  /// \brief Finds congruent subdomains and factors or condenses one of each class.
  ///
  /// \param touched by rows of B: what a condensed subdomain keeps beside its surface
  /// \param mayUse bytes that dense matrices may take on this rank, as far as `dual` leaves the choice
  /// \param lastUse if given, called for every class, and K of it is let go after it: half of the memory
  void factor(const TouchedUnknowns& touched, LocalSolverMethod method, LocalDual dual, double mayUse = 4e9,
              const std::function<void(int congruenceClass)>& lastUse = {});

  /// \brief Factors every class by `method`, without dense matrices.
  void factor(LocalSolverMethod method);

  /// \brief Finds congruent subdomains and forms S alone, where `pattern`, factored, has dense matrices.
  void condenseLike(const LocalSystems& pattern);

  const SubdomainStiffness& source() const { return *source_; }
  /// \brief Fits what depends on rows of B to other ones, after `factor`: dense matrices whose boundary has changed are made
  /// again, sparse factors stay.  \param lastUse as in `factor`: K of the class is there once more
  void renewSurfaces(const TouchedUnknowns& touched, LocalSolverMethod method, const std::function<void(int congruenceClass)>& lastUse);

  int size() const { return int(systems_.size()); }
  int numClasses() const { return int(representative_.size()); }
  const LocalSystem& operator[](int i) const { return systems_[i]; }
  /// \brief Unknowns of a class that rows touch, ascending; with those of its surface where they do not hold it.
  std::vector<int> boundaryOf(int congruenceClass, const TouchedUnknowns& touched) const;

  /// \brief K of a class, as long as it is kept.
  const Eigen::SparseMatrix<double>& stiffness(int congruenceClass) const { return systems_[representative_[congruenceClass]].K; }
  /// \brief Sums of |K_ij| over the unknowns j of one component, [n x 3]: what round-off in K u is proportional to.
  const Eigen::MatrixX3d& magnitude(int i) const { return systems_[copyOf_[i] >= 0 ? copyOf_[i] : i].magnitude; }
  /// \brief Lets K of a class go.
  void releaseStiffness(int congruenceClass);
  /// \brief Dense matrices of a class; null where it is factored, or before both.
  const DenseSurfaceMatrices* condensationOf(int congruenceClass) const {
    return condensed_.empty() ? nullptr : condensed_[congruenceClass].get();
  }
  int numCondensed() const;  ///< subdomains with dense matrices
  double denseBytes() const { return denseBytes_; }  ///< of all dense matrices
  const char* methodName() const;  ///< of the first factor; "dense" where there is none
  const std::vector<std::vector<int>>& members() const { return members_; }  ///< [classes] local subdomains

  /// \brief U := K^+ F for vectors on the primal map; `offsets` [size + 1] locates the subdomains.
  void applyPseudoInverse(const std::vector<std::size_t>& offsets, const MultiVector& f, MultiVector& u) const;

  /// \brief U := K^+ F where F is zero off the rows of B, and U is wanted there only; elsewhere U may keep what it has.
  void applyOnSurface(const std::vector<std::size_t>& offsets, const MultiVector& f, MultiVector& u) const;

  long factorizations() const { return factorizations_; }  ///< matrices factored or condensed so far
  /// \brief Vectors that went through a K^+ so far, those of the dense matrices' construction among them.
  long localSolves() const { return localSolves_; }
  /// \brief Of the factors of K, or of dense matrices (without S); bytes: of all solves so far.
  FactorWork work() const;

 private:
  std::shared_ptr<const SubdomainStiffness> source_;
  std::vector<LocalSystem> systems_;
  std::vector<int> copyOf_;                 // [subdomains] an earlier one with the same K, which this one then lacks; or -1
  std::vector<int> representative_;         // [classes] local subdomain
  std::vector<std::vector<int>> members_;   // [classes]
  void solveClass(int c, const std::vector<std::size_t>& offsets, const double* f, double* u) const;
  void multiplyClass(int c, const std::vector<std::size_t>& offsets, const double* f, double* u) const;
  void makeFactor(int c, LocalSolverMethod method);
  double denseBytesOf(int c) const;
  void makeCondensation(int c, const std::vector<int>& boundary, DenseSurfaceMatrices::Scope scope);

  std::vector<std::unique_ptr<LocalSolver>> solvers_;           // [classes] null where condensed
  std::vector<std::unique_ptr<DenseSurfaceMatrices>> condensed_;  // [classes] null where factored
  double denseBytes_ = 0;
  long factorizations_ = 0;
  mutable long localSolves_ = 0;
  mutable std::vector<long> blocks_;  // [classes] of right-hand sides so far: a factor, or dense matrix, is read once a block
};

}  // namespace Haptos
