// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <BelosMultiVecTraits.hpp>
#include <BelosOperatorTraits.hpp>
#include <Teuchos_Assert.hpp>

#include "Haptos_QuadraticProgram.hpp"

namespace Haptos {

template <class Scalar, class MV, class OP>
QuadraticProgram<Scalar, MV, OP>::QuadraticProgram(const RCP<const OP>& A, const RCP<MV>& x, const RCP<const MV>& b,
                                                   const RCP<FeasibleSet<MV>>& omega, const RCP<const OP>& Q,
                                                   const RCP<const MV>& x0)
    : Belos::LinearProblem<Scalar, MV, OP>(A, x, b), omega_(omega), Q_(Q), x0_(x0) {
  TEUCHOS_ASSERT(!x.is_null() && !b.is_null() && !omega.is_null());
}

template <class Scalar, class MV, class OP>
void QuadraticProgram<Scalar, MV, OP>::applyHessian(const MV& x, MV& Ax, MV& Qx) const {
  Belos::OperatorTraits<Scalar, MV, OP>::Apply(*this->getOperator(), x, Ax);
  applyEqualityProjector(x, Qx);
}

template <class Scalar, class MV, class OP>
void QuadraticProgram<Scalar, MV, OP>::applyEqualityProjector(const MV& x, MV& Qx) const {
  if (Q_.is_null())
    Belos::MultiVecTraits<Scalar, MV>::MvInit(Qx, 0);
  else
    Belos::OperatorTraits<Scalar, MV, OP>::Apply(*Q_, x, Qx);
}

}  // namespace Haptos
