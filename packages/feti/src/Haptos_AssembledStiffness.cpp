// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_AssembledStiffness.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {

std::vector<AssembledStiffness::Pair> AssembledStiffness::pairsOf(const Parts& parts) {
  std::vector<std::map<int, Eigen::Vector3d>> columns(std::size_t(parts.contactPairs + parts.tiedPairs));
  for (const auto& entry : parts.C) {
    const auto at = columns[std::size_t(entry.row() / 3)].try_emplace(entry.col(), Eigen::Vector3d::Zero()).first;
    at->second[entry.row() % 3] += entry.value();
  }
  std::vector<Pair> pairs;
  for (const auto& ofPair : columns) {
    Pair& pair = pairs.emplace_back();
    pair.C.resize(3, Eigen::Index(ofPair.size()));
    for (const auto& [unknown, column] : ofPair) {
      pair.C.col(Eigen::Index(pair.unknowns.size())) = column;
      pair.unknowns.push_back(unknown);
    }
  }
  return pairs;
}

Eigen::SparseMatrix<double> AssembledStiffness::patternOf(Parts& parts, const std::vector<Pair>& pairs) {
  for (const Pair& pair : pairs)
    for (const int i : pair.unknowns)
      for (const int j : pair.unknowns) parts.K.emplace_back(i, j, 0.0);
  Eigen::SparseMatrix<double> A(parts.size, parts.size);
  A.setFromTriplets(parts.K.begin(), parts.K.end());
  parts.K = {};
  A.makeCompressed();
  return A;
}

AssembledStiffness::AssembledStiffness(Parts parts)
    : numberOf_(std::move(parts.numberOf)),
      contactRows_(3 * parts.contactPairs),
      pairs_(pairsOf(parts)),
      A_(patternOf(parts, pairs_)),
      closing_(LocalSolverFactor::analysed(A_, LocalSolverMethod::Automatic)) {
  findPlaces();
  findClosingD();
}

void AssembledStiffness::findPlaces() {
  const int *rows = A_.innerIndexPtr(), *starts = A_.outerIndexPtr();
  for (Pair& pair : pairs_)
    for (const int column : pair.unknowns)
      for (const int row : pair.unknowns) pair.places.push_back(int(std::lower_bound(rows + starts[column], rows + starts[column + 1], row) - rows));
}

// Some hundred times as stiff as what the rows meet of K: more digits are lost by more, more steps are taken by less.
void AssembledStiffness::findClosingD() {
  constexpr double kStiff = 300;
  const Eigen::VectorXd diagonal = A_.diagonal();
  closingD_ = zeros();
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const Eigen::Vector3d soft = pairs_[p].C.cwiseAbs2() * diagonal(pairs_[p].unknowns).cwiseInverse();
    closingD_.segment<3>(3 * Eigen::Index(p)) = (soft.array() > 0).select(kStiff * soft.cwiseInverse(), 0.0);
  }
}

// What nothing holds may have pivots of round-off: it shows where all move alike.
void AssembledStiffness::factor() {
  constexpr double kUseless = 1e-3;
  const Eigen::SparseMatrix<double> A = withD({});
  closing_.renew(A);
  const Eigen::VectorXd alike = Eigen::VectorXd::Ones(size()), forces = A * alike;
  Eigen::VectorXd u(size());
  closing_.solve(forces, u);
  if (!((u - alike).cwiseAbs().maxCoeff() <= kUseless)) throw UselessFactor("Nothing holds all bodies together.");
}

// Pairs beyond those of D are closed.
Eigen::SparseMatrix<double> AssembledStiffness::withD(const std::vector<Eigen::Matrix3d>& D) const {
  Eigen::SparseMatrix<double> A = A_;
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const Pair& pair = pairs_[p];
    const Eigen::Matrix3d block = p < D.size() ? D[p] : Eigen::Matrix3d(closingD_.segment<3>(3 * Eigen::Index(p)).asDiagonal());
    const Eigen::MatrixXd product = pair.C.transpose() * block * pair.C;
    for (std::size_t k = 0; k < pair.places.size(); ++k) A.valuePtr()[pair.places[k]] += product.data()[k];
  }
  return A;
}

Eigen::VectorXd AssembledStiffness::jumps(const Eigen::VectorXd& u) const {
  Eigen::VectorXd s(numRows());
  for (std::size_t p = 0; p < pairs_.size(); ++p) s.segment<3>(3 * Eigen::Index(p)) = pairs_[p].C * u(pairs_[p].unknowns);
  return s;
}

Eigen::VectorXd AssembledStiffness::forces(const Eigen::VectorXd& y) const {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(size());
  for (std::size_t p = 0; p < pairs_.size(); ++p) f(pairs_[p].unknowns) += pairs_[p].C.transpose() * y.segment<3>(3 * Eigen::Index(p));
  return f;
}

