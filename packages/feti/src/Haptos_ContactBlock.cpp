// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactBlock.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <set>

#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

bool isContact(RowKind kind) { return kind != RowKind::Gluing && kind != RowKind::Dirichlet; }

// S(c, c) by solves for the unit vectors of c, in blocks
Eigen::MatrixXd denseBlock(const DualPreconditioner& M, int congruenceClass, const std::vector<int>& c) {
  constexpr Eigen::Index kWidth = 64;
  const Eigen::Index n = M.boundarySize(congruenceClass), nc = Eigen::Index(c.size());
  Eigen::MatrixXd S(nc, nc);
  for (Eigen::Index first = 0; first < nc; first += kWidth) {
    const Eigen::Index width = std::min(kWidth, nc - first);
    Eigen::MatrixXd X = Eigen::MatrixXd::Zero(n, width), Y(n, width);
    for (Eigen::Index j = 0; j < width; ++j) X(c[std::size_t(first + j)], j) = 1;
    M.applySchur(congruenceClass, X, Y);
    for (Eigen::Index i = 0; i < nc; ++i) S.row(i).segment(first, width) = Y.row(c[std::size_t(i)]);
  }
  return 0.5 * (S + S.transpose());
}

}  // namespace

ContactBlock::ContactBlock(RCP<const DualPreconditioner> preconditioner) : preconditioner_(std::move(preconditioner)) {
  for (RowKind kind : preconditioner_->jump().multipliers().kinds()) isContactRow_.push_back(isContact(kind));
  findContactUnknowns();
  dense_.resize(unknowns_.size());
  for (std::size_t c = 0; c < unknowns_.size(); ++c)
    if (!unknowns_[c].empty() && int(unknowns_[c].size()) <= kLargestDense)
      dense_[c] = denseBlock(*preconditioner_, int(c), unknowns_[c]);
}

// Contact rows couple to all three unknowns of every copy of their nodes.
void ContactBlock::findContactUnknowns() {
  const JumpOperator& jump = preconditioner_->jump();
  const MultiplierMap& multipliers = jump.multipliers();
  Vector mine(multipliers.map()), overlap(multipliers.overlapMap());
  {
    const auto data = mine.getDataNonConst(0);
    for (std::size_t row = 0; row < isContactRow_.size(); ++row) data[row] = isContactRow_[row] ? 1.0 : 0.0;
  }
  overlap.doImport(mine, multipliers.importer(), Tpetra::INSERT);
  const auto flags = overlap.getData(0);
  std::vector<std::set<int>> nodes(jump.primalOffsets().size() - 1);
  for (const auto& entry : multipliers.overlapEntries())
    if (flags[entry.row] != 0.0) nodes[entry.subdomain - jump.firstSubdomain()].insert(entry.dof / 3);

  const auto& members = preconditioner_->systems().members();
  unknowns_.resize(members.size());
  for (std::size_t c = 0; c < members.size(); ++c) {
    std::set<int> all;
    for (int member : members[c]) {
      all.insert(nodes[member].begin(), nodes[member].end());
      if (!nodes[member].empty()) active_.push_back(member);
    }
    const auto& boundary = preconditioner_->boundary(int(c));
    for (std::size_t i = 0; i < boundary.size(); ++i)
      if (all.count(boundary[i] / 3) > 0) unknowns_[c].push_back(int(i));
  }
  std::sort(active_.begin(), active_.end());
}

void ContactBlock::applyLocal(MultiVector& t) const {
  const auto& offsets = preconditioner_->jump().primalOffsets();
  const auto data = t.getDataNonConst(0);
  for (int sub : active_) {
    const int c = preconditioner_->systems()[sub].congruenceClass;
    const auto& boundary = preconditioner_->boundary(c);
    const auto& unknowns = unknowns_[c];
    const bool all = dense_[c].size() == 0;
    const std::size_t n = all ? boundary.size() : unknowns.size();
    const auto dof = [&](std::size_t i) { return offsets[sub] + boundary[all ? i : std::size_t(unknowns[i])]; };
    Eigen::MatrixXd x(Eigen::Index(n), 1), y(Eigen::Index(n), 1);
    for (std::size_t i = 0; i < n; ++i) x(Eigen::Index(i), 0) = data[dof(i)];
    if (all) preconditioner_->applySchur(c, x, y);
    else y.noalias() = dense_[c] * x;
    for (std::size_t i = 0; i < n; ++i) data[dof(i)] = y(Eigen::Index(i), 0);
  }
}

void ContactBlock::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  const auto keepContact = [&](Vector& v) {
    const auto data = v.getDataNonConst(0);
    for (std::size_t row = 0; row < isContactRow_.size(); ++row)
      if (!isContactRow_[row]) data[row] = 0;
  };
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    Vector in(*x.getVector(v), Teuchos::Copy), out(getRangeMap());
    keepContact(in);
    preconditioner_->applyScaled(in, out, [this](MultiVector& t) { applyLocal(t); });
    keepContact(out);
    y.getVectorNonConst(v)->update(alpha, out, beta);
  }
}

}  // namespace Haptos
