// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <array>
#include <string>
#include <vector>

#include "Haptos_CoarseProblem.hpp"
#include "Haptos_NaturalCoarseSpace.hpp"
#include "Haptos_RigidBodyModes.hpp"

namespace Haptos {

class LocalSystems;

/// \brief The rigid motions of every body, in the coordinates of the subdomains' kernels.
///
/// A column of Z is a motion of one body that costs no energy in any of its subdomains: for elastic ones the three
/// translations, then the three rotations about the body's centre, divided by the body's size, so that all are lengths.  Where
/// kernels lack some of the six, a basis of those that are left.  G^T Z has no gluing rows.
class BodyMotions {
 public:
  using Motion = Eigen::Matrix<double, 6, 1>;  ///< coefficients of the six

  /// \param bodies [local subdomains], \param names [bodies].  Collective.
  BodyMotions(const NaturalCoarseSpace& G, const LocalSystems& systems, const std::vector<int>& bodies, std::vector<std::string> names);

  const Eigen::SparseMatrix<double>& Z() const { return Z_; }  ///< [l x motions], the same on all ranks
  int numBodies() const { return int(names_.size()); }

  /// \brief "body 'upper': translation along (1, 0, 0)" for the body that moves most in y [motions].
  std::string describe(const Eigen::VectorXd& y) const { return describe(y, 0, MotionSense::Either); }
  /// \brief The same of a motion that loads drive: with its sense, and without a rotation that moves no node by a twentieth of the translation.
  std::string describeDriven(const Eigen::VectorXd& y) const;

  /// \brief One coarse vector that acts on a motion, a column of Z, in its body's first subdomain alone.
  Eigen::SparseVector<double> hold(int motion) const;

 private:
  std::string describe(const Eigen::VectorXd& y, double negligible, MotionSense sense) const;
  struct Sums;
  Sums sumUp(const NaturalCoarseSpace& G, const LocalSystems& systems, const std::vector<int>& bodies) const;
  void findFirst(const NaturalCoarseSpace& G, const std::vector<int>& bodies);
  void findBodies(const Communicator& comm, const LocalSystems& systems, const std::vector<int>& bodies);
  Eigen::Matrix<double, 3, 6> motionAt(int body, const std::array<double, 3>& x) const;

  struct Column {
    int body;
    Motion motion;
  };
  std::vector<std::string> names_;
  std::vector<Eigen::Vector3d> centre_;
  std::vector<double> size_;
  std::vector<std::array<int, 2>> first_;  // [bodies] coarse unknowns of the first subdomain: begin, end
  std::vector<Column> columns_;            // of Z
  Eigen::SparseMatrix<double> Z_;
};

/// \brief Motions that none of some rows of G^T feels: a basis Y [motions x k] of { y : G^T Z y = 0 }.
///
/// Column i has a 1 at its pivot and 0 at the pivots of the others.
struct UnheldMotions {
  Eigen::MatrixXd basis;
  std::vector<int> pivots;  ///< [k] columns of Z
};

/// \param rows G^T on this rank's rows, \param Z [l x motions], see `BodyMotions`
/// \param holds [rows] whether a row counts; gluing rows within a body need not.  Collective.
UnheldMotions findUnheldMotions(const Communicator& comm, const CoarseRows& rows, const Eigen::SparseMatrix<double>& Z,
                                const std::vector<char>& holds);

/// \brief Holds for `CoarseProblem`, one for every unheld motion.
CoarseProblem::Holds holdsFor(const UnheldMotions& unheld, const BodyMotions& bodies);

/// \brief The part of the loads that unheld motions feel, as one of these motions [motions]: what the loads drive.  \param e R^T f
Eigen::VectorXd drivenMotion(const UnheldMotions& unheld, const BodyMotions& bodies, const Eigen::VectorXd& e);

/// \brief Asks whether the loads leave unheld motions alone.
///
/// \param e R^T f, \param loadScale size of the loads [force]
/// \throws InsufficientModel if the loads do work on an unheld motion: no equilibrium exists.
void requireBalance(const UnheldMotions& unheld, const BodyMotions& bodies, const Eigen::VectorXd& e, double loadScale);

}  // namespace Haptos
