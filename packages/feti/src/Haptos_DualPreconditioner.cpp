// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualPreconditioner.hpp"

#include <Teuchos_Assert.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>

#include "Haptos_LocalSystems.hpp"
#include "Haptos_RowGram.hpp"
#include "Haptos_SurfaceOperators.hpp"

namespace Haptos {
namespace {

constexpr int kVectors = 64;

}  // namespace

DualPreconditioner::DualPreconditioner(RCP<const JumpOperator> jump, RCP<const LocalSystems> systems, SurfaceOperators surface)
    : jump_(std::move(jump)), systems_(std::move(systems)), gram_(std::make_unique<RowGram>(jump_->multipliers())),
      surface_(std::make_unique<SurfaceOperators>(std::move(surface))) {
  TEUCHOS_ASSERT(surface_->numClasses() == systems_->numClasses());
  const auto& offsets = jump_->primalOffsets();
  weights_.assign(offsets.back(), 0.0);
  for (const auto& entry : jump_->multipliers().overlapEntries())
    weights_[offsets[entry.subdomain - jump_->firstSubdomain()] + entry.dof] = 1.0 / entry.weight;
}

DualPreconditioner::~DualPreconditioner() = default;

// t := S t on the surfaces, classes with many members in blocks of columns: what BLAS 3 needs, with a bound on memory.
void DualPreconditioner::applyLocal(MultiVector& t) const {
  const auto& offsets = jump_->primalOffsets();
  const auto data = t.getDataNonConst(0);
  for (int c = 0; c < surface_->numClasses(); ++c) {
    const auto& members = systems_->members()[std::size_t(c)];
    const auto& dofs = surface_->boundary(c);
    const Eigen::Index nb = Eigen::Index(dofs.size());
    for (std::size_t first = 0; first < members.size(); first += kVectors) {
      const int width = int(std::min<std::size_t>(kVectors, members.size() - first));
      Eigen::MatrixXd X(nb, width), Y(nb, width);
      for (int j = 0; j < width; ++j)
        for (Eigen::Index i = 0; i < nb; ++i) X(i, j) = data[offsets[members[first + j]] + dofs[i]];
      surface_->apply(c, X, Y);
      for (int j = 0; j < width; ++j)
        for (Eigen::Index i = 0; i < nb; ++i) data[offsets[members[first + j]] + dofs[i]] = Y(i, j);
    }
  }
}

// t := W t
void DualPreconditioner::scale(MultiVector& t) const {
  for (std::size_t v = 0; v < t.getNumVectors(); ++v) {
    const auto data = t.getDataNonConst(v);
    for (std::size_t i = 0; i < weights_.size(); ++i) data[i] *= weights_[i];
  }
}

// t = B_D^T x = W B^T (B W B^T)^+ x
void DualPreconditioner::spread(const MultiVector& x, MultiVector& t) const {
  MultiVector z(x, Teuchos::Copy);
  spreadInPlace(z, t);
}

void DualPreconditioner::spreadInPlace(MultiVector& z, MultiVector& t) const {
  gram_->apply(z, z);
  jump_->apply(z, t, Teuchos::TRANS);
  scale(t);
}

// y = B_D t; t is scaled in place
void DualPreconditioner::collect(MultiVector& t, MultiVector& y) const {
  MultiVector z(y.getMap(), y.getNumVectors(), false);
  scale(t);
  jump_->apply(t, z);
  gram_->apply(z, y);
}

// A vector at a time stays in a processor's own memory; on several ranks each would cost its messages.
void DualPreconditioner::average(MultiVector& t) const {
  const std::size_t all = t.getNumVectors(), width = getRangeMap()->getComm()->getSize() == 1 ? 1 : all;
  MultiVector jumps(getRangeMap(), width, false), apart(t.getMap(), width, false);
  for (std::size_t first = 0; first < all; first += width) {
    const auto part = t.subViewNonConst(Teuchos::Range1D(Teuchos::Ordinal(first), Teuchos::Ordinal(first + width) - 1));
    jump_->apply(*part, jumps);
    spreadInPlace(jumps, apart);
    part->update(-1.0, apart, 1.0);
  }
}

// M x = B_D S B_D^T x, vector by vector in workspaces that stay
void DualPreconditioner::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  if (t_.is_null()) t_ = Teuchos::rcp(new MultiVector(jump_->getDomainMap(), 1, false));
  MultiVector z(x.getMap(), 1, false);
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    spread(*x.getVector(v), *t_);
    applyLocal(*t_);
    collect(*t_, z);
    y.getVectorNonConst(v)->update(alpha, z, beta);
    ++applications_;
  }
}

// Not exact: S by its diagonal, B W B^T by that of its inverse.  It weighs rows against each other, for which that is enough.
RCP<Vector> DualPreconditioner::diagonal() const {
  const auto& offsets = jump_->primalOffsets();
  std::vector<double> diagS(offsets.back(), 0.0);
  for (int c = 0; c < surface_->numClasses(); ++c) {
    const auto& d = surface_->diagonal(c);
    for (int member : systems_->members()[c])
      for (Eigen::Index i = 0; i < d.size(); ++i) diagS[offsets[member] + surface_->boundary(c)[std::size_t(i)]] = d[i];
  }
  // sum over the copies of (B W)^2 diag S, then the rows' own (B W B^T)^-1
  const auto& multipliers = jump_->multipliers();
  const RemoteRows& remoteRows = multipliers.remote();
  Vector remote(remoteRows.map());
  auto result = Teuchos::rcp(new Vector(multipliers.map()));
  {
    const auto mine = result->getDataNonConst(0), others = remote.getDataNonConst(0);
    const std::size_t owned = remoteRows.numOwned();
    for (const auto& entry : multipliers.overlapEntries()) {
      const double bw = entry.value / entry.weight;
      double& sum = std::size_t(entry.row) < owned ? mine[entry.row] : others[std::size_t(entry.row) - owned];
      sum += bw * bw * diagS[offsets[entry.subdomain - jump_->firstSubdomain()] + entry.dof];
    }
  }
  remoteRows.addToOwners(remote, *result);
  const auto data = result->getDataNonConst(0);
  const Eigen::VectorXd inverse = gram_->diagonal();
  for (Eigen::Index row = 0; row < inverse.size(); ++row) data[row] *= inverse[row] * inverse[row];
  return result;
}

}  // namespace Haptos
