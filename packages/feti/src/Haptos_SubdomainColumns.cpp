// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubdomainColumns.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <iterator>
#include <utility>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {
namespace {

constexpr double kNegligible = 1e-14;  // entries of a column, of its largest: round-off, which would make columns reach everything

using Indices = std::vector<Eigen::Index>;

// X(rows, :)
template <class Matrix>
Eigen::MatrixXd rowsOf(const Matrix& X, const Indices& rows) {
  Eigen::MatrixXd part(Eigen::Index(rows.size()), X.cols());
  for (Eigen::Index j = 0; j < part.cols(); ++j)
    for (std::size_t i = 0; i < rows.size(); ++i) part(Eigen::Index(i), j) = X(rows[i], j);
  return part;
}

// left^T X(rows, :), rows being those of `left`
template <class Left>
Eigen::MatrixXd productOnRows(const Left& left, const Indices& rows, const Eigen::MatrixXd& X) {
  if (Eigen::Index(rows.size()) == X.rows()) return transposedProduct(left, X);
  return transposedProduct(left, rowsOf(X, rows));
}

// X(rows, columns) := X(rows, columns) + factor part
template <class Matrix>
void addTo(Matrix& X, const Indices& rows, const Indices& columns, double factor, const Eigen::MatrixXd& part) {
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (std::size_t i = 0; i < rows.size(); ++i) X(rows[i], columns[j]) += factor * part(Eigen::Index(i), Eigen::Index(j));
}

Indices upTo(Eigen::Index n) {
  Indices all;
  for (Eigen::Index i = 0; i < n; ++i) all.push_back(i);
  return all;
}

// use(columns, X) of blocks side by side, X [unknowns of the subdomain x columns], some hundred columns at a time: many blocks have few
// columns, and a product with so few reads the other factor from memory.
template <class Blocks, class Use>
void forPanels(const Blocks& blocks, std::size_t unknowns, Use&& use) {
  constexpr std::size_t kColumns = 256;
  for (auto block = blocks.begin(); block != blocks.end();) {
    auto end = block;
    Indices columns;
    for (; end != blocks.end() && columns.size() < kColumns; ++end) columns.insert(columns.end(), end->columns.begin(), end->columns.end());
    Eigen::MatrixXd X = Eigen::MatrixXd::Zero(Eigen::Index(unknowns), Eigen::Index(columns.size()));
    for (Eigen::Index at = 0; block != end; at += Eigen::Index(block->columns.size()), ++block)
      for (std::size_t k = 0; k < block->rows.size(); ++k)
        X.row(block->rows[k]).segment(at, Eigen::Index(block->columns.size())) = block->matrix().row(Eigen::Index(k));
    use(columns, X);
  }
}

}  // namespace

SubdomainColumns::SubdomainColumns(std::vector<std::vector<Eigen::Index>> unknowns) : unknowns_(std::move(unknowns)) {
  for (std::size_t i = 0; i < unknowns_.size(); ++i) parts_.push_back(std::make_shared<Part>());
  isShared_.resize(parts_.size(), 0);
}

void SubdomainColumns::append(Eigen::Index width, const std::vector<Piece>& pieces) {
  Eigen::VectorXd negligible = Eigen::VectorXd::Zero(width);
  for (const Piece& piece : pieces)
    for (std::size_t j = 0; j < piece.columns.size() && piece.values.rows() > 0; ++j) {
      double& largest = negligible[piece.columns[j]];
      largest = std::max(largest, kNegligible * piece.values.col(Eigen::Index(j)).cwiseAbs().maxCoeff());
    }
  for (const Piece& piece : pieces)
    for (std::size_t j = 0; j < piece.columns.size() && !isShared_[piece.subdomain]; ++j) appendColumn(piece, Eigen::Index(j), negligible[piece.columns[j]]);
  cols_ += width;
}

// The column that comes next, to the last block if that is good for both. Columns that decay end in round-off somewhere, each elsewhere.
void SubdomainColumns::appendColumn(const Piece& piece, Eigen::Index j, double negligible) {
  const auto x = piece.values.col(j);
  Indices rows, places;
  for (Eigen::Index i = 0; i < x.size(); ++i)
    if (std::abs(x[i]) > negligible) rows.push_back(piece.rows[std::size_t(i)]), places.push_back(i);
  if (rows.empty()) return;
  Part& part = *parts_[piece.subdomain];
  if (part.empty() || !part.back().take(rows)) part.push_back({rows, {}, {}});
  Block& block = part.back();
  block.columns.push_back(cols_ + piece.columns[std::size_t(j)]);
  block.values.resize(block.values.size() + block.rows.size(), 0.0);
  double* const column = block.values.data() + block.values.size() - block.rows.size();
  for (std::size_t i = 0, k = 0; i < rows.size(); ++i, ++k) {
    while (block.rows[k] != rows[i]) ++k;
    column[k] = x[places[i]];
  }
}

// Whether a column with these rows may come to it, which then has them: if few zeros come with it.
bool SubdomainColumns::Block::take(const Indices& more) {
  if (std::includes(rows.begin(), rows.end(), more.begin(), more.end())) return true;
  Indices both;
  std::set_union(rows.begin(), rows.end(), more.begin(), more.end(), std::back_inserter(both));
  const std::size_t apart = rows.size() * columns.size() + more.size(), together = both.size() * (columns.size() + 1);
  if (4 * together > 5 * apart) return false;
  Eigen::MatrixXd wider = Eigen::MatrixXd::Zero(Eigen::Index(both.size()), Eigen::Index(columns.size()));
  for (std::size_t i = 0, k = 0; i < rows.size(); ++i, ++k) {
    while (both[k] != rows[i]) ++k;
    wider.row(Eigen::Index(k)) = matrix().row(Eigen::Index(i));
  }
  values.assign(wider.data(), wider.data() + wider.size());
  rows = std::move(both);
  return true;
}

