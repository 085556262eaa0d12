// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "Haptos_LocalSolverFactor.hpp"

namespace Haptos {

/// \brief K of bodies whose subdomains are joined again, and the rows C of their pairs, on one process.
///
/// Displacements are continuous: copies of a node's have one number.  Pairs are those of contact, then tied ones, which stay closed; jumps and forces
/// of pairs are [3 contact pairs].  Factors are those of K + C^T D C, D symmetric and positive semidefinite, a block a pair: one analysis serves all.
/// Nothing communicates.
class AssembledStiffness {
 public:
  using Triplets = std::vector<Eigen::Triplet<double>>;

  struct Parts {
    std::vector<int> numberOf;  ///< [unknowns of all subdomains] continuous displacement; -1: prescribed
    Eigen::Index size = 0;      ///< n, continuous displacements; those that are prescribed have rows of 1
    Triplets K;                 ///< both triangles; of one place added up
    Triplets C;                 ///< [3 (contact and tied pairs) x n]
    Eigen::Index contactPairs = 0, tiedPairs = 0;
  };
  /// \brief Analyses; `work` tells what a factor takes.
  explicit AssembledStiffness(Parts parts);

  Eigen::Index size() const { return A_.rows(); }
  FactorWork work() const { return closing_.work(); }
  /// \brief Makes what all but `solveWith` need.  \throws UselessFactor where a motion of all bodies together is held by nothing
  void factor();

  /// \brief Continuous displacements of least energy, pairs closed, beside others whose forces are f, both [unknowns of all subdomains].
  Eigen::VectorXd relax(const Eigen::VectorXd& f) const;
  /// \brief Forces of pairs that have these jumps, all else continuous and of least energy: F^-1 between contact rows.
  Eigen::VectorXd forcesOf(const Eigen::VectorXd& jumps) const;
  /// \brief F^-1 between contact rows as a matrix [3 contact pairs]^2.
  Eigen::MatrixXd contactMatrix() const;

  /// \brief The factor with D [contact pairs] in the place of the one before.  \throws UselessFactor
  void setD(const std::vector<Eigen::Matrix3d>& D);
  /// \brief Jumps d with (F^-1 + D) d = y between contact rows, by the last D.
  Eigen::VectorXd solveWithD(const Eigen::VectorXd& y) const;

 private:
  // Rows of a pair, on the displacements that they have something of, and the places of their products among the entries of A.
  struct Pair {
    std::vector<int> unknowns;
    Eigen::Matrix<double, 3, Eigen::Dynamic> C;
    std::vector<int> places;
  };
  struct State {
    Eigen::VectorXd u, y;  // displacements; forces of all pairs without what D has of them
  };
  Eigen::MatrixXd contactMatrixByColumns() const;
  Eigen::VectorXd zeros() const { return Eigen::VectorXd::Zero(numRows()); }
  static std::vector<Pair> pairsOf(const Parts& parts);
  static Eigen::SparseMatrix<double> patternOf(Parts& parts, const std::vector<Pair>& pairs);
  void findPlaces();
  void findClosingD();
  Eigen::SparseMatrix<double> withD(const std::vector<Eigen::Matrix3d>& D) const;
  Eigen::Index numRows() const { return 3 * Eigen::Index(pairs_.size()); }
  Eigen::VectorXd jumps(const Eigen::VectorXd& u) const;
  Eigen::VectorXd forces(const Eigen::VectorXd& y) const;
  State close(const LocalSolverFactor& factor, const Eigen::VectorXd& f, const Eigen::VectorXd& y, const Eigen::VectorXd& jumps, Eigen::Index from) const;

  std::vector<int> numberOf_;
  Eigen::Index contactRows_;
  std::vector<Pair> pairs_;
  Eigen::SparseMatrix<double> A_;  // K, with places for all of C^T D C
  Eigen::VectorXd closingD_;  // [3 pairs] diagonal, 0: rows that have nothing of any displacement
  LocalSolverFactor closing_;
  std::unique_ptr<LocalSolverFactor> given_;
};

}  // namespace Haptos
