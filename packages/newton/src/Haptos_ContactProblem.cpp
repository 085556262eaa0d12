// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactProblem.hpp"

#include <Teuchos_Assert.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>

namespace Haptos {

ContactProblem::ContactProblem(ContactOperators operators, const RCP<MultiVector>& lambda)
    : Belos::LinearProblem<double, MultiVector, Operator>(operators.F, lambda, operators.h), operators_(std::move(operators)) {
  const ContactOperators& o = operators_;
  TEUCHOS_ASSERT(!lambda.is_null() && !o.F.is_null() && !o.h.is_null() && !o.M.is_null() && !o.diagonalOfM.is_null());
  TEUCHOS_ASSERT(!o.GT.is_null() && !o.GGT.is_null());
  TEUCHOS_ASSERT(o.GT->cols() == o.e.size());
  TEUCHOS_ASSERT(Eigen::Index(o.holds.size()) == o.motions.cols());
  TEUCHOS_ASSERT(o.motions.cols() == 0 || o.motions.rows() == o.GT->cols());
}

}  // namespace Haptos
