// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_OwnStiffness.hpp"

#include <Eigen/SparseCore>
#include <Tpetra_CrsMatrix.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Format.hpp"
#include "Haptos_PartShape.hpp"
#include "Haptos_RigidBodyModes.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

using Part = OwnStiffness::Part;
using SparseMatrix = Eigen::SparseMatrix<double>;
using SparseRef = Eigen::Ref<const SparseMatrix>;

constexpr double kNoEnergy = 1e-10;  // of what diag K gives the same motion

// visit(row, columns, values, count) for every row; unknowns are numbered as in the map of the rows.  By plain pointers: a view of a row
// counts its users, which costs more than the row.
template <class Visit>
void forEachRow(const CrsMatrix& K, Visit&& visit) {
  const auto rows = K.getRowMap(), columns = K.getColMap();
  const auto A = K.getLocalMatrixHost();
  const LocalOrdinal* unknowns = A.graph.entries.data();
  std::vector<LocalOrdinal> renumbered;
  if (!columns->locallySameAs(*rows)) {
    for (std::size_t k = 0; k < std::size_t(A.nnz()); ++k) renumbered.push_back(rows->getLocalElement(columns->getGlobalElement(unknowns[k])));
    unknowns = renumbered.data();
  }
  const auto* const begin = A.graph.row_map.data();
  for (LocalOrdinal i = 0; i < LocalOrdinal(localNumRows(K)); ++i)
    visit(i, unknowns + begin[i], A.values.data() + begin[i], std::size_t(begin[i + 1] - begin[i]));
}

// Row starts as Eigen wants them, where the entries of K can be looked at as they lie: columns numbered as rows, and in order.  Else none.
std::vector<int> startsInPlace(const CrsMatrix& K) {
  if (!K.getColMap()->locallySameAs(*K.getRowMap())) return {};
  const auto graph = K.getLocalMatrixHost().graph;
  const std::vector<int> starts(graph.row_map.data(), graph.row_map.data() + graph.row_map.extent(0));
  const LocalOrdinal* columns = graph.entries.data();
  for (std::size_t row = 0; row + 1 < starts.size(); ++row)
    if (!std::is_sorted(columns + starts[row], columns + starts[row + 1])) return {};
  return starts;
}

// Nodes that K couples, ascending as its rows are.
IndexLists nodeNeighbours(const SparseRef& K) {
  IndexLists lists;
  lists.offsets.push_back(0);
  for (Eigen::Index node = 0; node < K.cols() / 3; ++node) {
    for (SparseRef::InnerIterator entry(K, 3 * node); entry; ++entry) {
      const int other = int(entry.row()) / 3;
      if (std::int64_t(lists.items.size()) == lists.offsets.back() || lists.items.back() != other) lists.items.push_back(other);
    }
    lists.offsets.push_back(std::int64_t(lists.items.size()));
  }
  return lists;
}

[[noreturn]] void refuse(const Part& part, const std::string& text) { throw InputError("The stiffness of " + part.name + " " + text); }

// || K - K^T ||_max without a transpose: column by column, entries below the diagonal meet those of their rows in the order in which these stand.
// Negative if the entries do not stand in the same places.
double asymmetryInPlace(const SparseRef& K) {
  const int *begin = K.outerIndexPtr(), *rows = K.innerIndexPtr();
  const double* values = K.valuePtr();
  std::vector<int> next(begin, begin + K.cols());  // of each column's entries above the diagonal
  double worst = 0;
  for (int j = 0; j < int(K.cols()); ++j) {
    // All columns before are through: what is next in this one stands on the diagonal or below.
    int k = next[std::size_t(j)];
    if (k < begin[j + 1] && rows[k] < j) return -1;
    if (k < begin[j + 1] && rows[k] == j) ++k;
    for (; k < begin[j + 1]; ++k) {
      const int opposite = next[std::size_t(rows[k])]++;
      if (opposite >= begin[rows[k] + 1] || rows[opposite] != j) return -1;
      worst = std::max(worst, std::abs(values[k] - values[opposite]));
    }
  }
  return worst;
}

double asymmetry(const SparseRef& K) {
  const double inPlace = asymmetryInPlace(K);
  if (inPlace >= 0) return inPlace;
  const SparseMatrix T = K.transpose(), difference = K - T;
  return difference.coeffs().abs().maxCoeff();
}