void SubdomainColumns::copyTo(Eigen::Index first, Eigen::Index width, RowPanel& t) const {
  std::size_t begin = 0;  // of the subdomain's unknowns
  for (std::size_t i = 0; i < parts_.size(); begin += unknowns_[i].size(), ++i)
    for (const Block& block : *parts_[i]) {
      const auto columns = block.columns.begin();
      for (auto c = std::lower_bound(columns, block.columns.end(), first); c != block.columns.end() && *c < first + width; ++c)
        for (std::size_t k = 0; k < block.rows.size(); ++k)
          t.fill(begin + std::size_t(block.rows[k]))[*c - first] = block.matrix()(Eigen::Index(k), c - columns);
    }
}

Eigen::MatrixXd SubdomainColumns::transposedTimes(const ConstValues& t) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(cols_, t.cols());
  const Indices all = upTo(t.cols());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Eigen::MatrixXd x = rowsOf(t, unknowns_[i]);
    for (const Block& block : *parts_[i]) addTo(result, block.columns, all, 1.0, productOnRows(block.matrix(), block.rows, x));
  }
  return result;
}

void SubdomainColumns::subtractProduct(const Eigen::MatrixXd& a, Values t) const {
  const Indices all = upTo(t.cols());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(Eigen::Index(unknowns_[i].size()), t.cols());
    for (const Block& block : *parts_[i]) addTo(x, block.rows, all, 1.0, product(block.matrix(), rowsOf(a, block.columns)));
    addTo(t, unknowns_[i], all, -1.0, x);
  }
}

Eigen::MatrixXd SubdomainColumns::gram(const SubdomainColumns& C) const {
  TEUCHOS_ASSERT(C.parts_.size() == parts_.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(cols_, C.cols_);
  for (std::size_t i = 0; i < parts_.size(); ++i)
    forPanels(*C.parts_[i], unknowns_[i].size(), [&](const Indices& columns, const Eigen::MatrixXd& X) {
      for (const Block& left : *parts_[i]) addTo(result, left.columns, columns, 1.0, productOnRows(left.matrix(), left.rows, X));
    });
  return result;
}

// Ascending, those that are not zero on the subdomain
Indices SubdomainColumns::columnsOf(std::size_t subdomain) const {
  Indices columns;
  for (const Block& block : *parts_[subdomain]) columns.insert(columns.end(), block.columns.begin(), block.columns.end());
  std::sort(columns.begin(), columns.end());
  return columns;
}

// [unknowns of the subdomain x columns], which are ascending and have all that are not zero there
Eigen::MatrixXd SubdomainColumns::dense(std::size_t subdomain, const Indices& columns) const {
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(Eigen::Index(unknowns_[subdomain].size()), Eigen::Index(columns.size()));
  for (const Block& block : *parts_[subdomain]) {
    Indices places;
    for (const Eigen::Index column : block.columns) places.push_back(std::lower_bound(columns.begin(), columns.end(), column) - columns.begin());
    addTo(x, block.rows, places, 1.0, block.matrix());
  }
  return x;
}

// With T_o on the columns that X has there, and -A a_r on the others, M is made of T_o^T C T_o, -T_o^T C A a_r and a_r^T (A^T C A) a_r.
void SubdomainColumns::addEnergy(std::size_t subdomain, const SubdomainColumns& CA, const SubdomainColumns& X, const SubdomainColumns& CX,
                                 const Eigen::MatrixXd& a, Eigen::MatrixXd& M) const {
  const auto united = [](const Indices& l, const Indices& r) {
    Indices both;
    std::set_union(l.begin(), l.end(), r.begin(), r.end(), std::back_inserter(both));
    return both;
  };
  const Indices motions = united(columnsOf(subdomain), CA.columnsOf(subdomain)), own = united(X.columnsOf(subdomain), CX.columnsOf(subdomain)),
                all = upTo(X.cols_);
  Indices others;
  std::set_difference(all.begin(), all.end(), own.begin(), own.end(), std::back_inserter(others));
  const Eigen::MatrixXd A = dense(subdomain, motions), CAi = CA.dense(subdomain, motions), ao = a(motions, own), ar = a(motions, others);
  const Eigen::MatrixXd T = X.dense(subdomain, own) - product(A, ao), CT = CX.dense(subdomain, own) - product(CAi, ao);
  M(own, own) += transposedProduct(T, CT);
  if (others.empty()) return;
  const Eigen::MatrixXd between = product(transposedProduct(T, CAi), ar);
  M(own, others) -= between;
  M(others, own) -= between.transpose();
  M(others, others) += transposedProduct(ar, product(transposedProduct(A, CAi), ar));
}

// So many columns at a time as stay in a processor's own memory while all blocks are taken from them.
Eigen::MatrixXd SubdomainColumns::rest(std::size_t subdomain, const SubdomainColumns& X, const Eigen::MatrixXd& a) const {
  constexpr Eigen::Index kColumns = 64;
  Eigen::MatrixXd x = X.dense(subdomain, upTo(X.cols_));
  for (Eigen::Index first = 0; first < X.cols_; first += kColumns) {
    const Eigen::Index width = std::min(kColumns, X.cols_ - first);
    const Indices all = upTo(width);
    auto part = x.middleCols(first, width);
    for (const Block& block : *parts_[subdomain])
      addTo(part, block.rows, all, -1.0, block.matrix() * rowsOf(a.middleCols(first, width), block.columns));
  }
  return x;
}

}  // namespace Haptos
