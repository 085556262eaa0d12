// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_LocalSystems.hpp"

#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Format.hpp"
#include "Haptos_SparseBlocks.hpp"

namespace Haptos {
namespace {

constexpr double kCongruenceTolerance = 1e-12;  // of the largest entry of K

bool samePattern(const Eigen::SparseMatrix<double>& a, const Eigen::SparseMatrix<double>& b) {
  return a.rows() == b.rows() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr());
}

constexpr int kBlock = 64;  // right-hand sides at once: enough for BLAS 3, small enough for the cache

// "from (0, 0, 0) to (2, 1, 1)"
std::string describeExtent(const Coordinates& coordinates) {
  auto lower = coordinates.front(), upper = lower;
  for (const auto& x : coordinates)
    for (std::size_t d = 0; d < 3; ++d) lower[d] = std::min(lower[d], x[d]), upper[d] = std::max(upper[d], x[d]);
  const auto text = [](const auto& x) { return "(" + formatted("%g", x[0]) + ", " + formatted("%g", x[1]) + ", " + formatted("%g", x[2]) + ")"; };
  return "from " + text(lower) + " to " + text(upper);
}

// Seconds of construction and of the applications of F and M of a typical run, by both ways.  The rates are those of
// one core of a current processor; only their ratios matter.
struct LocalPrediction {
  double explicitSeconds, implicitSeconds, explicitBytes;
};

// Bytes that an application must read, and operations where many members are multiplied together; construction besides.
LocalPrediction predictLocalCost(double n, double nb, std::size_t members) {
  constexpr double kApplications = 30, kTraffic = 2e10, kSparseTraffic = 1.6e10;   // [-], [bytes/s]
  constexpr double kDense = 3e10, kProducts = 4e10, kSparseProducts = 2.5e10;   // [flops/s]
  constexpr double kFillIn = 15, kFactor = 13e-3, kFactorSize = 2187;  // entries of L: 15 n^(4/3); seconds at 2187 unknowns
  constexpr double kRowBytes = 480;  // of K_bb and K_ib for an unknown of the surface, in single precision
  const auto dense = DenseSurfaceMatrices::cost(n, nb, members);
  const double m = double(members), whole = kFillIn * std::pow(n, 4.0 / 3), interior = kFillIn * std::pow(n - nb, 4.0 / 3);
  const double traffic = (m > 2 ? 12 : 6 * m) * nb * nb;  // P in double, S in single precision
  const double denseApply = traffic / kTraffic + (m > 2 ? 3 * nb * nb * m / kProducts : 0.0);
  // L is read forward and, mostly, found in the cache backward; that of the interior is in single precision.
  const double sparseTraffic = 10 * whole + 5 * interior + kRowBytes * nb;
  const double sparseApply = (m > 2 ? 1 : m) * sparseTraffic / kSparseTraffic + (m > 2 ? 4 * (whole + interior) * m / kSparseProducts : 0.0);
  return {dense.flops / kDense + kApplications * denseApply,
          2 * kFactor * std::pow(n / kFactorSize, 1.8) + kApplications * sparseApply, dense.bytes};
}

void addComponents(const Eigen::SparseMatrix<double>& K, Eigen::MatrixX3d& sums) {
  for (Eigen::Index i = 0; i < K.cols(); ++i)  // K is symmetric: columns are rows
    for (Eigen::SparseMatrix<double>::InnerIterator it(K, i); it; ++it) sums(i, it.row() % 3) += std::abs(it.value());
}

// Of the places of entries, in 64 bits (FNV-1a, a word at a time).
std::uint64_t fingerprintOfPattern(const Eigen::SparseMatrix<double>& K) {
  std::uint64_t hash = 14695981039346656037u;
  const auto add = [&](std::uint64_t word) { hash = (hash ^ word) * 1099511628211u; };
  add(std::uint64_t(K.rows()));
  add(std::uint64_t(K.nonZeros()));
  std::for_each(K.innerIndexPtr(), K.innerIndexPtr() + K.nonZeros(), add);
  return hash ^ (hash >> 32);  // what is high and mixed best counts in remainders, too
}

// An assignment of nothing would keep the memory.
void letGo(Eigen::SparseMatrix<double>& K) { Eigen::SparseMatrix<double>().swap(K); }

double largestEntry(const Eigen::SparseMatrix<double>& K) { return K.coeffs().abs().maxCoeff(); }

// Of matrices with as many entries, before all of them are looked at: where nothing is congruent there are many pairs.
bool differAtOnce(const Eigen::SparseMatrix<double>& A, const Eigen::SparseMatrix<double>& B, double largest) {
  const Eigen::Index n = A.nonZeros();
  for (Eigen::Index k : {Eigen::Index(0), n / 2, n - 1})
    if (std::abs(A.valuePtr()[k] - B.valuePtr()[k]) > 2 * kCongruenceTolerance * largest) return true;
  return false;
}

// Whether no motion without energy vanishes on these unknowns, or nearly: singular values of R there, against those of R spread evenly.
bool holds(const Eigen::MatrixXd& R, const std::vector<int>& unknowns) {
  constexpr double kHeld = 1e-3;
  if (R.cols() == 0) return true;
  if (Eigen::Index(unknowns.size()) < R.cols()) return false;
  const double even = std::sqrt(double(unknowns.size()) / double(R.rows()));
  return RightSvd(rowsOf(R, unknowns)).values.minCoeff() > kHeld * even;
}

bool congruent(const LocalSystem& a, const LocalSystem& b) {
  if (!samePattern(a.K, b.K)) return false;
  const Eigen::Map<const Eigen::VectorXd> va(a.K.valuePtr(), a.K.nonZeros()), vb(b.K.valuePtr(), b.K.nonZeros());
  if ((va - vb).lpNorm<Eigen::Infinity>() > kCongruenceTolerance * va.lpNorm<Eigen::Infinity>()) return false;
  return a.R().cols() == b.R().cols() && (a.R() - b.R()).lpNorm<Eigen::Infinity>() <= kCongruenceTolerance * 10;
}

}  // namespace

