// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <vector>

#include "Haptos_SurfaceSchur.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_Options.hpp"

namespace Haptos {

/// \brief The Schur complement S on the unknowns of a subdomain that rows of B touch, or K_bb when lumped, for every class of congruent
/// subdomains.
///
/// Made class by class while K is there; later K is not needed.  Nothing here communicates.
class SurfaceOperators {
 public:
  /// \param inDouble [local subdomains, or empty] those whose S is kept in double precision instead of single
  SurfaceOperators(PreconditionerKind kind, LocalSolverMethod method, std::vector<char> inDouble = {});

  /// \brief Those of all classes at once.
  SurfaceOperators(const LocalSystems& systems, const TouchedUnknowns& touched, PreconditionerKind kind, LocalSolverMethod method,
                   std::vector<char> inDouble = {});

  /// \brief The next class, whose K must be there; its dense matrices, if it has some, must outlive this object.
  ///
  /// \param touched what is not free to follow
  void add(const LocalSystems& systems, const TouchedUnknowns& touched);

  int numClasses() const { return int(classes_.size()); }
  const std::vector<int>& boundary(int congruenceClass) const { return classes_[congruenceClass].boundary; }  ///< local dofs
  /// \brief Y := S X, [boundary x m].
  void apply(int congruenceClass, const Eigen::MatrixXd& X, Eigen::MatrixXd& Y) const;
  /// \brief S(c, c), `c` positions in the boundary list; symmetric.
  Eigen::MatrixXd block(int congruenceClass, const std::vector<int>& c) const;
  /// \brief Whether S is kept in double precision.
  bool isDouble(int congruenceClass) const { return classes_[congruenceClass].isDouble; }
  /// \brief Estimate of diag(S) from K_bb [boundary], the mean of a node's: exact it costs a solve for every unknown and
  /// serves no better.
  const Eigen::VectorXd& diagonal(int congruenceClass) const { return classes_[congruenceClass].diagonal; }
  /// \brief Of the factors of K_ii, or of a dense S, whose making is in LocalSystems::work; bytes: of all applications so far.
  FactorWork work() const;

 private:
  struct Class {
    std::vector<int> boundary;
    Eigen::VectorXd diagonal;
    const DenseSurfaceMatrices* condensed = nullptr;  // of the systems
    std::unique_ptr<SurfaceSchur> schur;             // null where condensed
    bool isDouble = false;
    mutable long applications = 0;
  };
  PreconditionerKind kind_;
  LocalSolverMethod method_;
  std::vector<char> inDouble_;
  std::vector<Class> classes_;
};

}  // namespace Haptos
