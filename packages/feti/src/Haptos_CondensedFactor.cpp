// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CondensedFactor.hpp"

#include <Teuchos_Assert.hpp>
#include <Teuchos_BLAS.hpp>
#include <algorithm>
#include <string>
#include <stdexcept>

#include "Haptos_DenseSymmetric.hpp"

#if defined(HAPTOS_HAVE_CHOLMOD)
#include <cholmod.h>
#endif

// Not in Teuchos::BLAS.
extern "C" void dtrsv_(const char* uplo, const char* trans, const char* diag, const int* n, const double* a, const int* lda,
                       double* x, const int* incx);

namespace Haptos {
namespace {

constexpr int kModes = CoarseBlocks::kModes;
const int kOne = 1;

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

  const cholmod_factor& operator*() const { return *factor_; }

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

void CondensedFactor::factorOthers(Eigen::SparseMatrix<double> A, const std::vector<int>& changing) {
  TEUCHOS_ASSERT(A.isCompressed());
  const double shift = A.diagonal().maxCoeff();  // the last columns of L are not used; they must exist
  for (int i : expanded(changing)) A.coeffRef(i, i) += shift;
  const CholmodFactor factor(A, changing);
  const auto ints = [](const void* p) { return static_cast<const int*>(p); };
  const int *super = ints((*factor).super), *pi = ints((*factor).pi), *px = ints((*factor).px), *rows = ints((*factor).s);
  const double* values = static_cast<const double*>((*factor).x);
  perm_.assign(ints((*factor).Perm), ints((*factor).Perm) + size_);
  for (int k = 0; super[k] < others_; ++k) {
    const int columns = std::min(super[k + 1], int(others_)) - super[k], numRows = pi[k + 1] - pi[k];
    nodes_.push_back({super[k], columns, numRows, rows_.size(), values_.size()});
    rows_.insert(rows_.end(), rows + pi[k], rows + pi[k + 1]);
    values_.insert(values_.end(), values + px[k], values + px[k] + std::size_t(columns) * std::size_t(numRows));
    mostRows_ = std::max(mostRows_, numRows);
  }
}
#else
bool CondensedFactor::pays(Eigen::Index, Eigen::Index) { return false; }

void CondensedFactor::factorOthers(Eigen::SparseMatrix<double>, const std::vector<int>&) {
  throw std::logic_error("coarse matrices are condensed by CHOLMOD only");
}
#endif

CondensedFactor::CondensedFactor(Eigen::SparseMatrix<double> A, const std::vector<int>& changing)
    : size_(A.rows()), others_(size_ - kModes * Eigen::Index(changing.size())), place_(std::size_t(size_ / kModes), -1) {
  TEUCHOS_ASSERT(!changing.empty() && others_ >= 0);
  if (others_ > 0) factorOthers(A, changing);
  else perm_ = expanded(changing);
  for (Eigen::Index i = others_; i < size_; i += kModes) place_[std::size_t(perm_[std::size_t(i)] / kModes)] = int(i - others_);
  formSchur(A);
}

// A_cc - A_co A_oo^-1 A_oc = A_cc - L_co L_co^T, c: the changing unknowns, o: the others
void CondensedFactor::formSchur(const Eigen::SparseMatrix<double>& A) {
  const Eigen::Index n = size_ - others_;
  schur_ = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(A, perm_[std::size_t(others_ + j)]); it; ++it) {
      const int at = place_[std::size_t(it.row() / kModes)];
      if (at >= 0) schur_(at + it.row() % kModes, j) = it.value();
    }
  for (const Node& node : nodes_) {
    const int *end = rows_.data() + node.rows + node.numRows, *begin = end - node.numRows;
    const int *changing = std::lower_bound(begin, end, int(others_)), m = int(end - changing);
    if (m == 0) continue;
    Eigen::MatrixXd product(m, m);
    Teuchos::BLAS<int, double>().SYRK(Teuchos::LOWER_TRI, Teuchos::NO_TRANS, m, node.columns, 1.0,
                                      values_.data() + node.values + (changing - begin), node.numRows, 0.0, product.data(), m);
    for (int j = 0; j < m; ++j)
      for (int i = j; i < m; ++i) schur_(changing[i] - others_, changing[j] - others_) -= product(i, j);
  }
}

void CondensedFactor::renew(const CoarseBlocks& E) {
  factor_ = schur_;
  for (const auto& [key, block] : E.blocks()) {
    const int row = place_[std::size_t(CoarseBlocks::row(key))], column = place_[std::size_t(CoarseBlocks::column(key))];
    TEUCHOS_ASSERT(row >= 0 && column >= 0);
    for (int a = 0; a < kModes; ++a)
      for (int b = 0; b < kModes; ++b) {
        double& entry = row >= column ? factor_(row + a, column + b) : factor_(column + b, row + a);
        entry += block[std::size_t(a * kModes + b)];
      }
  }
  TEUCHOS_TEST_FOR_EXCEPTION(!Lapack::choleskyInPlace(factor_), std::runtime_error,
                             "the coarse matrix of " << size_ << " unknowns is not positive definite in the " << factor_.rows()
                                                     << " that change");
}

Eigen::MatrixXd CondensedFactor::eliminate(const Eigen::MatrixXd& B) const {
  const Teuchos::BLAS<int, double> blas;
  Eigen::MatrixXd Y(B.rows(), B.cols());
  Eigen::VectorXd product(mostRows_);
  for (Eigen::Index j = 0; j < B.cols(); ++j) {
    double* y = Y.col(j).data();
    for (Eigen::Index i = 0; i < size_; ++i) y[i] = B(perm_[std::size_t(i)], j);
    for (const Node& node : nodes_) {
      const double* L = values_.data() + node.values;
      dtrsv_("L", "N", "N", &node.columns, L, &node.numRows, y + node.first, &kOne);
      const int below = node.numRows - node.columns, *rows = rows_.data() + node.rows + node.columns;
      if (below == 0) continue;
      blas.GEMV(Teuchos::NO_TRANS, below, node.columns, 1.0, L + node.columns, node.numRows, y + node.first, 1, 0.0, product.data(), 1);
      for (int i = 0; i < below; ++i) y[rows[i]] -= product[i];
    }
  }
  return Y;
}

Eigen::MatrixXd CondensedFactor::substituteBack(Eigen::MatrixXd Y) const {
  const Teuchos::BLAS<int, double> blas;
  Eigen::MatrixXd X(Y.rows(), Y.cols());
  Eigen::VectorXd known(mostRows_);
  for (Eigen::Index j = 0; j < Y.cols(); ++j) {
    double* y = Y.col(j).data();
    for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
      const double* L = values_.data() + node->values;
      const int below = node->numRows - node->columns, *rows = rows_.data() + node->rows + node->columns;
      for (int i = 0; i < below; ++i) known[i] = y[rows[i]];
      if (below > 0)
        blas.GEMV(Teuchos::TRANS, below, node->columns, -1.0, L + node->columns, node->numRows, known.data(), 1, 1.0, y + node->first, 1);
      dtrsv_("L", "T", "N", &node->columns, L, &node->numRows, y + node->first, &kOne);
    }
    for (Eigen::Index i = 0; i < size_; ++i) X(perm_[std::size_t(i)], j) = y[i];
  }
  return X;
}

void CondensedFactor::solveSchur(Eigen::Ref<Eigen::MatrixXd> last) const {
  const int n = int(factor_.rows());
  for (Eigen::Index j = 0; j < last.cols(); ++j)
    for (const char* side : {"N", "T"}) dtrsv_("L", side, "N", &n, factor_.data(), &n, last.col(j).data(), &kOne);
}

Eigen::MatrixXd CondensedFactor::multiplySchur(const Eigen::MatrixXd& X) const {
  return schur_.selfadjointView<Eigen::Lower>() * X;
}

Eigen::MatrixXd CondensedFactor::solve(const Eigen::MatrixXd& B) const {
  Eigen::MatrixXd Y = eliminate(B);
  solveSchur(Y.bottomRows(factor_.rows()));
  return substituteBack(std::move(Y));
}

}  // namespace Haptos