void LocalSystems::assemble() {
  const int count = source_->size();
  systems_.clear();
  systems_.resize(std::size_t(count));
  copyOf_.assign(std::size_t(count), -1);
  for (int i = 0; i < count; ++i) {
    copyOf_[i] = source_->copyOf(i);
    if (copyOf_[i] >= 0) {
      systems_[i].kernel = systems_[copyOf_[i]].kernel;
      continue;
    }
    systems_[i].magnitude.setZero(3 * Eigen::Index(source_->coordinates(i).size()), 3);
    systems_[i].kernel = std::make_shared<const Eigen::MatrixXd>(source_->kernel(i));
  }
  // Nothing that stays lies between the stiffnesses: those let go leave room for factors, which are larger (decisions/019).
  for (int i = 0; i < count; ++i) {
    if (copyOf_[i] >= 0) {
      systems_[i].pattern = systems_[copyOf_[i]].pattern;
      continue;
    }
    auto K = source_->assemble(i);
    systems_[i].K.swap(K);  // an assignment would copy
    systems_[i].pattern = fingerprintOfPattern(systems_[i].K);
    addComponents(systems_[i].K, systems_[i].magnitude);
  }
}

// Sizes first, entries then, and only against one member of each class: copies that the source knows of are not compared.
void LocalSystems::findClasses() {
  representative_.clear();
  members_.clear();
  std::map<std::pair<Eigen::Index, Eigen::Index>, std::vector<int>> bySize;  // cheap hash: rows, nonzeros
  for (int i = 0; i < size(); ++i) {
    int found = copyOf_[i] >= 0 ? systems_[copyOf_[i]].congruenceClass : -1;
    if (found < 0) {
      auto& candidates = bySize[{systems_[i].K.rows(), systems_[i].K.nonZeros()}];
      const double largest = candidates.empty() ? 0.0 : largestEntry(systems_[i].K);
      for (int c : candidates)
        if (!differAtOnce(systems_[representative_[c]].K, systems_[i].K, largest) &&
            congruent(systems_[representative_[c]], systems_[i])) {
          found = c;
          copyOf_[i] = representative_[c];
          letGo(systems_[i].K);
          systems_[i].magnitude = {};
          break;
        }
      if (found < 0) {
        found = numClasses();
        representative_.push_back(i);
        members_.emplace_back();
        candidates.push_back(found);
      }
    } else {
      copyOf_[i] = representative_[found];
    }
    systems_[i].congruenceClass = found;
    members_[found].push_back(i);
  }
  blocks_.assign(representative_.size(), 0);
}

void LocalSystems::factor(LocalSolverMethod method) {
  findClasses();
  solvers_.clear();
  condensed_.clear();
  for (int i : representative_)
    solvers_.push_back(std::make_unique<LocalSolver>(systems_[i].K, systems_[i].kernel, source_->coordinates(i), method));
  factorizations_ += long(solvers_.size());
}

