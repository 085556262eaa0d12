// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualOperator.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

#include "Haptos_LocalSystems.hpp"

namespace Haptos {

DualOperator::DualOperator(RCP<const JumpOperator> jump, RCP<const LocalSystems> systems)
    : jump_(std::move(jump)), systems_(std::move(systems)) {}

// f = B^T x, u = K^+ f on the unknowns that B touches, y = alpha B u + beta y; f and u stay, as their memory is new otherwise.
void DualOperator::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  if (f_.is_null() || f_->getNumVectors() != x.getNumVectors()) {
    f_ = Teuchos::rcp(new MultiVector(jump_->getDomainMap(), x.getNumVectors(), false));
    u_ = Teuchos::rcp(new MultiVector(jump_->getDomainMap(), x.getNumVectors(), false));
  }
  jump_->apply(x, *f_, Teuchos::TRANS);
  systems_->applyOnSurface(jump_->primalOffsets(), *f_, *u_);
  jump_->apply(*u_, y, Teuchos::NO_TRANS, alpha, beta);
  applications_ += long(x.getNumVectors());
}

}  // namespace Haptos
