// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DeflatedContactBlock.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <vector>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {

// W^T X, of unit vectors by few rows
Eigen::MatrixXd DeflatedContactBlock::transposedTimes(const Eigen::Ref<const Eigen::MatrixXd>& X) const {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < X.rows() && X.cols() > 1; ++i)
    if (!X.row(i).isZero(0)) rows.push_back(i);
  if (X.cols() == 1 || 2 * Eigen::Index(rows.size()) > X.rows()) return transposedProduct(W_, X);
  return Eigen::MatrixXd(W_(rows, Eigen::all)).transpose() * X(rows, Eigen::all);
}

void DeflatedContactBlock::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode, double alpha, double beta) const {
  using Columns = Eigen::OuterStride<>;
  block_.apply(x, y, mode, alpha, beta);
  const auto from = x.get1dView();
  const auto to = y.get1dViewNonConst();
  const Eigen::Map<const Eigen::MatrixXd, 0, Columns> X(from.getRawPtr(), W_.rows(), Eigen::Index(x.getNumVectors()), Columns(Eigen::Index(x.getStride())));
  Eigen::Map<Eigen::MatrixXd, 0, Columns> Y(to.getRawPtr(), W_.rows(), Eigen::Index(y.getNumVectors()), Columns(Eigen::Index(y.getStride())));
  const auto g = sumOfAll(*getRangeMap()->getComm(), transposedTimes(X));
  if (g.cols() == 1) addProduct(-alpha, W_, g.col(0), Y.col(0));
  else Y.noalias() -= W_ * (alpha * g);
}

}  // namespace Haptos
