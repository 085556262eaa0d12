// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_WrittenField.hpp"

#include <Eigen/SparseCore>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "Haptos_LocalSystems.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {
namespace {

// K was let go when it was factored, and a product by elements integrates them anew: it takes as long as five by K (HEX8) to ten (HEX20).
// Empty where the source has K.
StiffnessProduct assembledProduct(const SubdomainStiffness& source) {
  if (source.isAssembled()) return {};
  const auto K = std::make_shared<std::vector<Eigen::SparseMatrix<double>>>(std::size_t(source.size()));
  for (int i = 0; i < source.size(); ++i)
    if (source.copyOf(i) < 0) (*K)[std::size_t(i)] = source.assemble(i);
  return [&source, K](int i, const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Ref<Eigen::VectorXd> Ku) {
    while (source.copyOf(i) >= 0) i = source.copyOf(i);
    Ku += (*K)[std::size_t(i)].transpose() * u;  // symmetric: by rows
  };
}

}  // namespace

// u - v is not 0 on surfaces alone, and so K (u - v) is cheap and r 0 deep inside.
WrittenField::WrittenField(const AccuracyInput& model, const Vector& u, const Vector& residual)
    : model_(model), v_(new Vector(u, Teuchos::Copy)), r_(new Vector(residual, Teuchos::Copy)) {
  project(*v_, Keep::Means);
  updateSince(u);
}

// x -= B_g^T B_g x: the gluing rows are orthonormal differences of copies, what is left are the means.  The rows of supports are
// orthonormal, too, and to those.
void WrittenField::project(Vector& x, Keep keep) const {
  Vector parts(model_.jump.getRangeMap());
  model_.jump.apply(x, parts);
  const auto& kinds = model_.jump.multipliers().kinds();
  {
    const auto data = parts.getDataNonConst(0);
    for (std::size_t row = 0; row < kinds.size(); ++row)
      if (kinds[row] != RowKind::Gluing && (keep == Keep::Means || kinds[row] != RowKind::Dirichlet)) data[Teuchos::Ordinal(row)] = 0;
  }
  model_.jump.apply(parts, x, Teuchos::TRANS, -1.0, 1.0);
}

// Of nodes, not of copies.
void WrittenField::measure() {
  const auto nodal = model_.gather.sum(*r_);
  const auto& comm = *r_->getMap()->getComm();
  double squares = 0, largest = 0;
  std::int64_t node = std::numeric_limits<std::int64_t>::max();
  for (std::size_t i = 0; i < nodal.size(); i += 3) {
    const double square = nodal[i] * nodal[i] + nodal[i + 1] * nodal[i + 1] + nodal[i + 2] * nodal[i + 2];
    squares += square;
    if (square <= largest) continue;
    largest = square;
    node = model_.gather.firstNode() + std::int64_t(i / 3);
  }
  const double most = largestOfAll(comm, largest);
  imbalance_ = std::sqrt(sumOfAll(comm, squares));
  worstNode_ = most > 0 ? leastOfAll(comm, largest == most ? node : std::numeric_limits<std::int64_t>::max()) : -1;
}

// The same for all copies of a component: the mean over them of the row sums of |K_ij|.
RCP<Vector> WrittenField::makeDiagonal() const {
  auto diagonal = Teuchos::rcp(new Vector(v_->getMap()));
  {
    const auto data = diagonal->getDataNonConst(0);
    const auto& offsets = model_.jump.primalOffsets();
    for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
      const auto& magnitude = model_.systems.magnitude(int(i));
      for (Eigen::Index row = 0; row < magnitude.rows(); ++row) data[Teuchos::Ordinal(offsets[i]) + row] = magnitude.row(row).sum();
    }
  }
  project(*diagonal, Keep::Means);
  return diagonal;
}

// y = K x between nodes, what supports take left out
void WrittenField::multiply(const Vector& x, Vector& y, const StiffnessProduct& product) const {
  y.putScalar(0.0);
  subtractForces(model_, x, y, product);
  y.scale(-1.0);
  project(y, Keep::UnsupportedMeans);
}

// Conjugate residuals [stiefel-1955]: z = D^-1 r,  w = K z,  beta = (z . w) / (z . w)_before,  p = z + beta p,  q = w + beta q = K p,
//
//   alpha = z . w / q . D^-1 q,   d += alpha p,   r -= alpha q,
//
// r falls from step to step, but for D, as it does not by conjugate gradients.  Copies of v + d are equal and share r, so that sums over copies are
// those over nodes.
void WrittenField::smooth(double enough, SmoothingEffort effort) {
  // Needles 1 : .01 take some 200, plates of HEX27 with nu = 0.4999 and contrast 7e3 some 2000 (decisions/053).
  constexpr int kUsual = 500, kLast = 5000, kLook = 50, kFew = 10;
  const int steps = effort == SmoothingEffort::Last ? kLast : kUsual;
  const double first = imbalance_;
  const auto inverse = makeDiagonal();
  inverse->reciprocal(*inverse);
  const Vector start(*r_, Teuchos::Copy);
  Vector d(v_->getMap()), z(d.getMap()), p(d.getMap()), q(d.getMap()), w(d.getMap()), Dq(d.getMap()), best(d.getMap());
  double least = imbalance_, zw = 0;
  StiffnessProduct product;  // by elements at first
  // What cannot end within the bound at the rate of so far is left to the method, whose multiplications by F are then the cheaper way.  The rate of the
  // last half would save half of the steps that lead nowhere, and ends some that lead on (23 multiplications became 29).
  const auto isTooSlow = [&](int k) { return k >= kLook && k * std::log(least / enough) > (steps - k) * std::log(first / least); };
  for (int k = 0; k < steps && imbalance_ > enough && !isTooSlow(k); ++k) {
    if (k == kFew) product = assembledProduct(model_.systems.source());
    z.elementWiseMultiply(1.0, *inverse, *r_, 0.0);
    multiply(z, w, product);
    const double last = std::exchange(zw, z.dot(w)), beta = k == 0 ? 0.0 : zw / last;
    p.update(1.0, z, beta);
    q.update(1.0, w, beta);
    Dq.elementWiseMultiply(1.0, *inverse, q, 0.0);
    const double qDq = q.dot(Dq);
    if (!(zw > 0 && qDq > 0)) break;
    d.update(zw / qDq, p, 1.0);
    r_->update(-zw / qDq, q, 1.0);
    measure();
    if (imbalance_ < least) least = imbalance_, best.assign(d);
  }
  // Steps added to v one by one would each round it, which r of the recursion does not see: it said 8e-7 where 1.3e-5 was left.
  const Vector before(*v_, Teuchos::Copy);
  v_->update(1.0, best, 1.0);
  r_->assign(start);
  updateSince(before);
}

// r is that of `before`, and becomes that of v as its digits are.
void WrittenField::updateSince(const Vector& before) {
  Vector change(*v_, Teuchos::Copy);
  change.update(-1.0, before, 1.0);
  subtractForces(model_, change, *r_);
  project(*r_, Keep::UnsupportedMeans);
  measure();
}

}  // namespace Haptos