// 0 where there is no entry.
Eigen::VectorXd diagonalOf(const SparseRef& K) {
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(K.cols());
  for (Eigen::Index j = 0; j < K.cols(); ++j) {
    const int *first = K.innerIndexPtr() + K.outerIndexPtr()[j], *last = K.innerIndexPtr() + K.outerIndexPtr()[j + 1];
    const int* at = std::lower_bound(first, last, int(j));
    if (at != last && *at == int(j)) diagonal[j] = K.valuePtr()[at - K.innerIndexPtr()];
  }
  return diagonal;
}

// || K - K^T ||_max <= 1e-9 || K ||_max: assembly in another order leaves 1e-16.
void requireSymmetry(const Part& part, const SparseRef& K) {
  constexpr double kSymmetric = 1e-9;  // of the largest entry
  const Eigen::Map<const Eigen::ArrayXd> values(K.valuePtr(), K.nonZeros());
  const double largest = values.abs().maxCoeff<Eigen::PropagateNaN>();
  if (!std::isfinite(largest)) refuse(part, "has an entry that is not finite.");
  const double worst = asymmetry(K);
  if (worst > kSymmetric * largest)
    refuse(part, "is not symmetric: entries differ by " + formatted("%.1e", worst) + " of " + formatted("%.1e", largest) + ".");
  if (diagonalOf(K).minCoeff() <= 0) refuse(part, "has a diagonal entry that is not positive: a node hangs on nothing.");
}

// An orthonormal basis of what the caller says K does not feel.
Eigen::MatrixXd givenKernel(const Part& part, const SparseRef& K) {
  if (part.kernel.rows() != K.rows())
    refuse(part, "comes with a kernel of " + std::to_string(part.kernel.rows()) + " rows; it has " + std::to_string(K.rows()) + ".");
  const PivotedQr qr(part.kernel);
  if (Eigen::Index(qr.columns.size()) < part.kernel.cols()) refuse(part, "comes with a kernel whose columns depend on each other.");
  const Eigen::MatrixXd& R = qr.Q;
  const Eigen::VectorXd weights = diagonalOf(K);
  for (Eigen::Index j = 0; j < R.cols(); ++j) {
    const double energy = R.col(j).dot(K * R.col(j)), measure = R.col(j).dot(weights.cwiseProduct(R.col(j)));
    if (!(std::abs(energy) <= kNoEnergy * measure))
      refuse(part, "comes with a kernel that it does not have: R^T K R is " + formatted("%.1e", energy / measure) + " of R^T diag(K) R.");
  }
  return R;
}

// Without a kernel that the caller gives, rigid motions are tried: a matrix that resists all of them is not what Total FETI takes.
Eigen::MatrixXd kernelOf(const Part& part, const SparseRef& K) {
  if (part.kernel.size() > 0) return givenKernel(part, K);
  Eigen::MatrixXd R = rigidKernel(K, part.coordinates);
  if (R.cols() == 0)
    refuse(part, "has no rigid motion without energy: it is definite (a held, dynamic or merged matrix), or its kernel is another one. "
                 "Give the matrix of the subdomain alone, with nothing held, and prescribe displacements beside it; or give its kernel.");
  return R;
}

}  // namespace

// What can be told without its entries, in the order in which a caller would mend it.
std::string problemOfMatrix(const RCP<const CrsMatrix>& K, std::size_t numNodes) {
  const std::size_t n = 3 * numNodes;
  if (n == 0) return "has no nodes.";
  if (K.is_null()) return "is missing.";
  if (!K->isFillComplete()) return "is not complete: call its fillComplete().";
  const Map &rows = *K->getRowMap(), &columns = *K->getColMap();
  if (rows.getComm()->getSize() != 1 && rows.getGlobalNumElements() != localNumElements(rows))
    return "lies on several ranks; a subdomain is one rank's.";
  if (localNumRows(*K) != n)
    return "has " + std::to_string(localNumRows(*K)) + " rows; its " + std::to_string(numNodes) + " nodes have " + std::to_string(n) +
           " unknowns, three each.";
  if (localNumEntries(*K) == 0) return "has no entries.";
  for (LocalOrdinal j = 0; j < LocalOrdinal(localNumElements(columns)); ++j)
    if (!rows.isNodeGlobalElement(columns.getGlobalElement(j)))
      return "has an entry in column " + std::to_string(columns.getGlobalElement(j)) + ", which is none of its rows.";
  return "";
}

