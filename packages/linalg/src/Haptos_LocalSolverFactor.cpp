// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_LocalSolverFactor.hpp"

#include <Amesos2.hpp>
#include <Teuchos_DefaultSerialComm.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <mutex>
#include <vector>

#include "Haptos_Error.hpp"
#include "Haptos_SparseBlocks.hpp"
#include "Haptos_Types_fwd.hpp"

// Also where Trilinos brings an adapter of its own: single precision, solves and analyses that stay are ours alone.
#ifdef HAPTOS_HAVE_CHOLMOD
#include "Haptos_CholmodSolver.hpp"
#endif

namespace Haptos {

using AmesosSolver = Amesos2::Solver<CrsMatrix, MultiVector>;

// Vectors and matrices are read and written in place, all over the library.
static_assert(Kokkos::SpaceAccessibility<Kokkos::DefaultHostExecutionSpace, Map::node_type::memory_space>::accessible,
              "Haptos needs a node type of Tpetra whose memory the host can reach.");

bool hasCholmod() {
#ifdef HAPTOS_HAVE_CHOLMOD
  return true;
#else
  return false;
#endif
}

namespace {

RCP<AmesosSolver> createSolver(const RCP<const CrsMatrix>& A, bool cholmod) {
  if (!cholmod) return Amesos2::create<CrsMatrix, MultiVector>("KLU2", A);
#ifdef HAPTOS_HAVE_CHOLMOD
  return Teuchos::rcp(new CholmodSolver<CrsMatrix, MultiVector>(A, Teuchos::null, Teuchos::null));
#else
  throw InputError("Local Solver: CHOLMOD is not in this build; use KLU2 or Automatic, or build with SuiteSparse.");
#endif
}

// L is computed in double and kept in single: factoring is not what a preconditioner costs.
void requestSinglePrecision(AmesosSolver& solver) {
#ifdef HAPTOS_HAVE_CHOLMOD
  if (solver.name() != CholmodSolver<CrsMatrix, MultiVector>::name) return;
  const auto list = Teuchos::parameterList("Amesos2");
  list->sublist(solver.name()).set("Single Precision", true);
  solver.setParameters(list);
#else
  (void)solver;
#endif
}

/// A copy of `A`; Tpetra 13.2 and later insist on owning their memory.
RCP<CrsMatrix> copyMatrix(const Eigen::SparseMatrix<double>& A, const RCP<const Map>& map) {
  using LocalMatrix = CrsMatrix::local_matrix_device_type;
  const auto rows = std::size_t(A.rows()), entries = std::size_t(A.nonZeros());
  LocalMatrix::row_map_type::non_const_type starts("row starts", rows + 1);
  LocalMatrix::index_type::non_const_type indices("column indices", entries);
  LocalMatrix::values_type::non_const_type values("values", entries);
  std::copy_n(A.outerIndexPtr(), rows + 1, starts.data());  // by symmetry, columns are rows
  std::copy_n(A.innerIndexPtr(), entries, indices.data());
  std::copy_n(A.valuePtr(), entries, values.data());
  auto copy = Teuchos::rcp(new CrsMatrix(map, map, starts, indices, values));
  copy->expertStaticFillComplete(map, map);
  return copy;
}

Eigen::Map<Eigen::MatrixXd> eigenView(double* data, const MultiVector& v) {
  return {data, Eigen::Index(v.getLocalLength()), Eigen::Index(v.getNumVectors())};
}

}  // namespace

struct LocalSolverFactor::Impl {
  /// A right-hand side and its solution where Amesos2 can see them.
  struct Columns {
    Columns(const RCP<const Map>& map, Eigen::Index m) : b(map, m, false), x(map, m, false) {}
    MultiVector b, x;
  };

  RCP<const Map> map;
  RCP<CrsMatrix> A;
  std::vector<int> starts;  // A's row starts as Eigen wants them
  Eigen::Index rows = 0;
  RCP<AmesosSolver> solver;
  bool cholmod = false;
  std::unique_ptr<Columns> single;  // kept, as most solves have one column
  std::mutex busy;                  // `single` and the solver's workspaces serve one thread at a time

  static std::unique_ptr<Impl> analysed(Eigen::SparseMatrix<double> A, LocalSolverMethod method, FactorPrecision precision) {
    TEUCHOS_ASSERT(A.rows() == A.cols() && A.rows() > 0);
    A.makeCompressed();
    auto impl = std::make_unique<Impl>();
    const auto self = Teuchos::rcp(new Teuchos::SerialComm<int>());
    impl->map = Teuchos::rcp(new Map(Tpetra::global_size_t(A.rows()), 0, self));
    impl->A = copyMatrix(A, impl->map);
    impl->rows = A.rows();
    impl->starts.assign(A.outerIndexPtr(), A.outerIndexPtr() + A.rows() + 1);
    impl->cholmod = method == LocalSolverMethod::Cholmod || (method == LocalSolverMethod::Automatic && hasCholmod());
    impl->solver = createSolver(impl->A, impl->cholmod);
    if (precision == FactorPrecision::Single) requestSinglePrecision(*impl->solver);
    impl->solver->symbolicFactorization();
    impl->single = std::make_unique<Columns>(impl->map, 1);
    return impl;
  }