void LocalSystems::factor(const TouchedUnknowns& touched, LocalSolverMethod method, LocalDual dual, double mayUse,
                          const std::function<void(int)>& lastUse) {
  findClasses();
  solvers_.clear();
  solvers_.resize(representative_.size());
  condensed_.clear();
  condensed_.resize(representative_.size());
  denseBytes_ = 0;
  for (int c = 0; c < numClasses(); ++c) {
    const int i = representative_[c];
    if (dual != LocalDual::Implicit) {
      const auto boundary = boundaryOf(c, touched);
      const auto prediction = predictLocalCost(double(systems_[i].K.rows()), double(boundary.size()), members_[c].size());
      const bool wanted = dual == LocalDual::Explicit ||
                          (prediction.explicitSeconds < prediction.implicitSeconds && denseBytes_ + prediction.explicitBytes < mayUse);
      if (wanted) makeCondensation(c, boundary, DenseSurfaceMatrices::Scope::Both);
    }
    if (!condensed_[c]) makeFactor(c, method);
    if (!lastUse) continue;
    lastUse(c);
    releaseStiffness(c);  // before the next class: its pages serve that one's matrices
  }
}

void LocalSystems::makeFactor(int c, LocalSolverMethod method) try {
  const int i = representative_[c];
  solvers_[c] = std::make_unique<LocalSolver>(systems_[i].K, systems_[i].kernel, source_->coordinates(i), method);
  solvers_[c]->releaseMatrix();
  ++factorizations_;
} catch (const UselessFactor&) {
  throw InsufficientModel("The model cannot be solved with 16 digits: of the part " + describeExtent(source_->coordinates(representative_[c])) +
                          " some deformation meets next to no stiffness beside that of others. Its elements are too flat or too long, its "
                          "materials too different, or its elements joined by next to nothing.");
}

// Rows moved: what is dense on a surface that rows leave or enter is made again, what is sparse does not know of rows.
void LocalSystems::renewSurfaces(const TouchedUnknowns& touched, LocalSolverMethod method, const std::function<void(int)>& lastUse) {
  for (int c = 0; c < numClasses(); ++c) {
    auto K = source_->assemble(representative_[c]);
    systems_[representative_[c]].K.swap(K);
    const auto boundary = boundaryOf(c, touched);
    if (condensed_[c] && condensed_[c]->boundary() != boundary) {
      denseBytes_ -= denseBytesOf(c);
      condensed_[c].reset();
      makeCondensation(c, boundary, DenseSurfaceMatrices::Scope::Both);
      if (!condensed_[c]) makeFactor(c, method);
    }
    lastUse(c);
    releaseStiffness(c);
  }
}

// Of dense matrices that are there.
double LocalSystems::denseBytesOf(int c) const {
  const double n = double(systems_[representative_[c]].R().rows()), nb = double(condensed_[c]->boundary().size());
  return DenseSurfaceMatrices::cost(n, nb, members_[c].size()).bytes;
}

void LocalSystems::releaseStiffness(int c) { letGo(systems_[representative_[c]].K); }

// Surfaces of the softened stiffnesses as those of the others, so that both act on the same unknowns.
void LocalSystems::condenseLike(const LocalSystems& pattern) {
  findClasses();
  condensed_.clear();
  condensed_.resize(representative_.size());
  for (int c = 0; c < numClasses(); ++c) {
    const auto* like = pattern.condensationOf(pattern[representative_[c]].congruenceClass);
    if (like) makeCondensation(c, like->boundary(), DenseSurfaceMatrices::Scope::SchurOnly);
  }
}

// What rows touch, and the rest is free to follow. With the whole surface where that does not hold the subdomain: K_ii would be singular.
std::vector<int> LocalSystems::boundaryOf(int c, const TouchedUnknowns& touched) const {
  const int i = representative_[c];
  const std::vector<int>& dofs = touched.of(i);
  if (holds(systems_[i].R(), dofs)) return dofs;
  const std::vector<int> surface = source_->surface(i);
  std::vector<int> all;
  std::set_union(dofs.begin(), dofs.end(), surface.begin(), surface.end(), std::back_inserter(all));
  return all;
}

