// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualVectors.hpp"

#include <Teuchos_Assert.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Operator.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "Haptos_Reductions.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {

namespace {

using DualView = MultiVector::dual_view_type;

// An array as a Vector, without copying; both hosts and devices must see it.
Vector viewOf(const RCP<const Map>& map, Eigen::VectorXd& values) {
  const DualView::t_dev view(values.data(), std::size_t(values.size()), 1);
  return Vector(map, DualView(view, view));
}

// Where no view can be had, or the Vector is to live longer than the array.
RCP<Vector> copyOf(const RCP<const Map>& map, const Eigen::VectorXd& values) {
  auto v = Teuchos::rcp(new Vector(map));
  const auto data = v->getDataNonConst(0);
  std::copy(values.data(), values.data() + values.size(), data.begin());
  return v;
}

}  // namespace

std::vector<int> contactRows(const std::vector<PairLaw>& pairs) {
  std::vector<int> rows;
  for (const PairLaw& pair : pairs)
    for (int row : {pair.normal, pair.tangential[0], pair.tangential[1]})
      if (row >= 0) rows.push_back(row);
  std::sort(rows.begin(), rows.end());
  return rows;
}

// Operators on contact rows number them in ascending order of the rows; contact values come pair by pair: placeOf_ leads from one to
// the other.
DualVectors::DualVectors(RCP<const Map> map, const std::vector<PairLaw>& pairs, std::vector<int> gluingRows)
    : map_(std::move(map)), pairs_(pairs), numRows_(Eigen::Index(localNumElements(*map_))), gluingRows_(std::move(gluingRows)) {
  const std::vector<int> rows = contactRows(pairs);
  numContactRows_ = Eigen::Index(rows.size());
  for (const PairLaw& pair : pairs)
    for (int row : {pair.normal, pair.tangential[0], pair.tangential[1]})
      placeOf_.push_back(row < 0 ? -1 : int(std::lower_bound(rows.begin(), rows.end(), row) - rows.begin()));
}

// x_E
Eigen::VectorXd DualVectors::gluing(const Eigen::VectorXd& x) const {
  Eigen::VectorXd part(Eigen::Index(gluingRows_.size()));
  for (std::size_t i = 0; i < gluingRows_.size(); ++i) part[Eigen::Index(i)] = x[gluingRows_[i]];
  return part;
}

// x_c, zeros where a pair has no tangential rows
Eigen::VectorXd DualVectors::contact(const Eigen::VectorXd& x) const {
  Eigen::VectorXd values(3 * numPairs());
  for (Eigen::Index i = 0; i < numPairs(); ++i) {
    const auto triple = ContactLaw::gather(pairs_[std::size_t(i)], x.data());
    for (int d = 0; d < 3; ++d) values[3 * i + d] = triple[d];
  }
  return values;
}

void DualVectors::setGluing(Eigen::VectorXd& x, const Eigen::VectorXd& values) const {
  for (std::size_t i = 0; i < gluingRows_.size(); ++i) x[gluingRows_[i]] = values[Eigen::Index(i)];
}

void DualVectors::setContact(Eigen::VectorXd& x, const Eigen::VectorXd& values) const {
  for (Eigen::Index i = 0; i < numPairs(); ++i) {
    const PairLaw& pair = pairs_[std::size_t(i)];
    x[pair.normal] = values[3 * i];
    for (int t = 0; t < 2; ++t)
      if (pair.tangential[t] >= 0) x[pair.tangential[t]] = values[3 * i + 1 + t];
  }
}

// Where Tpetra computes on the host, the arrays themselves are the vectors.
Eigen::VectorXd DualVectors::apply(const Operator& op, const Eigen::VectorXd& x) {
  const RCP<const Map> from = op.getDomainMap(), to = op.getRangeMap();
  TEUCHOS_ASSERT(x.size() == Eigen::Index(localNumElements(*from)));
  Eigen::VectorXd y = Eigen::VectorXd::Zero(Eigen::Index(localNumElements(*to)));
  if constexpr (std::is_same_v<DualView::t_dev, DualView::t_host>) {
    Vector out = viewOf(to, y);
    op.apply(viewOf(from, const_cast<Eigen::VectorXd&>(x)), out);
    return y;
  } else {
    Vector out(to);
    op.apply(*copyOf(from, x), out);
    return fromVector(out);
  }
}

Eigen::VectorXd DualVectors::applyToContact(const Operator& op, const Eigen::VectorXd& x) const {
  const Eigen::VectorXd rows = apply(op, x);
  Eigen::VectorXd values(3 * numPairs());
  for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = placeOf_[std::size_t(i)] < 0 ? 0.0 : rows[placeOf_[std::size_t(i)]];
  return values;
}

// Contact values without a row of their own do not act.
Eigen::VectorXd DualVectors::applyOnContact(const Operator& op, const Eigen::VectorXd& values) const {
  Eigen::VectorXd rows(numContactRows_);
  for (Eigen::Index i = 0; i < values.size(); ++i)
    if (placeOf_[std::size_t(i)] >= 0) rows[placeOf_[std::size_t(i)]] = values[i];
  return applyToContact(op, rows);
}

Eigen::MatrixXd DualVectors::applyOnContactByColumns(const Operator& op, const Eigen::MatrixXd& values) const {
  MultiVector in(op.getDomainMap(), std::size_t(values.cols())), out(op.getRangeMap(), std::size_t(values.cols()));
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(values.rows(), values.cols());
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    const auto rows = in.getDataNonConst(std::size_t(j));
    for (Eigen::Index i = 0; i < values.rows(); ++i)
      if (placeOf_[std::size_t(i)] >= 0) rows[placeOf_[std::size_t(i)]] = values(i, j);
  }
  op.apply(in, out);
  for (Eigen::Index j = 0; j < values.cols(); ++j) {
    const auto rows = out.getData(std::size_t(j));
    for (Eigen::Index i = 0; i < values.rows(); ++i)
      if (placeOf_[std::size_t(i)] >= 0) result(i, j) = rows[placeOf_[std::size_t(i)]];
  }
  return result;
}

// A rank alone has the sum already.
void DualVectors::sum(Eigen::Ref<Eigen::MatrixXd> values) const {
  if (map_->getComm()->getSize() == 1 || values.size() == 0) return;
  values = sumOfAll(*map_->getComm(), Eigen::MatrixXd(values));
}

double DualVectors::sum(double value) const {
  double total = 0;
  Teuchos::reduceAll(*map_->getComm(), Teuchos::REDUCE_SUM, value, Teuchos::outArg(total));
  return total;
}

double DualVectors::norm(const Eigen::VectorXd& x) const { return std::sqrt(sum(x.squaredNorm())); }

RCP<Vector> DualVectors::toVector(const Eigen::VectorXd& x) const { return copyOf(map_, x); }

Eigen::VectorXd DualVectors::fromVector(const Vector& x) {
  const auto data = x.getData(0);
  return Eigen::Map<const Eigen::VectorXd>(data.getRawPtr(), data.size());
}

const Communicator& DualVectors::comm() const { return *map_->getComm(); }

}  // namespace Haptos
