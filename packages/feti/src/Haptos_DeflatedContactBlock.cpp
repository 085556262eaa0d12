// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DeflatedContactBlock.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <array>
#include <cmath>
#include <vector>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DenseSymmetric.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SparseBlocks.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {

namespace {

constexpr double kEntryOfSparse = 1.5;  // bytes read with its row number, in those of an entry

}  // namespace

// The same choice on all ranks, and on any number of them.
DeflatedContactBlock::DeflatedContactBlock(const RCP<const DualPreconditioner>& base, Eigen::SparseMatrix<double> Y, Eigen::MatrixXd C) : block_(base) {
  const auto sizes = sumOfAll(*getRangeMap()->getComm(), std::array<double, 2>{double(Y.nonZeros()), double(Y.rows())});
  if (kEntryOfSparse * sizes[0] + double(C.size()) >= sizes[1] * double(C.rows())) {
    W_ = timesColumns(Y, C.transpose());
    return;
  }
  Y_ = std::move(Y);
  C_ = std::move(C);
}

double DeflatedContactBlock::entriesRead() const {
  const double mine = isSparse() ? kEntryOfSparse * double(Y_.nonZeros()) + double(C_.size()) / double(getRangeMap()->getComm()->getSize()) : double(W_.size());
  return block_.entriesRead() + 2 * mine;
}

// W^T X, of unit vectors by few rows
Eigen::MatrixXd DeflatedContactBlock::transposedTimes(const Eigen::Ref<const Eigen::MatrixXd>& X) const {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < X.rows() && X.cols() > 1; ++i)
    if (!X.row(i).isZero(0)) rows.push_back(i);
  if (X.cols() == 1 || 2 * Eigen::Index(rows.size()) > X.rows()) return transposedProduct(W_, X);
  return Eigen::MatrixXd(W_(rows, Eigen::all)).transpose() * X(rows, Eigen::all);
}

// result -= alpha W W^T X
void DeflatedContactBlock::subtract(double alpha, const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Ref<Eigen::MatrixXd> result) const {
  const auto& comm = *getRangeMap()->getComm();
  if (isSparse()) {
    const auto g = sumOfAll(comm, timesColumns(Y_.transpose(), X));
    result -= timesColumns(Y_, transposedProduct(C_, product(C_, alpha * g)));
    return;
  }
  const auto g = sumOfAll(comm, transposedTimes(X));
  if (g.cols() == 1) addProduct(-alpha, W_, g.col(0), result.col(0));
  else result.noalias() -= W_ * (alpha * g);
}

void DeflatedContactBlock::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode, double alpha, double beta) const {
  using Columns = Eigen::OuterStride<>;
  block_.apply(x, y, mode, alpha, beta);
  const auto from = x.get1dView();
  const auto to = y.get1dViewNonConst();
  const Eigen::Index rows = Eigen::Index(x.getLocalLength());
  const Eigen::Map<const Eigen::MatrixXd, 0, Columns> X(from.getRawPtr(), rows, Eigen::Index(x.getNumVectors()), Columns(Eigen::Index(x.getStride())));
  Eigen::Map<Eigen::MatrixXd, 0, Columns> Y(to.getRawPtr(), rows, Eigen::Index(y.getNumVectors()), Columns(Eigen::Index(y.getStride())));
  subtract(alpha, X, Y);
}

namespace {

// G^-1 A G^-1, rows of G that depend on others left out
Eigen::MatrixXd betweenInverses(Eigen::MatrixXd G, const Eigen::MatrixXd& A) {
  constexpr double kDependent = 1e-10;
  Eigen::VectorXd d = G.diagonal();
  for (double& value : d) value = value > 0 ? 1 / std::sqrt(value) : 0.0;
  const PivotedCholesky factor(d.asDiagonal() * G * d.asDiagonal(), kDependent);
  const Eigen::MatrixXd half = factor.solve(d.asDiagonal() * A * d.asDiagonal()), whole = factor.solve(half.transpose());
  return d.asDiagonal() * (0.5 * (whole + whole.transpose())) * d.asDiagonal();
}

}  // namespace

// Of rows that ranks give, -1: none
DeflatedContactBlock::RowsOfAll DeflatedContactBlock::rowsOfAll(std::vector<int> rows) const {
  const auto& comm = *getRangeMap()->getComm();
  const int before = sumOfLower(comm, int(localNumElements(*getRangeMap())));
  for (int& row : rows) row = row < 0 ? -1 : before + row;
  rows = gatheredOnAll(comm, rows);
  RowsOfAll result{{}, {}, Eigen::Index(rows.size())};
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i] >= 0) result.rows.push_back(rows[i]), result.places.push_back(int(i));
  return result;
}

// W of all ranks' rows
Eigen::MatrixXd DeflatedContactBlock::rootOfAll() const { return block_.onAllRanks(isSparse() ? timesColumns(Y_, C_.transpose()) : W_); }

Eigen::MatrixXd DeflatedContactBlock::between(std::vector<int> rows) const {
  Eigen::MatrixXd M = block_.matrix();
  Lapack::subtractGram(rootOfAll().transpose(), M);
  M.triangularView<Eigen::StrictlyUpper>() = M.transpose();
  const RowsOfAll given = rowsOfAll(rows);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(given.count, given.count);
  result(given.places, given.places) = M(given.rows, given.rows);
  return result;
}

// B W S Z of the rows, from B_D S Z by their Gram matrix.
std::vector<Eigen::MatrixXd> DeflatedContactBlock::ofGroups(const std::vector<std::vector<int>>& groups) const {
  const auto& comm = *getRangeMap()->getComm();
  const ContactBlock::Columns spreads = block_.spreads(), G = block_.gram();
  const Eigen::MatrixXd GW = G * rootOfAll();
  std::vector<Eigen::MatrixXd> result;
  for (const auto& group : groups) {
    const auto [rows, places, count] = rowsOfAll(group);
    const Eigen::Index n = Eigen::Index(rows.size());
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n), Gram(n, n);
    block_.addEnergies(spreads, rows, A);
    A = sumOfAll(comm, A);
    const Eigen::MatrixXd part = GW(rows, Eigen::all);
    A.noalias() -= part * part.transpose();
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index i = 0; i < n; ++i) Gram(i, j) = G.coeff(rows[std::size_t(i)], rows[std::size_t(j)]);
    Eigen::MatrixXd& M = result.emplace_back(Eigen::MatrixXd::Zero(count, count));
    M(places, places) = betweenInverses(std::move(Gram), A);
  }
  return result;
}

}  // namespace Haptos