// A class that cannot be condensed (its surface does not hold its interior) stays with the sparse factor, which
// regularises it or says what is wrong.
void LocalSystems::makeCondensation(int c, const std::vector<int>& boundary, DenseSurfaceMatrices::Scope scope) {
  const LocalSystem& system = systems_[representative_[c]];
  try {
    condensed_[c] = std::make_unique<DenseSurfaceMatrices>(system.K, system.R(), boundary, members_[c].size(), scope);
  } catch (const std::runtime_error&) {
    return;
  }
  denseBytes_ += denseBytesOf(c);
  if (scope == DenseSurfaceMatrices::Scope::SchurOnly) return;
  localSolves_ += long(boundary.size());
  ++factorizations_;
}

int LocalSystems::numCondensed() const {
  int count = 0;
  for (std::size_t c = 0; c < condensed_.size(); ++c)
    if (condensed_[c]) count += int(members_[c].size());
  return count;
}

FactorWork LocalSystems::work() const {
  FactorWork all;
  for (int c = 0; c < numClasses(); ++c)
    if (const auto* dense = condensationOf(c)) {
      const auto own = dense->work();
      all += {own.flops, own.inverseBytes / double(sizeof(double)), double(blocks_[c]) * own.inverseBytes};
    } else if (!solvers_.empty()) {
      const FactorWork own = solvers_[c]->work();
      all += {own.flops, own.entries, double(blocks_[c]) * own.bytesRead};
    }
  return all;
}

const char* LocalSystems::methodName() const {
  for (const auto& solver : solvers_)
    if (solver) return solver->methodName();
  return "dense";
}

// u = K^+ f on all unknowns, in blocks of members: a factor is read once for a block.
void LocalSystems::solveClass(int c, const std::vector<std::size_t>& offsets, const double* f, double* u) const {
  const auto& members = members_[c];
  const Eigen::Index n = systems_[members.front()].R().rows();
  for (std::size_t first = 0; first < members.size(); first += kBlock) {
    const int width = int(std::min<std::size_t>(kBlock, members.size() - first));
    Eigen::MatrixXd B(n, width), X(n, width);
    for (int j = 0; j < width; ++j) B.col(j) = Eigen::Map<const Eigen::VectorXd>(f + offsets[members[first + j]], n);
    if (const auto* condensed = condensationOf(c)) condensed->solve(B, X);
    else solvers_[c]->solve(B, X);
    ++blocks_[c];
    for (int j = 0; j < width; ++j) Eigen::Map<Eigen::VectorXd>(u + offsets[members[first + j]], n) = X.col(j);
    localSolves_ += width;
  }
}

// u_b = (K^+)_bb f_b: B f has nothing inside, and B^T u asks for nothing there.
void LocalSystems::multiplyClass(int c, const std::vector<std::size_t>& offsets, const double* f, double* u) const {
  const auto& members = members_[c];
  const auto& dofs = condensed_[c]->boundary();
  const Eigen::Index nb = Eigen::Index(dofs.size());
  for (std::size_t first = 0; first < members.size(); first += kBlock) {
    const int width = int(std::min<std::size_t>(kBlock, members.size() - first));
    Eigen::MatrixXd X(nb, width), Y(nb, width);
    for (int j = 0; j < width; ++j) {
      const double* from = f + offsets[members[first + j]];
      for (Eigen::Index i = 0; i < nb; ++i) X(i, j) = from[dofs[i]];
    }
    condensed_[c]->applyInverse(X, Y);
    ++blocks_[c];
    for (int j = 0; j < width; ++j) {
      double* to = u + offsets[members[first + j]];
      for (Eigen::Index i = 0; i < nb; ++i) to[dofs[i]] = Y(i, j);
    }
    localSolves_ += width;
  }
}

void LocalSystems::applyPseudoInverse(const std::vector<std::size_t>& offsets, const MultiVector& f, MultiVector& u) const {
  for (std::size_t v = 0; v < f.getNumVectors(); ++v) {
    const auto fData = f.getData(v);
    const auto uData = u.getDataNonConst(v);
    for (int c = 0; c < numClasses(); ++c) solveClass(c, offsets, fData.getRawPtr(), uData.getRawPtr());
  }
}

void LocalSystems::applyOnSurface(const std::vector<std::size_t>& offsets, const MultiVector& f, MultiVector& u) const {
  for (std::size_t v = 0; v < f.getNumVectors(); ++v) {
    const auto fData = f.getData(v);
    const auto uData = u.getDataNonConst(v);
    for (int c = 0; c < numClasses(); ++c)
      if (condensationOf(c)) multiplyClass(c, offsets, fData.getRawPtr(), uData.getRawPtr());
      else solveClass(c, offsets, fData.getRawPtr(), uData.getRawPtr());
  }
}

}  // namespace Haptos
