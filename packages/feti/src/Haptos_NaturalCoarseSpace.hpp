// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Tpetra_Operator.hpp>
#include <memory>
#include <vector>

#include "Haptos_CoarseProblem.hpp"
#include "Haptos_JumpOperator.hpp"

namespace Haptos {

class LocalSystems;

/// \brief G = R^T B^T, from the dual map to the kernels of all subdomains, and e = R^T f.
///
/// Subdomain s has columns columnOf(s) .. columnOf(s + 1) - 1, one for each of its motions without energy, mostly six;
/// subdomains ascend, l is the number of all.
/// The coarse map is locally replicated.  apply(x, y): y = G x, one reduction of l numbers, Collective;
/// apply(x, y, TRANS): y = G^T x, without communication.
class NaturalCoarseSpace final : public Operator {
 public:
  /// Collective.
  NaturalCoarseSpace(RCP<const JumpOperator> jump, const LocalSystems& systems);

  RCP<const Map> getDomainMap() const override { return jump_->getRangeMap(); }
  RCP<const Map> getRangeMap() const override { return coarseMap_; }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0,
             double beta = 0.0) const override;

  /// \brief This rank's part of G x [l x columns]; the sum over the ranks is G x.
  Eigen::MatrixXd partOfG(const MultiVector& x) const;
  /// \brief G x [l x columns], the same on all ranks.  Collective.
  Eigen::MatrixXd applyG(const MultiVector& x) const;
  /// \brief y := alpha G^T a + beta y.
  void applyGT(const Eigen::MatrixXd& a, MultiVector& y, double alpha = 1.0, double beta = 0.0) const;

  /// \brief R^T f [l], the same on all ranks.  Collective.
  Eigen::VectorXd restrictLoad(const MultiVector& f, const LocalSystems& systems) const;
  /// \brief u += R a on the primal map.
  void addRigidMotion(const Eigen::VectorXd& a, const LocalSystems& systems, MultiVector& u) const;

  const CoarseRows& rows() const { return GT_; }  ///< G^T on the owned rows
  int dimension() const { return int(GT_.cols()); }  ///< l
  int columnOf(int localSubdomain) const { return columns_[std::size_t(localSubdomain)]; }  ///< first coarse unknown

 private:
  RCP<const JumpOperator> jump_;
  RCP<const Map> coarseMap_;
  std::vector<int> columns_;  // [local subdomains + 1]
  CoarseRows GT_;
};

}  // namespace Haptos