  void solve(Columns& columns, const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X) const {
    eigenView(columns.b.getLocalViewHost(Tpetra::Access::OverwriteAll).data(), columns.b) = B;
    solver->solve(&columns.x, &columns.b);
    X = eigenView(const_cast<double*>(columns.x.getLocalViewHost(Tpetra::Access::ReadOnly).data()), columns.x);
  }
};

// Amesos2 wants Tpetra's matrices; A's columns are its rows, by symmetry, so arrays are copied as they are.
LocalSolverFactor LocalSolverFactor::analysed(Eigen::SparseMatrix<double> A, LocalSolverMethod method) {
  return LocalSolverFactor(Impl::analysed(std::move(A), method, FactorPrecision::Double));
}

LocalSolverFactor::LocalSolverFactor(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

LocalSolverFactor::LocalSolverFactor(Eigen::SparseMatrix<double> A, LocalSolverMethod method, FactorPrecision precision)
    : LocalSolverFactor(Impl::analysed(std::move(A), method, precision)) {
  impl_->solver->numericFactorization();
}

// Values only: the pattern, and with it the analysis, is the first matrix's.
void LocalSolverFactor::renew(const Eigen::SparseMatrix<double>& A) {
  TEUCHOS_ASSERT(!impl_->A.is_null() && A.isCompressed() && A.rows() == rows());
  {
    const auto values = impl_->A->getLocalMatrixHost().values;
    TEUCHOS_ASSERT(std::size_t(A.nonZeros()) == values.extent(0));
    std::copy_n(A.valuePtr(), A.nonZeros(), values.data());
  }
  impl_->solver->numericFactorization();
}

LocalSolverFactor::~LocalSolverFactor() = default;
LocalSolverFactor::LocalSolverFactor(LocalSolverFactor&&) noexcept = default;

// One thread at a time: solver and vectors have workspaces of their own.
void LocalSolverFactor::solve(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X) const {
  TEUCHOS_ASSERT(B.rows() == rows() && X.rows() == B.rows() && X.cols() == B.cols());
  if (B.cols() == 0) return;
  const std::lock_guard<std::mutex> lock(impl_->busy);
  if (B.cols() == 1) return impl_->solve(*impl_->single, B, X);
  Impl::Columns wide(impl_->map, B.cols());
  impl_->solve(wide, B, X);
}

// Half a solve where L is supernodal. Where it is not, or another's, whole ones: so many columns at once as fill a processor's memory.
void LocalSolverFactor::subtractGram(const Eigen::SparseMatrix<double>& B, Eigen::MatrixXd& S) const {
  constexpr Eigen::Index kColumns = 64;
  TEUCHOS_ASSERT(B.rows() == rows() && S.rows() == B.cols() && S.cols() == B.cols());
#ifdef HAPTOS_HAVE_CHOLMOD
  const auto own = Teuchos::rcp_dynamic_cast<CholmodSolver<CrsMatrix, MultiVector>>(impl_->solver);
  const bool isDone = !own.is_null() && own->isSupernodal();
  if (isDone) own->subtractGram(B, S);
#else
  constexpr bool isDone = false;
#endif
  for (Eigen::Index first = 0; first < B.cols() && !isDone; first += kColumns) {
    const Eigen::Index width = std::min(kColumns, B.cols() - first);
    const Eigen::MatrixXd force = B.middleCols(first, width);
    Eigen::MatrixXd motion(force.rows(), width);
    solve(force, motion);
    S.middleCols(first, width) -= timesColumns(B.transpose(), motion);
  }
  S.triangularView<Eigen::StrictlyUpper>() = S.transpose();
}

Eigen::Index LocalSolverFactor::rows() const { return impl_->rows; }

// Of solvers of others it is not known whether they look at the matrix again.
void LocalSolverFactor::releaseMatrix() {
#ifdef HAPTOS_HAVE_CHOLMOD
  const auto own = Teuchos::rcp_dynamic_cast<CholmodSolver<CrsMatrix, MultiVector>>(impl_->solver);
  if (own.is_null()) return;
  own->releaseMatrix();
  impl_->A = Teuchos::null;
  impl_->starts = {};
#endif
}

LocalSolverFactor::MatrixView LocalSolverFactor::matrix() const {
  TEUCHOS_ASSERT(!impl_->A.is_null());
  const auto local = impl_->A->getLocalMatrixHost();
  return {rows(), rows(), Eigen::Index(local.nnz()), impl_->starts.data(), local.graph.entries.data(), local.values.data()};
}

const char* LocalSolverFactor::methodName() const { return impl_->cholmod ? "CHOLMOD" : "KLU2"; }

std::size_t LocalSolverFactor::factorEntries() const { return impl_->solver->getStatus().getNnzLU(); }

FactorWork LocalSolverFactor::work() const {
  const double entries = double(factorEntries());
  FactorWork work{0, entries, 2 * entries * double(sizeof(double))};
#ifdef HAPTOS_HAVE_CHOLMOD
  const auto own = Teuchos::rcp_dynamic_cast<CholmodSolver<CrsMatrix, MultiVector>>(impl_->solver);
  if (own.is_null()) return work;
  work.flops = own->flops();
  if (own->isSingle()) work.bytesRead /= 2;
#endif
  return work;
}

LocalSolverFactor::Counts LocalSolverFactor::counts() const {
  const auto& status = impl_->solver->getStatus();
  return {status.getNumSymbolicFact(), status.getNumNumericFact(), status.getNumSolve()};
}

}  // namespace Haptos
