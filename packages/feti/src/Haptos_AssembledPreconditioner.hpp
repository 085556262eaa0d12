// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "Haptos_AssembledStiffness.hpp"
#include "Haptos_DualPreconditioner.hpp"

namespace Haptos {

/// \brief M = F^-1 on forces that hold every subdomain in balance, by a sparse factor of the bodies on rank 0.
///
/// M x is the force of the displacement B_D^T x + w, w continuous (B w = 0) such that the energy is least: `DeflatedPreconditioner` with all
/// continuous motions in Z, so G M = 0.  For bodies whose parts are slender: few motions would not do, and a factor of plates and needles is cheap.
class AssembledPreconditioner final : public Operator {
 public:
  /// \brief What it may take, the same on all ranks.
  struct Limits {
    double flops;       ///< of all factors, those of contact models among them
    double denseModel;  ///< flops of one such model where M between contact rows is a matrix; 0: there is no contact
    double bytes;       ///< of factors, and of what they are made from
  };
  /// \brief Null where a factor would take more, where rows of pairs depend on each other, and where nothing holds all bodies together.  Collective.
  ///
  /// \param scaling B_D \param systems with K of all classes
  static RCP<const AssembledPreconditioner> make(const RCP<const DualPreconditioner>& scaling, const RCP<const LocalSystems>& systems, const Limits& limits);

  RCP<const Map> getDomainMap() const override { return scaling_->getDomainMap(); }
  RCP<const Map> getRangeMap() const override { return scaling_->getRangeMap(); }
  bool hasTransposeApply() const override { return true; }
  /// Collective: as B and B^T, and all of a displacement to rank 0 and back.
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0,
             double beta = 0.0) const override;

  using ContactMap = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;  ///< between contact values [3 owned pairs]: N, T1, T2 of each, 0: no such row
  /// \brief M between contact rows.  Collective.
  Eigen::VectorXd onContact(const Eigen::VectorXd& jumps) const;
  /// \brief y -> d with (M + D) d = y between contact rows, D [owned pairs] symmetric and positive semidefinite.  Collective, as is what it returns.
  ///
  /// NaN where there is no such d, or its digits are lost.  There is one factor: that of the last D.
  ContactMap solverWith(const std::vector<Eigen::Matrix3d>& D) const;
  /// \brief Whether a matrix between contact rows is factored for less than the bodies are.
  bool isDenseCheaper() const { return isDenseCheaper_; }
  /// \brief M between contact values of all ranks, rank after rank, the same on all.  Collective.
  Eigen::MatrixXd contactMatrix() const;

  int numContinuous() const { return numContinuous_; }  ///< displacements, over all ranks
  long applications() const { return applications_; }

 private:
  AssembledPreconditioner(RCP<const DualPreconditioner> scaling, RCP<const LocalSystems> systems);
  bool assemble(const Limits& limits);
  void multiplyByK(MultiVector& t) const;
  Eigen::VectorXd onRoot(const Eigen::VectorXd& mine, const ContactMap& map) const;
  const Communicator& comm() const;

  RCP<const DualPreconditioner> scaling_;
  RCP<const LocalSystems> systems_;
  std::unique_ptr<AssembledStiffness> bodies_;  // rank 0
  int numContinuous_ = 0;
  bool isDenseCheaper_ = false;
  mutable long applications_ = 0;
};

}  // namespace Haptos
