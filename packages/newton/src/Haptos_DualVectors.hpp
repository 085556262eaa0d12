// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>

#include "Haptos_ContactLaw.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief The rows of pairs, ascending: the order in which operators on contact rows number theirs.
std::vector<int> contactRows(const std::vector<PairLaw>& pairs);

/// \brief This rank's part of dual vectors as plain arrays, and the sums over ranks that they need.
///
/// "Gluing rows" are the gluing and Dirichlet rows; "contact values" are (N, T1, T2) of every owned pair, 3 x pairs,
/// 0 where a pair has no tangential rows.
class DualVectors {
 public:
  /// \param pairs owned pairs, kept by reference; \param gluingRows owned rows.
  DualVectors(RCP<const Map> map, const std::vector<PairLaw>& pairs, std::vector<int> gluingRows);

  Eigen::Index numRows() const { return numRows_; }
  Eigen::Index numPairs() const { return Eigen::Index(pairs_.size()); }
  const std::vector<int>& gluingRows() const { return gluingRows_; }

  Eigen::VectorXd gluing(const Eigen::VectorXd& x) const;
  Eigen::VectorXd contact(const Eigen::VectorXd& x) const;
  void setGluing(Eigen::VectorXd& x, const Eigen::VectorXd& values) const;
  void setContact(Eigen::VectorXd& x, const Eigen::VectorXd& values) const;

  /// \brief y := Op x; x and y as long as Op's maps say.  Collective.
  static Eigen::VectorXd apply(const Operator& op, const Eigen::VectorXd& x);
  /// \name The same for operators to, and between, contact rows alone (`contactRows`), as contact values.  Collective.
  /// @{
  Eigen::VectorXd applyToContact(const Operator& op, const Eigen::VectorXd& x) const;
  Eigen::VectorXd applyOnContact(const Operator& op, const Eigen::VectorXd& values) const;
  Eigen::MatrixXd applyOnContactByColumns(const Operator& op, const Eigen::MatrixXd& values) const;
  /// @}

  /// \brief Sums over the ranks, in place.  Collective, one reduction.
  void sum(Eigen::Ref<Eigen::MatrixXd> values) const;
  double sum(double value) const;
  double norm(const Eigen::VectorXd& x) const;

  RCP<Vector> toVector(const Eigen::VectorXd& x) const;
  static Eigen::VectorXd fromVector(const Vector& x);

  const Communicator& comm() const;
  const RCP<const Map>& map() const { return map_; }

 private:
  RCP<const Map> map_;
  const std::vector<PairLaw>& pairs_;
  Eigen::Index numRows_;
  std::vector<int> gluingRows_;
  std::vector<int> placeOf_;  // [3 pairs] among the contact rows, -1: no such row
  Eigen::Index numContactRows_;
};

}  // namespace Haptos
