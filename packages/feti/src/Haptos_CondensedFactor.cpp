// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CondensedFactor.hpp"

#include <Teuchos_Assert.hpp>
#include <Teuchos_BLAS.hpp>
#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "Haptos_DenseSymmetric.hpp"

#if defined(HAPTOS_HAVE_CHOLMOD)
#include <cholmod.h>
#endif

namespace Haptos {
namespace {

constexpr int kModes = CoarseBlocks::kModes;

// Unknowns of a list of subdomains.
std::vector<int> expanded(const std::vector<int>& subdomains) {
  std::vector<int> unknowns;
  unknowns.reserve(subdomains.size() * kModes);
  for (int s : subdomains)
    for (int a = 0; a < kModes; ++a) unknowns.push_back(kModes * s + a);
  return unknowns;
}

}  // namespace

#if defined(HAPTOS_HAVE_CHOLMOD)
namespace {

struct CholmodCommon : cholmod_common {
  CholmodCommon() : cholmod_common() { cholmod_start(this); }
  ~CholmodCommon() { cholmod_finish(this); }
};

// A supernodal factor P A P^T = L L^T with some subdomains last in P.
class CholmodFactor {
 public:
  CholmodFactor(Eigen::SparseMatrix<double>& A, const std::vector<int>& last);
  ~CholmodFactor() { cholmod_free_factor(&factor_, &common_); }
  CholmodFactor(const CholmodFactor&) = delete;
  CholmodFactor& operator=(const CholmodFactor&) = delete;

  SupernodeView view() const {
    const auto ints = [](const void* p) { return static_cast<const int*>(p); };
    return {int(factor_->n),    int(factor_->nsuper), ints(factor_->super), ints(factor_->pi),
            ints(factor_->px), ints(factor_->s),     ints(factor_->Perm),  static_cast<const double*>(factor_->x)};
  }

 private:
  std::vector<int> order(const Eigen::SparseMatrix<double>& A, const std::vector<int>& last);