// E y = mu D y with E = R^T K R and D = R^T diag(K) R, R the six motions: those y with mu = 0 cost nothing.  Against diag(K), as
// translations and rotations have other units.
Eigen::MatrixXd rigidKernel(const Eigen::Ref<const SparseMatrix>& K, const Coordinates& coordinates) {
  using Small = Eigen::Matrix<double, 6, 6>;
  const Eigen::MatrixXd R = rigidBodyModes(coordinates, {});
  const Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor> motions = R;  // by rows: K is read once for all six
  const Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor> forces = K * motions;
  const Small energy = motions.transpose() * forces, measure = R.transpose() * diagonalOf(K).asDiagonal() * R;
  const SymmetricPencil eigen(0.5 * (energy + energy.transpose()), measure);
  Eigen::Index k = 0;
  while (k < 6 && eigen.values[k] <= kNoEnergy) ++k;
  if (k == 6) return R;
  if (k == 0) return Eigen::MatrixXd(R.rows(), 0);
  return orthonormalBasis(R * eigen.vectors.leftCols(k));
}

OwnStiffness::OwnStiffness(std::vector<Part> parts) : parts_(std::move(parts)) {
  for (int i = 0; i < size(); ++i) {
    const std::string problem = problemOfMatrix(part(i).K, part(i).coordinates.size());
    if (!problem.empty()) refuse(part(i), problem);
    const std::vector<int> starts = startsInPlace(*part(i).K);
    if (starts.empty()) {
      look(i, assemble(i));
    } else {
      const auto K = part(i).K->getLocalMatrixHost();
      const auto n = Eigen::Index(starts.size()) - 1;
      look(i, Eigen::Map<const SparseMatrix>(n, n, Eigen::Index(starts.back()), starts.data(), K.graph.entries.data(), K.values.data()));
    }
  }
}

void OwnStiffness::look(int i, const Eigen::Ref<const SparseMatrix>& K) {
  requireSymmetry(part(i), K);
  kernels_.push_back(kernelOf(part(i), K));
  aspects_.push_back(aspectOfPart(coordinates(i), nodeNeighbours(K)));
}

IndexLists OwnStiffness::neighbours(int i) const { return nodeNeighbours(assemble(i)); }

// K is symmetric: its rows as they come are its columns, where their entries are in order.  Otherwise a transposition brings them there.
SparseMatrix OwnStiffness::assemble(int i) const {
  const CrsMatrix& K = *part(i).K;
  const auto n = Eigen::Index(localNumRows(K));
  SparseMatrix result(n, n);
  result.resizeNonZeros(Eigen::Index(localNumEntries(K)));
  int* const begin = result.outerIndexPtr();
  std::fill_n(begin, n + 1, 0);
  bool isInOrder = true;
  forEachRow(K, [&](int row, const LocalOrdinal* columns, const double* values, std::size_t count) {
    std::copy_n(columns, count, result.innerIndexPtr() + begin[row]);
    std::copy_n(values, count, result.valuePtr() + begin[row]);
    begin[row + 1] = begin[row] + int(count);
    for (std::size_t k = 1; k < count; ++k) isInOrder = isInOrder && columns[k - 1] < columns[k];
  });
  if (isInOrder) return result;
  using Rows = Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>>;
  return Rows(n, n, result.nonZeros(), begin, result.innerIndexPtr(), result.valuePtr());
}

// Row by row from the caller's matrix, not from what was factored: it is what residuals are measured with.
void OwnStiffness::multiply(int i, const Eigen::Ref<const Eigen::VectorXd>& u, Eigen::Ref<Eigen::VectorXd> Ku) const {
  forEachRow(*part(i).K, [&](LocalOrdinal row, const LocalOrdinal* columns, const double* values, std::size_t count) {
    double sum = Ku[row];
    for (std::size_t k = 0; k < count; ++k) sum += values[k] * u[columns[k]];
    Ku[row] = sum;
  });
}

// Where the columns of a row are in order, as they mostly are, its diagonal entry is found without looking at the others.
std::vector<double> OwnStiffness::nodalStiffness(int i) const {
  std::vector<double> result(part(i).coordinates.size(), 0.0);
  forEachRow(*part(i).K, [&](int row, const LocalOrdinal* columns, const double* values, std::size_t count) {
    const LocalOrdinal* at = std::lower_bound(columns, columns + count, row);
    if (at == columns + count || *at != row) at = std::find(columns, columns + count, row);
    if (at != columns + count) result[std::size_t(row) / 3] += values[at - columns] / 3;
  });
  return result;
}

}  // namespace Haptos
