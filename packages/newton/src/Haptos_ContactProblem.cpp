// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactProblem.hpp"

#include <Teuchos_Assert.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>

#include "Haptos_DualVectors.hpp"
#include "Haptos_RemoteRows.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

// Some rows of M, of all columns or of the same: M(rows, :) or M(rows, rows) by M itself, for whoever gives nothing cheaper.
class RowsOfOperator final : public Operator {
 public:
  enum class Columns { All, Same };
  RowsOfOperator(RCP<const Operator> M, std::vector<int> rows, Columns columns)
      : M_(std::move(M)), rows_(std::move(rows)), map_(mapOfRows(*M_->getRangeMap(), rows_)), columns_(columns) {}

  RCP<const Map> getDomainMap() const override { return columns_ == Columns::All ? M_->getDomainMap() : map_; }
  RCP<const Map> getRangeMap() const override { return map_; }

  // y := beta y + alpha (M x)(rows), at the price of a whole M
  void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const override {
    MultiVector z(M_->getRangeMap(), x.getNumVectors());
    if (columns_ == Columns::All) M_->apply(x, z);
    else M_->apply(extended(x), z);
    if (beta == 0) y.putScalar(0);
    else y.scale(beta);
    for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
      const auto from = z.getData(v);
      const auto to = y.getDataNonConst(v);
      for (std::size_t i = 0; i < rows_.size(); ++i) to[i] += alpha * from[rows_[i]];
    }
  }

 private:
  MultiVector extended(const MultiVector& x) const {
    MultiVector whole(M_->getDomainMap(), x.getNumVectors());
    for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
      const auto from = x.getData(v);
      const auto to = whole.getDataNonConst(v);
      for (std::size_t i = 0; i < rows_.size(); ++i) to[rows_[i]] = from[i];
    }
    return whole;
  }

  RCP<const Operator> M_;
  std::vector<int> rows_;
  RCP<const Map> map_;
  Columns columns_;
};

// A wrong order would cost applications, not digits, and not be noticed.
bool hasRows(const Map& map, const Map& all, const std::vector<int>& rows) {
  if (localNumElements(map) != rows.size()) return false;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (map.getGlobalElement(int(i)) != all.getGlobalElement(rows[i])) return false;
  return true;
}

}  // namespace

RCP<const Operator> contactBlockOf(const RCP<const Operator>& M, const std::vector<PairLaw>& pairs) {
  return Teuchos::rcp(new RowsOfOperator(M, contactRows(pairs), RowsOfOperator::Columns::Same));
}

// What can be checked without work is: the rest, such as G M = 0 of a deflated M, is the caller's promise.
ContactProblem::ContactProblem(ContactOperators operators, const RCP<MultiVector>& lambda)
    : Belos::LinearProblem<double, MultiVector, Operator>(operators.F, lambda, operators.h), operators_(std::move(operators)) {
  ContactOperators& o = operators_;
  TEUCHOS_ASSERT(!lambda.is_null() && !o.F.is_null() && (!o.h.is_null() || o.jumpsOf) && !o.M.is_null() && !o.diagonalOfM.is_null());
  TEUCHOS_ASSERT(!o.GT.is_null() && !o.GGT.is_null());
  TEUCHOS_ASSERT(o.GT->cols() == o.e.size());
  TEUCHOS_ASSERT(Eigen::Index(o.holds.size()) == o.motions.cols());
  TEUCHOS_ASSERT(o.motions.cols() == 0 || o.motions.rows() == o.GT->cols());
  const std::vector<int> rows = contactRows(o.pairs);
  if (o.contactM.is_null()) o.contactM = contactBlockOf(o.M, o.pairs);
  if (o.contactRowsOfM.is_null()) o.contactRowsOfM = Teuchos::rcp(new RowsOfOperator(o.M, rows, RowsOfOperator::Columns::All));
  const Map& all = *o.F->getRangeMap();
  TEUCHOS_ASSERT(hasRows(*o.contactM->getDomainMap(), all, rows) && hasRows(*o.contactM->getRangeMap(), all, rows));
  TEUCHOS_ASSERT(hasRows(*o.contactRowsOfM->getRangeMap(), all, rows));
}

void ContactProblem::setStep(const RCP<const Vector>& h, const Eigen::VectorXd& e, const std::vector<PairLaw>& pairs) {
  TEUCHOS_ASSERT(e.size() == operators_.e.size() && contactRows(pairs) == contactRows(operators_.pairs));
  operators_.h = h;
  operators_.e = e;
  operators_.pairs = pairs;
  setRHS(h);
}

}  // namespace Haptos
