// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ChangingCoarseProblem.hpp"

#include <Teuchos_Comm.hpp>
#include <algorithm>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_DenseSymmetric.hpp"
#include "Haptos_Exchange.hpp"

namespace Haptos {
namespace {

using Eigen::Index;
using SparseMatrix = Eigen::SparseMatrix<double>;

constexpr Index kLargestDense = 6000;     // changing unknowns: 288 MB and some seconds for a factor
constexpr Index kLargestProduct = 8 << 20;  // entries of Z that are kept

std::vector<int> unite(const Communicator& comm, std::vector<int> mine) {
  if (comm.getSize() > 1) {
    ByteWriter writer;
    writer.write(mine);
    mine.clear();
    for (const auto& message : gatherOnAll(comm, writer.take())) {
      const auto theirs = ByteReader(message).readVector<int>();
      mine.insert(mine.end(), theirs.begin(), theirs.end());
    }
  }
  std::sort(mine.begin(), mine.end());
  mine.erase(std::unique(mine.begin(), mine.end()), mine.end());
  return mine;
}

SparseMatrix extract(const SparseMatrix& A, const std::vector<int>& rows, const std::vector<int>& columns) {
  std::vector<int> newRow(std::size_t(A.rows()), -1);
  for (std::size_t i = 0; i < rows.size(); ++i) newRow[std::size_t(rows[i])] = int(i);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (SparseMatrix::InnerIterator it(A, columns[j]); it; ++it)
      if (newRow[std::size_t(it.row())] >= 0) entries.emplace_back(newRow[std::size_t(it.row())], int(j), it.value());
  SparseMatrix part(Index(rows.size()), Index(columns.size()));
  part.setFromTriplets(entries.begin(), entries.end());
  return part;
}

Eigen::VectorXd gather(const Eigen::VectorXd& x, const std::vector<int>& at) {
  Eigen::VectorXd part(Index(at.size()));
  for (std::size_t i = 0; i < at.size(); ++i) part[Index(i)] = x[at[i]];
  return part;
}

}  // namespace

ChangingCoarseProblem::ChangingCoarseProblem(const Communicator& comm, const CoarseRows& C, const std::vector<double>& q,
                                             const CoarseProblem::Holds& holds, std::vector<int> changing)
    : comm_(comm), size_(C.cols()), holds_(holds), place_(std::size_t(C.cols()), -1) {
  CoarseBlocks mine;
  mine.addGram(C, q);
  base_ = mine.sumOverRanks(comm);
  holdScale_ = base_.largestDiagonal();
  for (const auto& w : holds)  // held apart, A_oo has no motion of a whole body
    for (Eigen::SparseVector<double>::InnerIterator i(w); i; ++i) changing.push_back(int(i.index()) / CoarseBlocks::kModes);
  for (int subdomain : unite(comm, std::move(changing)))
    for (int m = 0; m < CoarseBlocks::kModes; ++m) {
      place_[std::size_t(CoarseBlocks::kModes * subdomain + m)] = int(changing_.size());
      changing_.push_back(CoarseBlocks::kModes * subdomain + m);
    }
  for (int i = 0; i < int(size_); ++i)
    if (place_[std::size_t(i)] < 0) fixed_.push_back(i);
  if (Index(changing_.size()) > kLargestDense || !eliminateFixed()) {
    fixed_.clear();
    changing_.clear();
  } else {
    base_ = {};
  }
}

bool ChangingCoarseProblem::eliminateFixed() {
  const SparseMatrix A = base_.toMatrix(size_, holds_, holdScale_);
  const SparseMatrix Acc = extract(A, changing_, changing_);
  Aoc_ = extract(A, fixed_, changing_);
  if (!fixed_.empty()) {
    try {
      fixedFactor_ = std::make_unique<LocalSolverFactor>(extract(A, fixed_, fixed_), LocalSolverMethod::Automatic);
    } catch (const std::runtime_error&) {
      return false;  // a hinge between subdomains that contact alone holds
    }
  }
  formSchur(Aoc_, Acc);
  return true;
}

void ChangingCoarseProblem::formSchur(const SparseMatrix& Aoc, const SparseMatrix& Acc) {
  constexpr Index kBlock = 96;
  const Index no = Aoc.rows(), nc = Aoc.cols();
  schur_ = Acc;
  if (no == 0) return;
  const bool keep = no * nc <= kLargestProduct;
  if (keep) Z_.resize(no, nc);
  for (Index first = 0; first < nc; first += kBlock) {
    const Index width = std::min(kBlock, nc - first);
    const Eigen::MatrixXd b = Aoc.middleCols(first, width);
    Eigen::MatrixXd z(no, width);
    fixedFactor_->solve(b, z);
    schur_.middleCols(first, width) -= Aoc.transpose() * z;
    if (keep) Z_.middleCols(first, width) = z;
  }
}

void ChangingCoarseProblem::update(const CoarseBlocks& delta) {
  const CoarseBlocks all = delta.sumOverRanks(comm_);
  if (changing_.empty()) {
    CoarseBlocks whole = base_;
    whole.add(all);
    wholeFactor_ = std::make_unique<LocalSolverFactor>(whole.toMatrix(size_, holds_, holdScale_), LocalSolverMethod::Automatic);
    return;
  }
  factor_ = schur_;
  all.forEach([&](int row, int column, double value) { factor_(place_[std::size_t(row)], place_[std::size_t(column)]) += value; });
  TEUCHOS_TEST_FOR_EXCEPTION(!Lapack::choleskyInPlace(factor_), std::runtime_error,
                             "ChangingCoarseProblem: the coarse matrix of " << size_ << " unknowns is not positive definite");
}

Eigen::VectorXd ChangingCoarseProblem::solve(const Eigen::VectorXd& b) const {
  if (wholeFactor_) {
    Eigen::MatrixXd x(b.rows(), 1);
    wholeFactor_->solve(b, x);
    return x;
  }
  const Eigen::VectorXd bo = gather(b, fixed_);
  Eigen::VectorXd xc = gather(b, changing_), xo(bo.size());
  if (fixedFactor_) {
    fixedFactor_->solve(bo, xo);
    xc -= Aoc_.transpose() * xo;
  }
  const auto L = factor_.triangularView<Eigen::Lower>();
  L.solveInPlace(xc);
  L.transpose().solveInPlace(xc);
  if (Z_.size() > 0) {
    xo -= Z_ * xc;
  } else if (fixedFactor_) {
    Eigen::VectorXd correction(xo.size());
    fixedFactor_->solve(Aoc_ * xc, correction);
    xo -= correction;
  }
  Eigen::VectorXd x(size_);
  for (std::size_t i = 0; i < fixed_.size(); ++i) x[fixed_[i]] = xo[Index(i)];
  for (std::size_t i = 0; i < changing_.size(); ++i) x[changing_[i]] = xc[Index(i)];
  return x;
}

}  // namespace Haptos
