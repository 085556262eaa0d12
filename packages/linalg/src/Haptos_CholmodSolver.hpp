// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cholmod.h>

#include <Amesos2_SolverCore_decl.hpp>
#include <Amesos2_SolverCore_def.hpp>  // Trilinos instantiates the base class for its own solvers only
#include <Amesos2_SolverTraits.hpp>
#include <Kokkos_Core.hpp>
#include <Teuchos_ParameterList.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "Haptos_CholmodNodes.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_LocalSolverFactor.hpp"
#include "Haptos_SupernodalFactor.hpp"

namespace Haptos {

/// \brief CHOLMOD as an Amesos2 solver: A = P^T L L^T P for symmetric positive definite A.
///
/// For Tpetra matrices of double on a communicator of one process, stored in full (both triangles).  The phases are those of Amesos2: `symbolicFactorization` orders (AMD, and METIS where CHOLMOD
/// has it and AMD fills in much; where unknowns come in threes, the nodes instead of them) and analyses,
/// `numericFactorization` computes L, supernodal where that pays.
/// `solve` takes any number of right-hand sides.  One object must not solve in two threads at once.
///
/// A supernodal L is solved with by SupernodalFactor, which takes its place: it is smaller, and faster on one right-hand side.
/// The parameter "Single Precision" (bool, false) keeps it in single precision, for preconditioners; L is computed in double.
///
/// Source: Chen, Davis, Hager, Rajamanickam, ACM Trans. Math. Softw. 35 (2008) 22.
template <class Matrix, class Vector>
class CholmodSolver : public Amesos2::SolverCore<CholmodSolver, Matrix, Vector> {
  friend class Amesos2::SolverCore<Haptos::CholmodSolver, Matrix, Vector>;
  using Base = Amesos2::SolverCore<Haptos::CholmodSolver, Matrix, Vector>;
  using Adapter = Amesos2::MultiVecAdapter<Vector>;

 public:
  inline static const char* name = "CHOLMOD";  // Amesos2's base class asks for this member

  CholmodSolver(Teuchos::RCP<const Matrix> A, Teuchos::RCP<Vector> X, Teuchos::RCP<const Vector> B);
  ~CholmodSolver();
  CholmodSolver(const CholmodSolver&) = delete;
  CholmodSolver& operator=(const CholmodSolver&) = delete;

  double flops() const { return flops_; }    ///< of the numeric factorisation
  bool isSingle() const { return isSuper_ && single_; }
  bool isSupernodal() const { return isSuper_; }
  /// \brief Lower triangle of S := S - B^T A^-1 B, by a supernodal L.
  void subtractGram(const Eigen::SparseMatrix<double>& B, Eigen::MatrixXd& S) const {
    if (single_) inSingle_.subtractGram(B, S);
    else inDouble_.subtractGram(B, S);
  }
  /// \brief Lets A go after `numericFactorization`; only solves are possible then.
  void releaseMatrix() {
    this->matrixA_ = Teuchos::null;
    starts_ = {};
    indices_ = {};
    values_ = {};
    if (isSuper_) cholmod_free_factor(&factor_, &common_);  // the analysis, of no more use
    cholmod_free_work(&common_);
  }

 private:
  int preOrdering_impl() { return 0; }  // CHOLMOD orders and analyses in one go
  int symbolicFactorization_impl();
  int numericFactorization_impl();
  int solve_impl(const Teuchos::Ptr<Adapter> X, const Teuchos::Ptr<const Adapter> B) const;
  bool matrixShapeOK_impl() const;
  void setParameters_impl(const Teuchos::RCP<Teuchos::ParameterList>& list) { single_ = list->get<bool>("Single Precision", single_); }
  Teuchos::RCP<const Teuchos::ParameterList> getValidParameters_impl() const {
    const auto list = Teuchos::parameterList();
    list->set("Single Precision", false, "Keep a supernodal factor in single precision");
    return list;
  }
  bool loadA_impl(Amesos2::EPhase phase);

  // Only one triangle of A is read: the one that CHOLMOD brings into its order by one transposition instead of two.
  static constexpr int kLower = -1, kUpper = 1;

  cholmod_factor* analyse();
  cholmod_sparse sparseView(int triangle) const;
  int failedColumn() const;
  [[noreturn]] void fail(const char* step) const;
  std::size_t countEntries() const;
  void takeSupernodes();
  void solveByCholmod(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X) const;
  void freeWorkspaces() const;

  mutable cholmod_common common_;
  double flops_ = 0;
  cholmod_factor* factor_ = nullptr;  // symbolic only while one of the two below has L
  bool isSuper_ = false;              // one of the two below has L
  SupernodalFactor<double> inDouble_;
  SupernodalFactor<float> inSingle_;
  bool single_ = false;
  mutable cholmod_dense* solution_ = nullptr;    // kept between solves of one column, as are the two workspaces
  mutable cholmod_dense* workspaceY_ = nullptr;
  mutable cholmod_dense* workspaceE_ = nullptr;

