// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <string>
#include <vector>

#include "Haptos_CoarseProblem.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_NaturalCoarseSpace.hpp"

namespace Haptos {

/// \brief The six rigid motions of every body, in the coordinates of the subdomains' rigid motions.
///
/// Column 6 b + m of Z is motion m of body b (three translations, three rotations about the body's centre, the
/// rotations divided by the body's size, so that all are lengths); G^T Z has no gluing rows.
class BodyMotions {
 public:
  /// \param names [bodies].  Collective.
  BodyMotions(const Communicator& comm, const std::vector<Subdomain>& subdomains, const LocalSystems& systems,
              int numSubdomains, std::vector<std::string> names);

  const Eigen::SparseMatrix<double>& Z() const { return Z_; }  ///< [l x 6 bodies], the same on all ranks
  int numBodies() const { return int(names_.size()); }

  /// \brief "body 'upper': translation along (1, 0, 0)" for the body that moves most in y [6 bodies].
  std::string describe(const Eigen::VectorXd& y) const;

  /// \brief One coarse vector that acts on motion m of body b in the body's first subdomain alone.
  Eigen::SparseVector<double> hold(int body, int motion) const;

 private:
  std::vector<std::string> names_;
  std::vector<Eigen::Vector3d> centre_;
  std::vector<double> size_;
  std::vector<int> firstSubdomain_;
  Eigen::SparseMatrix<double> Z_;
};

/// \brief Motions that none of some rows of G^T feels: a basis Y [6 bodies x k] of { y : G^T Z y = 0 }.
///
/// Column i has a 1 at its pivot (body, motion) and 0 at the pivots of the others.
struct UnheldMotions {
  Eigen::MatrixXd basis;
  std::vector<int> pivots;  ///< [k] 6 body + motion
};

/// \param rows G^T on this rank's rows, \param Z [l x motions], see `BodyMotions`
/// \param holds [rows] whether a row counts; gluing rows within a body need not.  Collective.
UnheldMotions findUnheldMotions(const Communicator& comm, const CoarseRows& rows, const Eigen::SparseMatrix<double>& Z,
                                const std::vector<char>& holds);

/// \brief Holds for `CoarseProblem`, one for every unheld motion.
CoarseProblem::Holds holdsFor(const UnheldMotions& unheld, const BodyMotions& bodies);

/// \brief The same where they stay unheld for good.
///
/// \param e R^T f, \param loadScale size of the loads [force]
/// \throws InsufficientModel if the loads do work on an unheld motion: no equilibrium exists.
CoarseProblem::Holds holdUnheldMotions(const UnheldMotions& unheld, const BodyMotions& bodies, const Eigen::VectorXd& e,
                                       double loadScale);

}  // namespace Haptos
