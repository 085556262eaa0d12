// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualPreconditioner.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>

#include "Haptos_SubdomainSurface.hpp"

namespace Haptos {
namespace {

constexpr int kBlock = 64;

LocalSchur makeSchur(const LocalSystem& system, const std::vector<int>& boundary, PreconditionerKind kind, LocalSolverMethod method,
                     bool exact) {
  const FactorPrecision precision = exact ? FactorPrecision::Double : FactorPrecision::Single;
  if (kind == PreconditionerKind::Lumped) return LocalSchur::lumped(system.K, boundary, precision);
  return {system.K, system.R, boundary, method, precision};
}

Eigen::VectorXd boundaryDiagonal(const Eigen::SparseMatrix<double>& K, const std::vector<int>& boundary) {
  Eigen::VectorXd d(Eigen::Index(boundary.size()));
  for (std::size_t i = 0; i < boundary.size(); ++i) d[Eigen::Index(i)] = K.coeff(boundary[i], boundary[i]);
  return d;
}

}  // namespace

DualPreconditioner::DualPreconditioner(RCP<const JumpOperator> jump, RCP<const LocalSystems> systems,
                                       const std::vector<Subdomain>& subdomains, PreconditionerKind kind,
                                       LocalSolverMethod method, const std::vector<char>& inDouble)
    : jump_(std::move(jump)), systems_(std::move(systems)), gram_(jump_->multipliers()), kind_(kind) {
  const auto& offsets = jump_->primalOffsets();
  weights_.assign(offsets.back(), 0.0);
  for (const auto& entry : jump_->multipliers().overlapEntries())
    weights_[offsets[entry.subdomain - jump_->firstSubdomain()] + entry.dof] = 1.0 / entry.weight;
  for (int c = 0; c < systems_->numClasses(); ++c) {
    const int first = systems_->members()[c].front();
    const LocalSystem& system = (*systems_)[first];
    const auto* condensed = kind == PreconditionerKind::Dirichlet ? systems_->condensationOf(c) : nullptr;
    boundary_.push_back(condensed ? condensed->boundary() : surfaceDofs(subdomains[first]));
    const bool exact = std::size_t(first) < inDouble.size() && inDouble[std::size_t(first)];
    if (exact) condensed = nullptr;
    condensed_.push_back(condensed);
    schur_.push_back(condensed ? nullptr : std::make_unique<LocalSchur>(makeSchur(system, boundary_.back(), kind, method, exact)));
  }
}

void DualPreconditioner::applySchur(int congruenceClass, const Eigen::MatrixXd& X, Eigen::MatrixXd& Y) const {
  if (condensed_[congruenceClass]) condensed_[congruenceClass]->applySchur(X, Y);
  else schur_[congruenceClass]->apply(X, Y);
}

Eigen::MatrixXd DualPreconditioner::schurBlock(int congruenceClass, const std::vector<int>& c) const {
  if (condensed_[congruenceClass]) return condensed_[congruenceClass]->schurBlock(c);
  return schur_[congruenceClass]->block(c);
}

void DualPreconditioner::applyLocal(MultiVector& t, const std::vector<std::vector<int>>& membersOfClass) const {
  const auto& offsets = jump_->primalOffsets();
  const auto data = t.getDataNonConst(0);
  for (std::size_t c = 0; c < boundary_.size(); ++c) {
    const auto& members = membersOfClass[c];
    const auto& dofs = boundary_[c];
    const Eigen::Index nb = Eigen::Index(dofs.size());
    for (std::size_t first = 0; first < members.size(); first += kBlock) {
      const int width = int(std::min<std::size_t>(kBlock, members.size() - first));
      Eigen::MatrixXd X(nb, width), Y(nb, width);
      for (int j = 0; j < width; ++j)
        for (Eigen::Index i = 0; i < nb; ++i) X(i, j) = data[offsets[members[first + j]] + dofs[i]];
      applySchur(int(c), X, Y);
      for (int j = 0; j < width; ++j)
        for (Eigen::Index i = 0; i < nb; ++i) data[offsets[members[first + j]] + dofs[i]] = Y(i, j);
    }
  }
}

void DualPreconditioner::scale(MultiVector& t) const {
  for (std::size_t v = 0; v < t.getNumVectors(); ++v) {
    const auto data = t.getDataNonConst(v);
    for (std::size_t i = 0; i < weights_.size(); ++i) data[i] *= weights_[i];
  }
}

void DualPreconditioner::spread(const MultiVector& x, MultiVector& t) const {
  MultiVector z(x.getMap(), x.getNumVectors());
  gram_.apply(x, z);
  jump_->apply(z, t, Teuchos::TRANS);
  scale(t);
}

void DualPreconditioner::collect(MultiVector& t, MultiVector& y) const {
  MultiVector z(y.getMap(), y.getNumVectors());
  scale(t);
  jump_->apply(t, z);
  gram_.apply(z, y);
}

void DualPreconditioner::applyOn(const std::vector<std::vector<int>>& members, const MultiVector& x, MultiVector& y) const {
  MultiVector t(jump_->getDomainMap(), 1);
  spread(x, t);
  applyLocal(t, members);
  collect(t, y);
}

void DualPreconditioner::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    MultiVector z(x.getMap(), 1);
    applyOn(systems_->members(), *x.getVector(v), z);
    y.getVectorNonConst(v)->update(alpha, z, beta);
    ++applications_;
  }
}

RCP<Vector> DualPreconditioner::diagonal() const {
  constexpr double kSchurOfStiffness = 0.5;  // diag(S) / diag(K_bb), typical of surface nodes
  const auto& offsets = jump_->primalOffsets();
  std::vector<double> diagS(offsets.back(), 0.0);
  for (std::size_t c = 0; c < boundary_.size(); ++c) {
    const auto& members = systems_->members()[c];
    const auto& K = (*systems_)[members.front()].K;
    Eigen::VectorXd d = boundaryDiagonal(K, boundary_[c]);
    if (kind_ == PreconditionerKind::Dirichlet) d *= kSchurOfStiffness;
    for (Eigen::Index i = 0; i + 2 < d.size(); i += 3) d.segment<3>(i).setConstant(d.segment<3>(i).mean());  // whatever the axes
    for (int member : members)
      for (Eigen::Index i = 0; i < d.size(); ++i) diagS[offsets[member] + boundary_[c][i]] = d[i];
  }
  // sum over the copies of (B W)^2 diag S, then the rows' own (B W B^T)^-1
  const auto& multipliers = jump_->multipliers();
  Vector overlap(multipliers.overlapMap());
  {
    const auto data = overlap.getDataNonConst(0);
    for (const auto& entry : multipliers.overlapEntries()) {
      const double bw = entry.value / entry.weight;
      data[entry.row] += bw * bw * diagS[offsets[entry.subdomain - jump_->firstSubdomain()] + entry.dof];
    }
  }
  auto result = Teuchos::rcp(new Vector(multipliers.map()));
  result->doExport(overlap, multipliers.importer(), Tpetra::ADD);
  const auto data = result->getDataNonConst(0);
  for (Eigen::Index row = 0; row < gram_.inverse().rows(); ++row) {
    const double g = gram_.inverse().coeff(row, row);
    data[row] *= g * g;
  }
  return result;
}

}  // namespace Haptos
