// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_Assert.hpp>
#include <Teuchos_BLAS.hpp>
#include <algorithm>
#include <cstddef>
#include <iterator>
#include <type_traits>
#include <utility>
#include <vector>

#include "Haptos_SupernodalFactor.hpp"

namespace Haptos {
namespace {

// Where each of `some` is in `all`, both ascending and the second with all of the first.
std::vector<int> positionsOf(const std::vector<int>& some, const std::vector<int>& all) {
  std::vector<int> positions;
  positions.reserve(some.size());
  int at = 0;
  for (int value : some) {
    while (all[std::size_t(at)] != value) ++at;
    positions.push_back(at);
  }
  return positions;
}

void unite(const std::vector<int>& more, std::vector<int>& all) {
  std::vector<int> both;
  both.reserve(all.size() + more.size());
  std::set_union(all.begin(), all.end(), more.begin(), more.end(), std::back_inserter(both));
  all = std::move(both);
}

}  // namespace

// Y = L^-1 P B supernode by supernode, and S - Y^T Y. A column of B is not zero where it has entries and on what these pass values on to, their ancestors
// in the tree of supernodes: of a surface's columns few reach a supernode near another part of it. Rows of Y live from the first value that they
// are passed until they are multiplied.
template <class Scalar>
class SupernodalFactor<Scalar>::Gram {
 public:
  Gram(const SupernodalFactor& L, const Eigen::SparseMatrix<double>& B) : L_(L), fronts_(L.nodes_.size()) {
    findOwners();
    const double largest = std::is_same<Scalar, float>::value && B.nonZeros() > 0 ? B.coeffs().abs().maxCoeff() : 1.0;
    unit_ = largest > 0 ? largest : 1.0;
    takeEntries(B);
    for (std::size_t k = 0; k < fronts_.size(); ++k)
      if (L_.nodes_[k].rowsBelow > 0) unite(fronts_[k].columns, fronts_[parentOf(k)].columns);
  }

  void subtract(Eigen::MatrixXd& S) {
    for (std::size_t k = 0; k < fronts_.size(); ++k) {
      if (fronts_[k].columns.empty()) continue;
      open(k);
      Matrix& Y = fronts_[k].Y;
      L_.solveTriangle(L_.nodes_[k], Y.data(), int(Y.rows()), int(Y.cols()));
      multiply(fronts_[k], S);
      passOn(k);
      fronts_[k] = {};
    }
  }

 private:
  struct Entry {
    int row, column;  // of L, of B
    double value;
  };
  struct Front {
    std::vector<int> columns;  // of B that reach the supernode, ascending
    std::vector<Entry> entries;
    Matrix Y;  // [the supernode's columns x columns]; empty before the first value
  };

  std::size_t parentOf(std::size_t k) const { return std::size_t(owner_[std::size_t(L_.rowsBelow_[L_.nodes_[k].rows])]); }

  void findOwners() {
    owner_.resize(L_.perm_.size());
    for (std::size_t k = 0; k < fronts_.size(); ++k)
      std::fill_n(owner_.begin() + L_.nodes_[k].first, L_.nodes_[k].columns, int(k));
  }

  void takeEntries(const Eigen::SparseMatrix<double>& B) {
    std::vector<int> rowOf(L_.perm_.size());
    for (std::size_t i = 0; i < rowOf.size(); ++i) rowOf[std::size_t(L_.perm_[i])] = int(i);
    for (Eigen::Index j = 0; j < B.cols(); ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator it(B, j); it; ++it) {
        const int row = rowOf[std::size_t(it.row())];
        Front& front = fronts_[std::size_t(owner_[std::size_t(row)])];
        front.entries.push_back({row, int(j), it.value() / unit_});
        if (front.columns.empty() || front.columns.back() != int(j)) front.columns.push_back(int(j));
      }
  }

  // Its part of B is there from then on.
  void open(std::size_t k) {
    Front& front = fronts_[k];
    if (front.Y.size() > 0) return;
    front.Y = Matrix::Zero(L_.nodes_[k].columns, Eigen::Index(front.columns.size()));
    std::size_t at = 0;
    for (const Entry& entry : front.entries) {  // by columns
      while (front.columns[at] != entry.column) ++at;
      front.Y(entry.row - L_.nodes_[k].first, Eigen::Index(at)) += Scalar(entry.value);
    }
  }

  void multiply(const Front& front, Eigen::MatrixXd& S) {
    const int n = int(front.Y.rows()), m = int(front.Y.cols());
    if (Eigen::Index(product_.size()) < Eigen::Index(m) * m) product_.resize(std::size_t(m) * std::size_t(m));
    Teuchos::BLAS<int, Scalar>().SYRK(Teuchos::LOWER_TRI, Teuchos::TRANS, m, n, 1, front.Y.data(), n, 0, product_.data(), m);
    const double back = unit_ / L_.scale_ * (unit_ / L_.scale_);
    for (int j = 0; j < m; ++j) {
      double* to = S.data() + std::ptrdiff_t(front.columns[std::size_t(j)]) * S.outerStride();
      const Scalar* from = product_.data() + std::ptrdiff_t(j) * m;
      for (int i = j; i < m; ++i) to[front.columns[std::size_t(i)]] -= back * double(from[i]);
    }
  }

  // The rows below, ancestor by ancestor.
  void passOn(std::size_t k) {
    const Supernode& node = L_.nodes_[k];
    if (node.rowsBelow == 0) return;
    const Front& front = fronts_[k];
    const int m = int(front.Y.cols());
    const int* rows = L_.rowsBelow_.data() + node.rows;
    Matrix below(node.rowsBelow, m);
    L_.multiplyRectangle(node, front.Y.data(), node.columns, m, below.data(), node.rowsBelow);
    for (int i = 0, end = 0; i < node.rowsBelow; i = end) {
      const int ancestor = owner_[std::size_t(rows[i])];
      while (end < node.rowsBelow && owner_[std::size_t(rows[end])] == ancestor) ++end;
      open(std::size_t(ancestor));
      Front& to = fronts_[std::size_t(ancestor)];
      const int first = L_.nodes_[std::size_t(ancestor)].first;
      const std::vector<int> at = positionsOf(front.columns, to.columns);
      for (int j = 0; j < m; ++j)
        for (int l = i; l < end; ++l) to.Y(rows[l] - first, at[std::size_t(j)]) -= below(l, j);
    }
  }

  const SupernodalFactor& L_;
  std::vector<Front> fronts_;  // [supernodes]
  std::vector<int> owner_;     // [rows of L] supernode
  std::vector<Scalar> product_;
  double unit_ = 1;  // of B
};

template <class Scalar>
void SupernodalFactor<Scalar>::subtractGram(const Eigen::SparseMatrix<double>& B, Eigen::MatrixXd& S) const {
  TEUCHOS_ASSERT(B.rows() == rows() && S.rows() == B.cols() && S.cols() == B.cols());
  Gram(*this, B).subtract(S);
}

template void SupernodalFactor<double>::subtractGram(const Eigen::SparseMatrix<double>&, Eigen::MatrixXd&) const;
template void SupernodalFactor<float>::subtractGram(const Eigen::SparseMatrix<double>&, Eigen::MatrixXd&) const;

}  // namespace Haptos