  CholmodCommon common_;
  cholmod_factor* factor_ = nullptr;
};

cholmod_sparse lowerTriangle(std::size_t n, int* starts, int* rows, std::size_t entries) {
  cholmod_sparse a{};
  a.nrow = a.ncol = n;
  a.nzmax = entries;
  a.p = starts;
  a.i = rows;
  a.stype = -1;  // the lower triangle is read
  a.itype = CHOLMOD_INT;
  a.xtype = CHOLMOD_PATTERN;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = a.packed = 1;
  return a;
}

// Constrained minimum degree on the graph of the subdomains.
std::vector<int> CholmodFactor::order(const Eigen::SparseMatrix<double>& A, const std::vector<int>& last) {
  const int subdomains = int(A.cols()) / kModes;
  std::vector<int> starts{0}, rows, isLast(std::size_t(subdomains), 0), perm(isLast);
  for (int t = 0; t < subdomains; ++t) {
    const int begin = A.outerIndexPtr()[kModes * t], end = A.outerIndexPtr()[kModes * t + 1];
    for (int k = begin; k < end; k += kModes)
      if (A.innerIndexPtr()[k] / kModes >= t) rows.push_back(A.innerIndexPtr()[k] / kModes);
    starts.push_back(int(rows.size()));
  }
  for (int s : last) isLast[std::size_t(s)] = 1;
  auto graph = lowerTriangle(std::size_t(subdomains), starts.data(), rows.data(), rows.size());
  const bool ordered = cholmod_camd(&graph, nullptr, 0, isLast.data(), perm.data(), &common_);
  TEUCHOS_TEST_FOR_EXCEPTION(!ordered, std::runtime_error, "CHOLMOD: ordering " << subdomains << " subdomains failed");
  return expanded(perm);
}

CholmodFactor::CholmodFactor(Eigen::SparseMatrix<double>& A, const std::vector<int>& last) {
  common_.print = 0;  // failures are reported by exceptions
  common_.quick_return_if_not_posdef = 1;
  common_.supernodal = CHOLMOD_SUPERNODAL;
  common_.nmethods = 1;
  common_.method[0].ordering = CHOLMOD_GIVEN;
  common_.postorder = 0;  // it might move others behind the last
  auto a = lowerTriangle(std::size_t(A.rows()), A.outerIndexPtr(), A.innerIndexPtr(), std::size_t(A.nonZeros()));
  a.x = A.valuePtr();
  a.xtype = CHOLMOD_REAL;
  std::vector<int> perm = order(A, last);
  factor_ = cholmod_analyze_p(&a, perm.data(), nullptr, 0, &common_);
  if (factor_ != nullptr) cholmod_factorize(&a, factor_, &common_);
  if (common_.status == CHOLMOD_OK && factor_->minor == factor_->n) return;
  cholmod_free_factor(&factor_, &common_);  // no destructor runs after a constructor that throws
  TEUCHOS_TEST_FOR_EXCEPTION(common_.status == CHOLMOD_NOT_POSDEF, std::runtime_error,
                             "CHOLMOD: the coarse matrix of " << A.rows() << " unknowns is not positive definite");
  throw std::runtime_error("CHOLMOD: the factorisation of a coarse matrix failed with status " + std::to_string(common_.status));
}

}  // namespace

bool CondensedFactor::pays(Eigen::Index unknowns, Eigen::Index changing) {
  constexpr Eigen::Index kAlways = 200, kLargest = 1500;  // dense work on few costs less than looking at a sparse pattern
  return changing > 0 && (changing <= kAlways || (changing <= kLargest && 3 * changing <= unknowns));
}

void CondensedFactor::eliminate(Eigen::SparseMatrix<double> A, const std::vector<int>& changing) {
  TEUCHOS_ASSERT(A.isCompressed());
  const double shift = A.diagonal().maxCoeff();  // the last columns of L are not used; they must exist
  for (int i : expanded(changing)) A.coeffRef(i, i) += shift;
  const CholmodFactor factor(A, changing);
  const SupernodeView L = factor.view();
  nodes_.perm.assign(L.perm, L.perm + L.n);
  for (int k = 0; k < L.supernodes && L.super[k] < fixed_; ++k)  // of one that reaches into the last, the columns before
    nodes_.append(std::min(L.super[k + 1], int(fixed_)) - L.super[k], L.s + L.pi[k], L.pi[k + 1] - L.pi[k], L.x + L.px[k]);
}
#else
bool CondensedFactor::pays(Eigen::Index, Eigen::Index) { return false; }

void CondensedFactor::eliminate(Eigen::SparseMatrix<double>, const std::vector<int>&) {
  throw std::logic_error("coarse matrices are condensed by CHOLMOD only");
}
#endif

CondensedFactor::CondensedFactor(Eigen::SparseMatrix<double> A, const std::vector<int>& changing)
    : size_(A.rows()), fixed_(size_ - kModes * Eigen::Index(changing.size())), place_(std::size_t(size_ / kModes), -1) {
  TEUCHOS_ASSERT(!changing.empty() && fixed_ >= 0);
  const Eigen::SparseMatrix<double> all = A;
  if (fixed_ > 0) {
    eliminate(std::move(A), changing);
  } else {
    nodes_.perm = expanded(changing);
  }
  const std::vector<int> last(nodes_.perm.begin() + fixed_, nodes_.perm.end());
  for (std::size_t i = 0; i < last.size(); i += kModes) place_[std::size_t(last[i] / kModes)] = int(i);
  formSchur(all);
  std::vector<int> rows(last.size());
  std::iota(rows.begin(), rows.end(), int(fixed_));
  nodes_.append(int(rows.size()), rows.data(), int(rows.size()), schur_.data());
}

void CondensedFactor::Nodes::append(int columns, const int* rows, int numRows, const double* values) {
  super.push_back(super.back() + columns);
  pi.push_back(pi.back() + numRows);
  px.push_back(int(x.size()));
  s.insert(s.end(), rows, rows + numRows);
  x.insert(x.end(), values, values + std::size_t(numRows) * std::size_t(columns));
}

// A_cc - A_cn A_nn^-1 A_nc = A_cc - L_cn L_cn^T
void CondensedFactor::formSchur(const Eigen::SparseMatrix<double>& A) {
  const Eigen::Index n = size_ - fixed_;
  schur_ = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(A, nodes_.perm[std::size_t(fixed_ + j)]); it; ++it) {
      const int at = place_[std::size_t(it.row() / kModes)], i = at + int(it.row()) % kModes;
      if (at >= 0 && i >= j) schur_(i, j) = it.value();
    }
  for (std::size_t k = 0; k < nodes_.px.size(); ++k) {
    const int *end = nodes_.s.data() + nodes_.pi[k + 1], *begin = nodes_.s.data() + nodes_.pi[k];
    const int *first = std::lower_bound(begin, end, int(fixed_)), m = int(end - first), rows = int(end - begin);
    if (m == 0) continue;
    Eigen::MatrixXd product(m, m);
    Teuchos::BLAS<int, double>().SYRK(Teuchos::LOWER_TRI, Teuchos::NO_TRANS, m, nodes_.super[k + 1] - nodes_.super[k], 1.0,
                                      nodes_.x.data() + nodes_.px[k] + (first - begin), rows, 0.0, product.data(), m);
    for (int j = 0; j < m; ++j)
      for (int i = j; i < m; ++i) schur_(first[i] - fixed_, first[j] - fixed_) -= product(i, j);
  }
}

void CondensedFactor::renew(const CoarseBlocks& E) {
  Eigen::Map<Eigen::MatrixXd> S(nodes_.x.data() + nodes_.px.back(), schur_.rows(), schur_.cols());
  S = schur_;
  add(E, S);
  TEUCHOS_TEST_FOR_EXCEPTION(!Lapack::choleskyInPlace(S), std::runtime_error,
                             "the coarse matrix of " << size_ << " unknowns is not positive definite in its " << S.rows()
                                                     << " changing ones");
  factor_ = SupernodalFactor<double>({int(size_), int(nodes_.px.size()), nodes_.super.data(), nodes_.pi.data(), nodes_.px.data(),
                                      nodes_.s.data(), nodes_.perm.data(), nodes_.x.data()});
}

void CondensedFactor::add(const CoarseBlocks& E, Eigen::Ref<Eigen::MatrixXd> S) const {
  for (const auto& [key, block] : E.blocks()) {
    const int row = place_[std::size_t(CoarseBlocks::row(key))], column = place_[std::size_t(CoarseBlocks::column(key))];
    TEUCHOS_ASSERT(row >= 0 && column >= 0);
    for (int a = 0; a < kModes; ++a)
      for (int b = 0; b < kModes; ++b) {
        const double value = block[std::size_t(a * kModes + b)];
        if (row > column || (row == column && a >= b)) S(row + a, column + b) += value;
        if (row < column) S(column + b, row + a) += value;
      }
  }
}

}  // namespace Haptos
