// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoarseSchur.hpp"

#include <Teuchos_Assert.hpp>
#include <Teuchos_BLAS.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "Haptos_DenseSymmetric.hpp"
#include "Haptos_Error.hpp"

#if defined(HAPTOS_HAVE_CHOLMOD)
#include <cholmod.h>
#endif

namespace Haptos {
namespace {

// Unknowns of a list of subdomains, in its order: all six stay together in any order of elimination.
std::vector<int> expanded(const std::vector<int>& subdomains) {
  std::vector<int> unknowns;
  unknowns.reserve(subdomains.size() * kCoarseModes);
  for (int s : subdomains)
    for (int a = 0; a < kCoarseModes; ++a) unknowns.push_back(kCoarseModes * s + a);
  return unknowns;
}

}  // namespace

#if defined(HAPTOS_HAVE_CHOLMOD)
namespace {

struct CholmodCommon : cholmod_common {
  CholmodCommon() : cholmod_common() {
    cholmod_start(this);
    print = 0;  // failures are reported by exceptions
  }
  ~CholmodCommon() { cholmod_finish(this); }
};

struct CompressedColumns {
  std::vector<int> starts{0}, rows;
  std::vector<double> values;

  cholmod_sparse view(int stype) {
    cholmod_sparse a{};
    a.nrow = a.ncol = starts.size() - 1;
    a.nzmax = rows.size();
    a.p = starts.data();
    a.i = rows.data();
    a.x = values.data();
    a.stype = stype;
    a.itype = CHOLMOD_INT;
    a.xtype = values.empty() ? CHOLMOD_PATTERN : CHOLMOD_REAL;
    a.dtype = CHOLMOD_DOUBLE;
    a.sorted = a.packed = 1;
    return a;
  }
};

// The upper triangle of the graph of subdomains, as their numbers go; -1: left out.
CompressedColumns graphOf(const CoarseSchur::Parts& A, const std::vector<int>& number) {
  std::vector<std::uint64_t> keys;  // a row of the lower triangle is a column of the upper one
  for (const CoarseBlocks* part : A)
    for (const auto& [key, block] : part->blocks()) keys.push_back(key);
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  CompressedColumns graph;
  for (std::size_t s = 0, k = 0; s < number.size(); ++s) {
    for (; k < keys.size() && CoarseBlocks::row(keys[k]) == int(s); ++k) {
      const int neighbour = number[std::size_t(CoarseBlocks::column(keys[k]))];
      if (number[s] >= 0 && neighbour >= 0) graph.rows.push_back(neighbour);
    }
    if (number[s] >= 0) graph.starts.push_back(int(graph.rows.size()));
  }
  return graph;
}

// By minimum degree, constrained so that the last come last (CAMD).
std::vector<int> orderByDegree(const CoarseSchur::Parts& A, int subdomains, const std::vector<int>& last, CholmodCommon& common) {
  std::vector<int> all(std::size_t(subdomains), 0), isLast(all), order(all);
  std::iota(all.begin(), all.end(), 0);
  for (int s : last) isLast[std::size_t(s)] = 1;
  CompressedColumns graph = graphOf(A, all);
  auto view = graph.view(1);
  const bool ordered = cholmod_camd(&view, nullptr, 0, isLast.data(), order.data(), &common);
  TEUCHOS_TEST_FOR_EXCEPTION(!ordered, std::runtime_error, "CHOLMOD: ordering " << subdomains << " subdomains failed");
  return order;
}

// The others by nested dissection of their own graph, the last behind them as they are; empty if that fails.
std::vector<int> orderByDissection(const CoarseSchur::Parts& A, int subdomains, const std::vector<int>& last, CholmodCommon& common) {
  std::vector<int> number(std::size_t(subdomains), 0), others;
  for (int s : last) number[std::size_t(s)] = -1;
  for (int s = 0; s < subdomains; ++s) {
    if (number[std::size_t(s)] < 0) continue;
    number[std::size_t(s)] = int(others.size());
    others.push_back(s);
  }
  CompressedColumns graph = graphOf(A, number);
  auto view = graph.view(1);
  std::vector<int> order(others.size());
  constexpr int kPostorder = 1;
  if (!cholmod_metis(&view, nullptr, 0, kPostorder, order.data(), &common)) return {};
  for (int& s : order) s = others[std::size_t(s)];
  order.insert(order.end(), last.begin(), last.end());
  return order;
}

// Subdomains, not unknowns, are ordered: a graph with a sixth of the nodes and a thirty-sixth of the edges.
std::vector<int> orderSubdomains(const CoarseSchur::Parts& A, int subdomains, const std::vector<int>& last, CholmodCommon& common) {
  constexpr std::size_t kMany = 1000;  // up to here both orders fill in alike
  std::vector<int> order;
  if (std::size_t(subdomains) - last.size() > kMany) order = orderByDissection(A, subdomains, last, common);
  return order.empty() ? orderByDegree(A, subdomains, last, common) : order;
}

// The lower triangle of A(order, order), as CHOLMOD takes it without moving anything.
class OrderedMatrix {
 public:
  OrderedMatrix(const CoarseSchur::Parts& A, const std::vector<int>& order);
  void makeIndefinite(int column);
  cholmod_sparse view() { return columns_.view(-1); }

