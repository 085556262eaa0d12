// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Tpetra_Import_fwd.hpp>
#include <Tpetra_Operator.hpp>
#include <vector>

#include "Haptos_ContactSystem.hpp"

namespace Haptos {

/// \brief A matrix that is known by its subdomains and never merged, as an operator.
///
///   A = (I - H) sum_i R_i^T K_i R_i (I - H) + H
///
/// with K_i what subdomain i has by itself (see SubdomainInput) and H the identity of the held unknowns, 0 elsewhere: what a
/// program has after assembly where the rows and columns of supports are those of the identity.  Unknowns are 3 x id + component.
/// Symmetric and positive definite where enough is held.
class SubdomainMatrix final : public Operator {
 public:
  /// \param subdomains of this rank; ids, coordinates and kernels are copied, matrices shared.
  /// \param held unknowns 3 x id + component, named by any ranks, also more than once
  /// \param map one to one, has all unknowns; null: each unknown on one of the ranks that have it.  Collective.
  /// \throws InputError on all ranks for a matrix that is missing or not of its nodes' unknowns, a held unknown that is in no subdomain, or a map that lacks one
  SubdomainMatrix(const RCP<const Communicator>& comm, const std::vector<SubdomainInput>& subdomains, const std::vector<GlobalOrdinal>& held,
                  const RCP<const Map>& map = {});

  RCP<const Map> getDomainMap() const override { return map_; }
  RCP<const Map> getRangeMap() const override { return map_; }
  bool hasTransposeApply() const override { return true; }
  /// \brief y := alpha A x + beta y.  Collective.
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode = Teuchos::NO_TRANS, double alpha = 1,
             double beta = 0) const override;

  /// \brief Subdomains and supports, for a system.
  void addTo(ContactSystem& system) const;
  /// \brief Local rows of `getDomainMap` that are held.
  const std::vector<LocalOrdinal>& held() const { return held_; }

 private:
  struct Part {
    int body;
    std::vector<GlobalOrdinal> nodes;
    std::vector<double> coordinates, kernel;
    RCP<const CrsMatrix> K;
    std::vector<LocalOrdinal> rows;  // [3 nodes] in the overlapping map
  };

  void findHeld(const std::vector<GlobalOrdinal>& named);
  void multiply(const Part& part, const double* x, double* y) const;

  std::vector<Part> parts_;
  RCP<const Map> map_;
  RCP<const Tpetra::Import<>> overlap_;  // from map_ to all unknowns of this rank's subdomains
  std::vector<LocalOrdinal> held_, heldHere_;  // in map_, in the overlapping map
};

}  // namespace Haptos
