// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualOperator.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

namespace Haptos {

DualOperator::DualOperator(RCP<const JumpOperator> jump, RCP<const LocalSystems> systems)
    : jump_(std::move(jump)), systems_(std::move(systems)) {}

void DualOperator::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  MultiVector f(jump_->getDomainMap(), x.getNumVectors()), u(jump_->getDomainMap(), x.getNumVectors());
  jump_->apply(x, f, Teuchos::TRANS);
  systems_->applyOnSurface(jump_->primalOffsets(), f, u);
  jump_->apply(u, y, Teuchos::NO_TRANS, alpha, beta);
  applications_ += long(x.getNumVectors());
}

}  // namespace Haptos