  // A by rows, which by symmetry is A by columns; indices and values are views of the matrix itself.
  std::vector<int> starts_;
  Kokkos::View<int*, Kokkos::HostSpace> indices_;
  Kokkos::View<double*, Kokkos::HostSpace> values_;
};

template <class Matrix, class Vector>
CholmodSolver<Matrix, Vector>::CholmodSolver(Teuchos::RCP<const Matrix> A, Teuchos::RCP<Vector> X,
                                             Teuchos::RCP<const Vector> B)
    : Base(A, X, B) {
  cholmod_start(&common_);
  common_.print = 0;          // failures are reported by exceptions
  common_.final_ll = 1;       // L L^T also when simplicial: L D L^T would accept an indefinite matrix
  common_.quick_return_if_not_posdef = 1;
  common_.nrelax[0] = 6;  // zeros stored for wider supernodes cost every solve their bytes: two nodes' worth pays, more does not
  common_.nrelax[1] = common_.nrelax[2] = 0;
}

template <class Matrix, class Vector>
CholmodSolver<Matrix, Vector>::~CholmodSolver() {
  freeWorkspaces();
  cholmod_free_factor(&factor_, &common_);
  cholmod_finish(&common_);
}

template <class Matrix, class Vector>
void CholmodSolver<Matrix, Vector>::freeWorkspaces() const {
  cholmod_free_dense(&workspaceE_, &common_);
  cholmod_free_dense(&workspaceY_, &common_);
  cholmod_free_dense(&solution_, &common_);
}

template <class Matrix, class Vector>
bool CholmodSolver<Matrix, Vector>::matrixShapeOK_impl() const {
  return this->matrixA_->getGlobalNumRows() == this->matrixA_->getGlobalNumCols() &&
         this->matrixA_->getComm()->getSize() == 1;
}

template <class Matrix, class Vector>
bool CholmodSolver<Matrix, Vector>::loadA_impl(Amesos2::EPhase phase) {
  if (phase == Amesos2::SOLVE) return false;
  Kokkos::View<int*, Kokkos::HostSpace> starts;
  this->matrixA_->returnRowPtr_kokkos_view(starts);
  this->matrixA_->returnColInd_kokkos_view(indices_);
  this->matrixA_->returnValues_kokkos_view(values_);
  starts_.assign(starts.data(), starts.data() + starts.extent(0));
  return true;
}

template <class Matrix, class Vector>
cholmod_sparse CholmodSolver<Matrix, Vector>::sparseView(int triangle) const {
  cholmod_sparse a{};
  a.nrow = a.ncol = this->globalNumRows_;
  a.nzmax = indices_.extent(0);
  a.p = const_cast<int*>(starts_.data());
  a.i = indices_.data();
  a.x = values_.data();
  a.stype = triangle;
  a.itype = CHOLMOD_INT;
  a.xtype = CHOLMOD_REAL;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = 0;
  a.packed = 1;
  return a;
}

/// By the graph of nodes where unknowns come in threes, and where supernodes pay their supernodes, too.
template <class Matrix, class Vector>
cholmod_factor* CholmodSolver<Matrix, Vector>::analyse() {
  auto a = sparseView(kLower);
  const NodeGraph nodes(starts_, indices_.data());
  std::vector<int> order = nodes.isEmpty() ? std::vector<int>{} : nodes.order(common_);
  if (order.empty()) return cholmod_analyze(&a, &common_);
  common_.nmethods = 1;
  common_.method[0].ordering = CHOLMOD_GIVEN;
  if (cholmod_factor* byNodes = nodes.analyse(order, common_)) return byNodes;
  std::vector<int> ofUnknowns;
  for (int node : order) ofUnknowns.insert(ofUnknowns.end(), {3 * node, 3 * node + 1, 3 * node + 2});
  return cholmod_analyze_p(&a, ofUnknowns.data(), nullptr, 0, &common_);
}

template <class Matrix, class Vector>
void CholmodSolver<Matrix, Vector>::fail(const char* step) const {
  const std::string what = std::string("CHOLMOD: ") + step + " of a matrix of " + std::to_string(starts_.size() - 1) + " unknowns ";
  if (common_.status == CHOLMOD_OUT_OF_MEMORY || common_.status == CHOLMOD_TOO_LARGE) throw OutOfMemory(what + "has no room in memory");
  throw std::runtime_error(what + "failed with status " + std::to_string(common_.status));
}

template <class Matrix, class Vector>
int CholmodSolver<Matrix, Vector>::symbolicFactorization_impl() {
  cholmod_free_factor(&factor_, &common_);
  factor_ = analyse();
  if (factor_ == nullptr) fail("the symbolic factorisation");
  flops_ = common_.fl;
  this->setNnzLU(std::size_t(common_.lnz));
  return 0;
}

template <class Matrix, class Vector>
int CholmodSolver<Matrix, Vector>::numericFactorization_impl() {
  auto a = sparseView(kUpper);
  const bool ran = cholmod_factorize(&a, factor_, &common_);
  TEUCHOS_TEST_FOR_EXCEPTION(common_.status == CHOLMOD_NOT_POSDEF || (ran && factor_->minor < factor_->n), UselessFactor,
                             "CHOLMOD: the matrix of " << a.nrow << " unknowns is not positive definite: pivot of column "
                                                       << failedColumn());
  if (!ran) fail("the factorisation");
  isSuper_ = factor_->is_super != 0;
  if (isSuper_) takeSupernodes();
  this->setNnzLU(countEntries());
  return 0;
}

template <class Matrix, class Vector>
void CholmodSolver<Matrix, Vector>::takeSupernodes() {
  const SupernodeView view{int(factor_->n), int(factor_->nsuper), static_cast<const int*>(factor_->super),
                           static_cast<const int*>(factor_->pi), static_cast<const int*>(factor_->px),
                           static_cast<const int*>(factor_->s), static_cast<const int*>(factor_->Perm),
                           static_cast<const double*>(factor_->x)};
  if (single_) inSingle_ = SupernodalFactor<float>(view);
  else inDouble_ = SupernodalFactor<double>(view);
  cholmod_change_factor(CHOLMOD_PATTERN, 1, 1, 1, 1, factor_, &common_);  // the analysis stays, L goes
}

template <class Matrix, class Vector>
int CholmodSolver<Matrix, Vector>::failedColumn() const {
  if (factor_->minor >= factor_->n || factor_->Perm == nullptr) return -1;
  return static_cast<const int*>(factor_->Perm)[factor_->minor];  // in the numbering of A
}

template <class Matrix, class Vector>
std::size_t CholmodSolver<Matrix, Vector>::countEntries() const {
  if (isSuper_) return single_ ? inSingle_.entries() : inDouble_.entries();
  const int* counts = static_cast<const int*>(factor_->nz);
  std::size_t entries = 0;
  for (std::size_t j = 0; j < factor_->n; ++j) entries += counts[j];
  return entries;
}

template <class Matrix, class Vector>
int CholmodSolver<Matrix, Vector>::solve_impl(const Teuchos::Ptr<Adapter> X,
                                              const Teuchos::Ptr<const Adapter> B) const {
  const Eigen::Index n = Eigen::Index(this->globalNumRows_), columns = Eigen::Index(B->getGlobalNumVectors());
  TEUCHOS_ASSERT(B->isConstantStride() && X->isConstantStride() && Eigen::Index(X->getGlobalNumVectors()) == columns);
  const auto firstB = B->getVector(0);
  const auto firstX = X->getVectorNonConst(0);
  using Columns = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
  const Columns b(const_cast<double*>(firstB->getLocalViewHost(Tpetra::Access::ReadOnly).data()), n, columns,
                  Eigen::OuterStride<>(std::max<Eigen::Index>(n, Eigen::Index(B->getStride()))));
  Columns x(firstX->getLocalViewHost(Tpetra::Access::OverwriteAll).data(), n, columns,
            Eigen::OuterStride<>(std::max<Eigen::Index>(n, Eigen::Index(X->getStride()))));
  if (!isSuper_) solveByCholmod(b, x);
  else if (single_) inSingle_.solve(b, x);
  else inDouble_.solve(b, x);
  return 0;
}

template <class Matrix, class Vector>
void CholmodSolver<Matrix, Vector>::solveByCholmod(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X) const {
  cholmod_dense b{};
  b.nrow = std::size_t(B.rows());
  b.ncol = std::size_t(B.cols());
  b.d = std::size_t(B.outerStride());
  b.nzmax = b.d * b.ncol;
  b.x = const_cast<double*>(B.data());
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  const bool solved = cholmod_solve2(CHOLMOD_A, factor_, &b, nullptr, &solution_, nullptr, &workspaceY_, &workspaceE_,
                                     &common_);
  TEUCHOS_TEST_FOR_EXCEPTION(!solved, std::runtime_error,
                             "CHOLMOD: a solve with " << B.cols() << " columns failed with status " << common_.status);
  X = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>(static_cast<const double*>(solution_->x), B.rows(), B.cols(),
                                                                  Eigen::OuterStride<>(Eigen::Index(solution_->d)));
  if (B.cols() > 1) freeWorkspaces();  // they have the width of the solve
}

}  // namespace Haptos

/// CHOLMOD's interface above is for real double precision only.
template <>
struct Amesos2::solver_traits<Haptos::CholmodSolver> {
  using supported_scalars = Amesos2::Meta::make_list1<double>;
};
