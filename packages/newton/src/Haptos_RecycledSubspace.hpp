// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_ColumnBlocks.hpp"
#include "Haptos_DualVectors.hpp"

namespace Haptos {

/// \brief Pairs (v_j, s_j) with s_j = -F v_j + rigid part, kept from step to step.
///
/// They depend on no friction coefficient and on no state of contact.  The gluing parts of the s_j are kept as Q R
/// (Q distributed, R the same on all ranks), the contact values of v_j and s_j apart as dense blocks.
class RecycledSubspace {
 public:
  /// \param maximum of pairs, the permanent ones not counted.
  explicit RecycledSubspace(const DualVectors& vectors, Eigen::Index maximum = kUnlimited);

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

  /// \brief Appends (v, s) / ||s||, or nothing where s = 0; returns ||s||.  Collective: one to three reductions, mostly two.
  double add(const Eigen::VectorXd& v, const Eigen::VectorXd& s);

  auto R() const { return R_.topLeftCorner(size_, size_); }   ///< [m x m], upper triangular
  auto Vc() const { return Vc_.leftCols(size_); }             ///< [3 pairs x m] contact values of the v_j
  auto Sc() const { return Sc_.leftCols(size_); }             ///< [3 pairs x m] of the s_j

  struct Projected {
    Eigen::VectorXd inside;  // Q^T times gluing rows [m], the same on all ranks
    double norm2;            // of these rows, squared
    double outside2() const { return std::max(0.0, norm2 - inside.squaredNorm()); }
  };
  /// \brief Gluing rows in the span of Q, and what is outside.  Collective: one reduction.
  Projected projectGluing(const Eigen::VectorXd& gluing) const;

  /// \brief (lambda, s) += sum of y_j (v_j, s_j).
  void addCombination(const Eigen::VectorXd& y, Eigen::VectorXd& lambda, Eigen::VectorXd& s) const;

  double memoryMb() const;                               ///< on this rank
  Eigen::Index largestSize() const { return largest_; }  ///< since construction
  int compressions() const { return compressions_; }     ///< calls of dropOldest since construction

 private:
  void growDense();
  Eigen::VectorXd jumps(const Eigen::VectorXd& y) const;

  const DualVectors& vectors_;
  Eigen::Index maximum_, size_ = 0, permanent_ = 0, largest_ = 0;
  int compressions_ = 0;
  ColumnBlocks V_, Q_;         // s_j: Q R on gluing rows, Sc on contact rows
  Eigen::MatrixXd R_, Vc_, Sc_;
};

}  // namespace Haptos
