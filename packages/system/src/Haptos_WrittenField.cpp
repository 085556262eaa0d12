// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_WrittenField.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <cmath>
#include <limits>

#include "Haptos_LocalSystems.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {

// u - v is not 0 on surfaces alone, and so K (u - v) is cheap and r 0 deep inside.
WrittenField::WrittenField(const AccuracyInput& model, const Vector& u, const Vector& residual)
    : model_(model), v_(new Vector(u, Teuchos::Copy)), r_(new Vector(u.getMap())), residual_(Teuchos::rcpFromRef(residual)) {
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
  Vector all(*residual_, Teuchos::Copy);
  project(all, Keep::UnsupportedMeans);
  all.update(1.0, *r_, 1.0);
  const auto nodal = model_.gather.sum(all);
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

// z_k = (2k - 3)/(2k + 1) z_{k-1} + (8k - 4)/(2k + 1) D^-1 r,  v += z_k,  r -= K z_k.
void WrittenField::smooth(double enough) {
  constexpr int kSweeps = 100;  // 30 left some contrasts of 1e4 at what they had, and Newton went on for 4 to 6 F more
  const auto diagonal = makeDiagonal();
  Vector z(v_->getMap());
  for (int k = 1; k <= kSweeps && imbalance_ > enough; ++k) {
    {
      const auto step = z.getDataNonConst(0);
      const auto r = r_->getData(0), d = diagonal->getData(0);
      for (Teuchos::Ordinal i = 0; i < step.size(); ++i) step[i] = ((2 * k - 3) * step[i] + (8 * k - 4) * r[i] / d[i]) / (2 * k + 1);
    }
    v_->update(1.0, z, 1.0);
    subtractForces(model_, z, *r_);
    project(*r_, Keep::UnsupportedMeans);
    measure();
  }
}

}  // namespace Haptos
