// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_DualVectors.hpp"

namespace Haptos {

/// \brief Pairs (v_j, s_j) with s_j = -F v_j + rigid part, kept from step to step.
///
/// They depend on no friction coefficient and on no state of contact.  The gluing parts of the s_j are kept as Q R
/// (Q distributed, R the same on all ranks), the contact values of v_j and s_j apart as dense blocks.
class RecycledSubspace {
 public:
  /// \param maximum of pairs, the permanent ones not counted.
  explicit RecycledSubspace(const DualVectors& vectors, Eigen::Index maximum = kUnlimited) : vectors_(vectors), maximum_(maximum) {}

  static constexpr Eigen::Index kUnlimited = 1 << 30;

  Eigen::Index size() const { return size_; }
  void clear();

  /// \brief The pairs that are there now stay for good (until `clear`).
  void makePermanent() { permanent_ = size_; }
  bool isFull() const { return size_ - permanent_ >= maximum_; }
  void setMaximum(Eigen::Index maximum) { maximum_ = maximum; }

  /// \brief Drops the older part of the pairs, the permanent ones apart; a third of the room is free afterwards.
  ///
  /// What the iteration stands on is added by the caller, as pairs of their own, so nothing reached is lost.
  /// Collective: the gluing parts are orthogonalised anew.
  void dropOldest();

  /// \brief Appends a pair; classical Gram-Schmidt, done twice.  Collective: three reductions.
  void add(const Eigen::VectorXd& v, const Eigen::VectorXd& s);

  auto R() const { return R_.topLeftCorner(size_, size_); }   ///< [m x m], upper triangular
  auto Vc() const { return Vc_.leftCols(size_); }             ///< [3 pairs x m] contact values of the v_j
  auto Sc() const { return Sc_.leftCols(size_); }             ///< [3 pairs x m] of the s_j

  /// \brief Q^T times gluing rows [m], the same on all ranks.  Collective.
  Eigen::VectorXd projectGluing(const Eigen::VectorXd& gluing) const;

  Eigen::VectorXd combineV(const Eigen::VectorXd& y) const { return V_.leftCols(size_) * y; }
  Eigen::VectorXd combineS(const Eigen::VectorXd& y) const;

  double memoryMb() const;                               ///< on this rank
  Eigen::Index largestSize() const { return largest_; }  ///< since construction
  int compressions() const { return compressions_; }     ///< calls of dropOldest since construction

 private:
  void grow();

  const DualVectors& vectors_;
  Eigen::Index maximum_, size_ = 0, permanent_ = 0, largest_ = 0;
  int compressions_ = 0;
  Eigen::MatrixXd V_, Q_, R_, Vc_, Sc_;  // S: Q R on gluing rows, Sc on contact rows
};

}  // namespace Haptos
