// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Tpetra_Operator.hpp>
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// \brief B: the signed and averaged jumps of the subdomains' displacements, and its transpose.
///
///   apply(u, s):            s = B u,        primal -> dual
///   apply(l, f, TRANS):     f = B^T l,      dual -> primal
///
/// The primal map numbers 3 x node + component, subdomain after subdomain; a rank holds its subdomains
/// contiguously.  Both directions are Collective: one Import or Export of the rows that ranks share.
class JumpOperator final : public Operator {
 public:
  /// \param firstSubdomain global number of this rank's first subdomain
  /// \param dofsOfSubdomain [local subdomains] sizes
  JumpOperator(RCP<const MultiplierMap> multipliers, int firstSubdomain, const std::vector<int>& dofsOfSubdomain);

  RCP<const Map> getDomainMap() const override { return primalMap_; }
  RCP<const Map> getRangeMap() const override { return multipliers_->map(); }
  bool hasTransposeApply() const override { return true; }
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1.0,
             double beta = 0.0) const override;

  /// \brief Vectors that B was applied to, or B^T, and what this rank sent for it.
  struct Traffic {
    long vectors = 0;
    CommunicationCounts sent;
  };
  const Traffic& forward() const { return forward_; }      ///< B: one Export
  const Traffic& transposed() const { return transposed_; }  ///< B^T: one Import

  const MultiplierMap& multipliers() const { return *multipliers_; }
  int firstSubdomain() const { return firstSubdomain_; }  ///< global number of this rank's first one
  std::vector<int> touchedDofs(int localSubdomain) const;  ///< unknowns of one of this rank's subdomains with a row; with repetitions
  const std::vector<std::size_t>& primalOffsets() const { return primalOffsets_; }  ///< [local subdomains + 1]

 private:
  void multiply(const MultiVector& x, MultiVector& y, double alpha, double beta) const;
  void multiplyTransposed(const MultiVector& x, MultiVector& y, double alpha, double beta) const;

  RCP<const MultiplierMap> multipliers_;
  RCP<const Map> primalMap_;
  int firstSubdomain_;
  std::vector<std::size_t> primalOffsets_;
  std::vector<std::size_t> rowOffsets_;  // CSR over overlap rows
  std::vector<int> columns_;             // local primal index
  std::vector<double> values_;
  mutable Traffic forward_, transposed_;
};

}  // namespace Haptos