 private:
  void makePattern(const CoarseSchur::Parts& A);
  void add(std::uint64_t key, const CoarseBlocks::Block& block);

  std::vector<int> position_;                  // of a subdomain
  std::vector<std::vector<int>> rowsOfColumn_;  // of blocks, ascending, from the diagonal on
  CompressedColumns columns_;
};

// A(order, order): a block (s, t) goes to column min(position), transposed where the order turns it over.
OrderedMatrix::OrderedMatrix(const CoarseSchur::Parts& A, const std::vector<int>& order)
    : position_(order.size()), rowsOfColumn_(order.size()) {
  for (std::size_t i = 0; i < order.size(); ++i) position_[std::size_t(order[i])] = int(i);
  makePattern(A);
  for (const CoarseBlocks* part : A)
    for (const auto& [key, block] : part->blocks()) add(key, block);
}

// Block columns as six columns each, from the diagonal entry down.
void OrderedMatrix::makePattern(const CoarseSchur::Parts& A) {
  for (const CoarseBlocks* part : A)
    for (const auto& [key, block] : part->blocks()) {
      const auto [low, high] = std::minmax(position_[std::size_t(CoarseBlocks::row(key))], position_[std::size_t(CoarseBlocks::column(key))]);
      rowsOfColumn_[std::size_t(low)].push_back(high);
    }
  for (std::size_t t = 0; t < rowsOfColumn_.size(); ++t) {
    auto& rows = rowsOfColumn_[t];
    rows.push_back(int(t));
    std::sort(rows.begin(), rows.end());
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    for (int b = 0; b < kCoarseModes; ++b) {
      for (int s : rows)
        for (int a = s == int(t) ? b : 0; a < kCoarseModes; ++a) columns_.rows.push_back(kCoarseModes * s + a);
      columns_.starts.push_back(int(columns_.rows.size()));
    }
  }
  columns_.values.assign(columns_.rows.size(), 0.0);
}

// Columns of block column t shorten by one each: column 6 t + b begins with its diagonal entry, row 6 t + b.
void OrderedMatrix::add(std::uint64_t key, const CoarseBlocks::Block& block) {
  const int s = position_[std::size_t(CoarseBlocks::row(key))], t = position_[std::size_t(CoarseBlocks::column(key))];
  const auto& rows = rowsOfColumn_[std::size_t(std::min(s, t))];
  const auto at = std::lower_bound(rows.begin(), rows.end(), std::max(s, t)) - rows.begin();
  for (int b = 0; b < kCoarseModes; ++b) {
    double* to = columns_.values.data() + columns_.starts[std::size_t(kCoarseModes * std::min(s, t) + b)] + kCoarseModes * at - b;
    for (int a = at == 0 ? b : 0; a < kCoarseModes; ++a) to[a] += block[std::size_t(s >= t ? a * kCoarseModes + b : b * kCoarseModes + a)];
  }
}

// A_jj := - max diag in this column: its pivot is below zero whatever was subtracted, so that a factorisation ends there.
void OrderedMatrix::makeIndefinite(int column) {
  double largest = 0;
  for (std::size_t j = 0; j + 1 < columns_.starts.size(); ++j) largest = std::max(largest, columns_.values[std::size_t(columns_.starts[j])]);
  columns_.values[std::size_t(columns_.starts[std::size_t(column)])] = -largest;
}

// The first columns of a supernodal factor A = L L^T, in the order in which A is given; A is not definite in the next one.
// CHOLMOD then stops, keeps what came before and tells where it is (`minor`), also within a supernode: the rest, dense
// and not wanted, would be most of the work.
class CholmodFactor {
 public:
  CholmodFactor(cholmod_sparse A, std::size_t columns, CholmodCommon& common);
  ~CholmodFactor() { cholmod_free_factor(&factor_, &common_); }
  CholmodFactor(const CholmodFactor&) = delete;
  CholmodFactor& operator=(const CholmodFactor&) = delete;

