// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_WrittenField.hpp"

#include <Eigen/SparseCore>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <cmath>
#include <limits>
#include <memory>
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
  Vector change(*v_, Teuchos::Copy);
  change.update(-1.0, u, 1.0);
  subtractForces(model_, change, *r_);
  project(*r_, Keep::UnsupportedMeans);
  measure();
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

// z = D^-1 r,  p = z + beta p,  v += alpha p,  r -= alpha K p.  Copies of v are equal and share r, so that sums over copies are those over nodes.
void WrittenField::smooth(double enough, SmoothingEffort effort) {
  // With contrasts of 1e6 some 10 are taken, with nu = 0.4999 some 60, with plates of aspect 100 some 400, with nu = 0.4999 and contrast 300 a
  // thousand.
  constexpr int kUsual = 500, kLast = 5000, kLook = 50, kFew = 10;
  const int steps = effort == SmoothingEffort::Last ? kLast : kUsual;
  const double first = imbalance_;
  const auto diagonal = makeDiagonal();
  diagonal->reciprocal(*diagonal);
  Vector z(v_->getMap()), p(v_->getMap()), Kp(v_->getMap());
  Best best{Teuchos::rcp(new Vector(*v_, Teuchos::Copy)), imbalance_, worstNode_};
  StiffnessProduct multiply;  // by elements at first
  double rz = 0;
  // What cannot end within the bound at the rate of so far is left to the method, whose multiplications by F are then the cheaper way.  The rate of the
  // last half would save half of the steps that lead nowhere, and ends some that lead on (23 multiplications became 29).
  const auto isTooSlow = [&](int k) { return k >= kLook && k * std::log(best.imbalance / enough) > (steps - k) * std::log(first / best.imbalance); };
  for (int k = 0; k < steps && imbalance_ > enough && !isTooSlow(k); ++k) {
    if (k == kFew) multiply = assembledProduct(model_.systems.source());
    z.elementWiseMultiply(1.0, *diagonal, *r_, 0.0);
    const double before = rz;
    rz = r_->dot(z);
    p.update(1.0, z, k == 0 ? 0.0 : rz / before);
    Kp.putScalar(0.0);
    subtractForces(model_, p, Kp, multiply);
    project(Kp, Keep::UnsupportedMeans);
    const double pKp = -p.dot(Kp);
    if (!(pKp > 0)) break;
    v_->update(rz / pKp, p, 1.0);
    r_->update(rz / pKp, Kp, 1.0);
    measure();
    if (imbalance_ < best.imbalance) best = {Teuchos::rcp(new Vector(*v_, Teuchos::Copy)), imbalance_, worstNode_};
  }
  v_ = best.v;  // the residual of conjugate gradients goes up and down
  imbalance_ = best.imbalance;
  worstNode_ = best.worstNode;
}

}  // namespace Haptos