// (K + C^T D C) u = f + C^T y, y such that rows of pairs from `from` on have the jumps that are given, as far as displacements have something to do with
// them: the method of multipliers, of which each step leaves what K is beside D.  It ends where round-off does.
AssembledStiffness::State AssembledStiffness::close(const LocalSolverFactor& factor, const Eigen::VectorXd& f, const Eigen::VectorXd& y,
                                                    const Eigen::VectorXd& given, Eigen::Index from) const {
  constexpr int kSteps = 20;
  constexpr double kClosed = 1e-14, kFalls = 0.5;
  State state{Eigen::VectorXd(size()), y};
  double least = std::numeric_limits<double>::infinity();
  for (int step = 0;; ++step) {
    const Eigen::VectorXd rhs = f + forces(state.y);
    factor.solve(rhs, state.u);
    Eigen::VectorXd gap = (closingD_.array() > 0).select(given - jumps(state.u), 0.0);
    gap.head(from).setZero();
    const double open = gap.size() > 0 ? gap.cwiseAbs().maxCoeff() : 0.0;
    const double length = state.u.cwiseAbs().maxCoeff() + (given.size() > 0 ? given.cwiseAbs().maxCoeff() : 0.0);
    if (step == kSteps || !(open > kClosed * length) || open > kFalls * least) return state;
    least = open;
    state.y += closingD_.cwiseProduct(gap);
  }
}

Eigen::VectorXd AssembledStiffness::relax(const Eigen::VectorXd& f) const {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(size());
  for (std::size_t i = 0; i < numberOf_.size(); ++i)
    if (numberOf_[i] >= 0) sums[numberOf_[i]] -= f[Eigen::Index(i)];
  const Eigen::VectorXd w = close(closing_, sums, zeros(), zeros(), 0).u;
  Eigen::VectorXd copies = Eigen::VectorXd::Zero(f.size());
  for (std::size_t i = 0; i < numberOf_.size(); ++i)
    if (numberOf_[i] >= 0) copies[Eigen::Index(i)] = w[numberOf_[i]];
  return copies;
}

Eigen::VectorXd AssembledStiffness::forcesOf(const Eigen::VectorXd& given) const {
  Eigen::VectorXd wanted = zeros();
  wanted.head(contactRows_) = given;
  const State state = close(closing_, Eigen::VectorXd::Zero(size()), closingD_.cwiseProduct(wanted), wanted, 0);
  return (state.y - closingD_.cwiseProduct(jumps(state.u))).head(contactRows_);
}

// With G = C (K + C^T D C)^-1 C^T forces of jumps are (G^-1 - D) jumps, of tied pairs too, which have none.  Where round-off leaves G without an inverse
// each jump is solved for by itself.
Eigen::MatrixXd AssembledStiffness::contactMatrix() const {
  std::vector<Eigen::Index> felt;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t p = 0; p < pairs_.size(); ++p)
    for (Eigen::Index a = 0; a < 3; ++a) {
      const Eigen::Index row = 3 * Eigen::Index(p) + a;
      if (!(closingD_[row] > 0)) continue;
      for (std::size_t k = 0; k < pairs_[p].unknowns.size(); ++k) entries.emplace_back(pairs_[p].unknowns[k], int(felt.size()), pairs_[p].C(a, Eigen::Index(k)));
      felt.push_back(row);
    }
  Eigen::SparseMatrix<double> CT(size(), Eigen::Index(felt.size()));
  CT.setFromTriplets(entries.begin(), entries.end());
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(CT.cols(), CT.cols());
  closing_.subtractGram(CT, G);
  Eigen::MatrixXd M = inverseByCholesky(-G);
  if (M.size() == 0) return contactMatrixByColumns();
  M.diagonal() -= closingD_(felt);
  const Eigen::Index ofContact = std::lower_bound(felt.begin(), felt.end(), contactRows_) - felt.begin();
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(contactRows_, contactRows_);
  felt.resize(std::size_t(ofContact));
  result(felt, felt) = M.topLeftCorner(ofContact, ofContact);
  return result;
}

Eigen::MatrixXd AssembledStiffness::contactMatrixByColumns() const {
  Eigen::MatrixXd M(contactRows_, contactRows_);
  for (Eigen::Index j = 0; j < contactRows_; ++j) M.col(j) = forcesOf(Eigen::VectorXd::Unit(contactRows_, j));
  return M;
}

void AssembledStiffness::setD(const std::vector<Eigen::Matrix3d>& D) {
  if (!given_) given_ = std::make_unique<LocalSolverFactor>(LocalSolverFactor::analysed(A_, LocalSolverMethod::Automatic));
  given_->renew(withD(D));
}

Eigen::VectorXd AssembledStiffness::solveWithD(const Eigen::VectorXd& y) const {
  Eigen::VectorXd all = zeros();
  all.head(contactRows_) = y;
  const State state = close(*given_, Eigen::VectorXd::Zero(size()), all, zeros(), contactRows_);
  return jumps(state.u).head(contactRows_);
}

}  // namespace Haptos