  const cholmod_factor& operator*() const { return *factor_; }

 private:
  CholmodCommon& common_;
  cholmod_factor* factor_;
};

// L in supernodes by CHOLMOD's own means: A comes in its final order, nothing is to be permuted.
CholmodFactor::CholmodFactor(cholmod_sparse A, std::size_t columns, CholmodCommon& common) : common_(common) {
  common.supernodal = CHOLMOD_SUPERNODAL;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_NATURAL;
  common.postorder = 0;  // it might move others behind the last
  factor_ = cholmod_analyze(&A, &common);
  if (factor_ != nullptr) cholmod_factorize(&A, factor_, &common);
  if (common.status == CHOLMOD_NOT_POSDEF && factor_->minor == columns) return;
  const bool isIndefinite = common.status == CHOLMOD_NOT_POSDEF && factor_->minor < columns;
  const int status = common.status;
  cholmod_free_factor(&factor_, &common);  // no destructor runs after a constructor that throws
  TEUCHOS_TEST_FOR_EXCEPTION(isIndefinite, std::runtime_error,
                             "CHOLMOD: the coarse matrix of " << A.nrow << " unknowns is not positive definite");
  if (status == CHOLMOD_OUT_OF_MEMORY || status == CHOLMOD_TOO_LARGE)
    throw OutOfMemory("CHOLMOD: the factorisation of a coarse matrix of " + std::to_string(A.nrow) + " unknowns has no room in memory");
  throw std::runtime_error("CHOLMOD: the factorisation of a coarse matrix failed with status " + std::to_string(status));
}

// A column with n entries below its diagonal changes n (n + 1) / 2 entries.
double multiplicationsOf(const SupernodeView& L) {
  double sum = 0;
  for (int k = 0; k < L.supernodes; ++k)
    for (int j = L.super[k], n = L.pi[k + 1] - L.pi[k]; j < L.super[k + 1]; ++j, --n) sum += 0.5 * n * (n + 1.0);
  return sum;
}

}  // namespace

bool CoarseSchur::isPossible() { return true; }

// Dense in c against sparse in all, by entries; with more than a third in c little is left to be eliminated.
bool CoarseSchur::pays(Eigen::Index unknowns, Eigen::Index last) {
  constexpr Eigen::Index kAlways = 200, kFew = 1500;  // dense work on few costs less than looking at a sparse pattern
  constexpr double kFactor = 27;                      // a sparse factor of the whole has 27 l^(4/3) entries
  const double c = double(last), entries = kFactor * std::pow(double(unknowns), 4.0 / 3);
  return last > 0 && (last <= kAlways || (3 * last <= unknowns && (last <= kFew || c * c <= entries)));
}

// Columns o of L, A_oo = L_oo L_oo^T and L_co = A_co L_oo^-T, from CHOLMOD, which stops before c; supernodes that reach into c are
// cut off there.
void CoarseSchur::eliminateOthers(const Parts& A, const std::vector<int>& last) {
  CholmodCommon common;
  const std::vector<int> order = orderSubdomains(A, int(size_) / kCoarseModes, last, common);
  Eigen::MatrixXd schur = startSchur(A, order);
  OrderedMatrix ordered(A, order);
  ordered.makeIndefinite(int(numOthers_));
  const CholmodFactor factor(ordered.view(), std::size_t(numOthers_), common);
  const auto ints = [](const void* p) { return static_cast<const int*>(p); };
  const int* ends = ints((*factor).super);
  std::vector<int> super{0};
  for (int k = 1; super.back() < numOthers_; ++k) super.push_back(std::min(ends[k], int(numOthers_)));
  const SupernodeView L{int(size_), int(super.size()) - 1, super.data(), ints((*factor).pi), ints((*factor).px), ints((*factor).s),
                        perm_.data(), static_cast<const double*>((*factor).x)};
  others_ = SupernodalFactor<double>(L);
  flops_ = multiplicationsOf(L);
  subtractFromSchur(L, schur);
  schur_ = Lapack::packLower(schur);
}
#else
bool CoarseSchur::isPossible() { return false; }

bool CoarseSchur::pays(Eigen::Index, Eigen::Index) { return false; }

void CoarseSchur::eliminateOthers(const Parts&, const std::vector<int>&) {
  throw std::logic_error("coarse matrices are condensed by CHOLMOD only");
}
#endif

CoarseSchur::CoarseSchur(Eigen::Index unknowns, const Parts& A, const std::vector<int>& last)
    : size_(unknowns), numOthers_(size_ - kCoarseModes * Eigen::Index(last.size())), place_(std::size_t(size_ / kCoarseModes), -1) {
  TEUCHOS_ASSERT(!last.empty() && numOthers_ >= 0);
  if (numOthers_ > 0) eliminateOthers(A, last);
  else schur_ = Lapack::packLower(startSchur(A, last));
}

// A_cc, c: the last unknowns
Eigen::MatrixXd CoarseSchur::startSchur(const Parts& A, const std::vector<int>& order) {
  perm_ = expanded(order);
  for (Eigen::Index i = numOthers_; i < size_; i += kCoarseModes) place_[std::size_t(perm_[std::size_t(i)] / kCoarseModes)] = int(i - numOthers_);
  Eigen::MatrixXd schur = Eigen::MatrixXd::Zero(numLast(), numLast());
  for (const CoarseBlocks* part : A) addLast(*part, schur);
  return schur;
}

// A_cc - A_co A_oo^-1 A_oc = A_cc - L_co L_co^T, o: the others
void CoarseSchur::subtractFromSchur(const SupernodeView& L, Eigen::MatrixXd& schur) const {
  for (int k = 0; k < L.supernodes; ++k) {
    const int *begin = L.s + L.pi[k], *end = L.s + L.pi[k + 1], *last = std::lower_bound(begin, end, int(numOthers_));
    const int m = int(end - last);
    if (m == 0) continue;
    Eigen::MatrixXd product(m, m);
    Teuchos::BLAS<int, double>().SYRK(Teuchos::LOWER_TRI, Teuchos::NO_TRANS, m, L.super[k + 1] - L.super[k], 1.0,
                                      L.x + L.px[k] + (last - begin), int(end - begin), 0.0, product.data(), m);
    for (int j = 0; j < m; ++j)
      for (int i = j; i < m; ++i) schur(last[i] - numOthers_, last[j] - numOthers_) -= product(i, j);
  }
}

// To where the last subdomains lie in S; blocks of others, and between them and the last, are no business of S.
void CoarseSchur::addLast(const CoarseBlocks& blocks, Eigen::MatrixXd& lower) const {
  for (const auto& [key, block] : blocks.blocks()) {
    const int row = place_[std::size_t(CoarseBlocks::row(key))], column = place_[std::size_t(CoarseBlocks::column(key))];
    if (row < 0 || column < 0) continue;
    for (int a = 0; a < kCoarseModes; ++a)
      for (int b = 0; b < kCoarseModes; ++b) {
        double& entry = row >= column ? lower(row + a, column + b) : lower(column + b, row + a);
        entry += block[std::size_t(a * kCoarseModes + b)];
      }
  }
}

// Y = [ L_oo^-1 b_o ; b_c - L_co L_oo^-1 b_o ]: forward substitution with the columns o alone
Eigen::MatrixXd CoarseSchur::eliminate(const Eigen::MatrixXd& B) const {
  Eigen::MatrixXd Y = Eigen::MatrixXd::Zero(size_ + SupernodalFactor<double>::kPadding, B.cols());
  for (Eigen::Index j = 0; j < B.cols(); ++j)
    for (Eigen::Index i = 0; i < size_; ++i) Y(i, j) = B(perm_[std::size_t(i)], j);
  if (numOthers_ > 0) others_.forward(Y);
  return Y.topRows(size_);
}

// x_o = L_oo^-T (y_o - L_co^T x_c), x_c as given
Eigen::MatrixXd CoarseSchur::substituteBack(const Eigen::MatrixXd& Y) const {
  Eigen::MatrixXd X(size_, Y.cols()), ordered = Eigen::MatrixXd::Zero(size_ + SupernodalFactor<double>::kPadding, Y.cols());
  ordered.topRows(size_) = Y;
  if (numOthers_ > 0) others_.backward(ordered);
  for (Eigen::Index j = 0; j < Y.cols(); ++j)
    for (Eigen::Index i = 0; i < size_; ++i) X(perm_[std::size_t(i)], j) = ordered(i, j);
  return X;
}

}  // namespace Haptos
