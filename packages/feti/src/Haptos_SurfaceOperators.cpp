// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SurfaceOperators.hpp"

namespace Haptos {
namespace {

// diag S exactly would cost a solve an unknown.
Eigen::VectorXd estimateDiagonal(const Eigen::SparseMatrix<double>& K, const std::vector<int>& boundary, PreconditionerKind kind) {
  constexpr double kSchurOfStiffness = 0.5;  // diag(S) / diag(K_bb), typical of surface nodes
  const double factor = kind == PreconditionerKind::Dirichlet ? kSchurOfStiffness : 1.0;
  Eigen::VectorXd d(Eigen::Index(boundary.size()));
  for (std::size_t i = 0; i < boundary.size(); ++i) d[Eigen::Index(i)] = factor * K.coeff(boundary[i], boundary[i]);
  for (Eigen::Index i = 0, end = 0; i < d.size(); i = end) {  // node by node: whatever the axes
    while (end < d.size() && boundary[std::size_t(end)] / 3 == boundary[std::size_t(i)] / 3) ++end;
    d.segment(i, end - i).setConstant(d.segment(i, end - i).mean());
  }
  return d;
}

}  // namespace

SurfaceOperators::SurfaceOperators(PreconditionerKind kind, LocalSolverMethod method, std::vector<char> inDouble)
    : kind_(kind), method_(method), inDouble_(std::move(inDouble)) {}

SurfaceOperators::SurfaceOperators(const LocalSystems& systems, const TouchedUnknowns& touched, PreconditionerKind kind,
                                   LocalSolverMethod method, std::vector<char> inDouble)
    : SurfaceOperators(kind, method, std::move(inDouble)) {
  while (numClasses() < systems.numClasses()) add(systems, touched);
}

// The dense S that K^+ came with, or solves with K_ii; in double by solves where soft motions live in the last digits of S.
void SurfaceOperators::add(const LocalSystems& systems, const TouchedUnknowns& touched) {
  const int c = numClasses(), first = systems.members()[c].front();
  const auto& K = systems.stiffness(c);
  const bool exact = std::size_t(first) < inDouble_.size() && inDouble_[std::size_t(first)];
  const auto* dense = kind_ == PreconditionerKind::Dirichlet ? systems.condensationOf(c) : nullptr;
  Class made;
  made.boundary = dense ? dense->boundary() : systems.boundaryOf(c, touched);
  made.diagonal = estimateDiagonal(K, made.boundary, kind_);
  if (!exact) made.condensed = dense;
  made.isDouble = exact;
  if (!made.condensed) {
    const FactorPrecision precision = exact ? FactorPrecision::Double : FactorPrecision::Single;
    made.schur = std::make_unique<SurfaceSchur>(kind_ == PreconditionerKind::Lumped
                                                  ? SurfaceSchur::lumped(K, made.boundary, precision)
                                                  : SurfaceSchur(K, systems[first].R(), made.boundary, method_, precision));
  }
  classes_.push_back(std::move(made));
}

void SurfaceOperators::apply(int congruenceClass, const Eigen::MatrixXd& X, Eigen::MatrixXd& Y) const {
  const Class& c = classes_[congruenceClass];
  if (c.condensed) c.condensed->applySchur(X, Y);
  else c.schur->apply(X, Y);
  ++c.applications;
}

FactorWork SurfaceOperators::work() const {
  FactorWork all;
  for (const Class& c : classes_) {
    const double dense = c.condensed ? c.condensed->work().schurBytes : 0;
    const FactorWork own = c.condensed ? FactorWork{0, dense / double(sizeof(float)), dense} : c.schur->work();
    all += {own.flops, own.entries, double(c.applications) * own.bytesRead};
  }
  return all;
}

Eigen::MatrixXd SurfaceOperators::block(int congruenceClass, const std::vector<int>& c) const {
  const Class& own = classes_[congruenceClass];
  return own.condensed ? own.condensed->schurBlock(c) : own.schur->block(c);
}

}  // namespace Haptos
