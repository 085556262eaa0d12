// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualMortar.hpp"

#include <algorithm>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {
namespace {

constexpr double kSingular = 1e-8;   // of the largest eigenvalue of M', scaled to 1
constexpr double kNegligible = 1e-14;  // of a row whose weights add up to 1: what biorthogonality leaves of zeros

constexpr double kWhole = 0.99;        // of a face's area: as good as all of it, as facets of curved faces cover each other but so well
constexpr double kAlpha = 0.2;         // what corners take of the middles beside them

// Functions of the corners of a face: middles and centre are means of corners.
Eigen::MatrixXd cornerFunctions(int size) {
  const int corners = numCorners(size);
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(corners, size);
  for (int i = 0; i < corners; ++i) {
    C(i, i) = 1;
    if (isLinear(size)) continue;
    C(i, corners + i) = C(i, corners + (i + corners - 1) % corners) = 0.5;
    if (size == 9) C(i, 8) = 0.25;
  }
  return C;
}

// Functions of all nodes of a quadratic face, whose integrals are positive.
Eigen::MatrixXd fullFunctions(int size) {
  Eigen::MatrixXd C = Eigen::MatrixXd::Identity(size, size);
  if (size == 9) return C;
  const int corners = numCorners(size);
  for (int i = 0; i < corners; ++i) {
    C(corners + i, corners + i) = 1 - 2 * kAlpha;
    C(i, corners + i) = C((i + 1) % corners, corners + i) = kAlpha;
  }
  return C;
}

// C: [kept nodes of the face x its nodes]
struct FaceBasis {
  std::vector<std::size_t> kept;  // places in the face
  Eigen::MatrixXd C;
  bool isShared = false;

  explicit FaceBasis(int size) : C(fullFunctions(size)) {
    for (std::size_t i = 0; i < std::size_t(size); ++i) kept.push_back(i);
  }
  FaceBasis(std::vector<std::size_t> corners, int size) : kept(std::move(corners)) {
    const auto k = Eigen::Index(kept.size()), all = Eigen::Index(numCorners(size));
    isShared = k < all;
    Eigen::MatrixXd shares = Eigen::MatrixXd::Constant(k, all, 1.0 / double(k));
    for (Eigen::Index i = 0; i < k; ++i) shares.col(Eigen::Index(kept[std::size_t(i)])) = Eigen::VectorXd::Unit(k, i);
    C = shares * cornerFunctions(size);
  }
};

std::vector<std::size_t> keptCorners(const SurfaceFace& face, const std::vector<char>& isKept) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < std::size_t(numCorners(face.size)); ++i)
    if (isKept[std::size_t(face.nodes[i])]) places.push_back(i);
  return places;
}

// A C with A = diag(d') M'^-1: coefficients of phi in N.  M' is scaled to d' first, which makes 1 its largest eigenvalue.
Eigen::MatrixXd dualCoefficients(const FaceIntegrals& sums, FaceBasis& basis) {
  const Eigen::VectorXd root = (basis.C * sums.d).cwiseSqrt();
  const Eigen::VectorXd inverse = root.cwiseInverse();
  const SymmetricEigen scaled(inverse.asDiagonal() * (basis.C * sums.M * basis.C.transpose()) * inverse.asDiagonal());
  if (basis.kept.size() > 1 && !(scaled.values[0] > kSingular)) {
    Eigen::Index largest = 0;
    root.maxCoeff(&largest);
    basis = FaceBasis({basis.kept[std::size_t(largest)]}, int(sums.d.size()));
    return basis.C;
  }
  return root.asDiagonal() * (scaled.vectors * scaled.values.cwiseInverse().asDiagonal() * scaled.vectors.transpose()) *
         inverse.asDiagonal() * basis.C;
}

using Entries = std::vector<std::pair<int, double>>;

void add(Entries& entries, const SurfaceFace& face, const Eigen::RowVectorXd& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i) entries.emplace_back(face.nodes[std::size_t(i)], values[i]);
}

// Each node once, divided by w.
void finish(Entries& entries, double w) {
  std::sort(entries.begin(), entries.end());
  Entries merged;
  for (const auto& [node, value] : entries) {
    if (merged.empty() || merged.back().first != node) merged.emplace_back(node, 0.0);
    merged.back().second += value / w;
  }
  merged.erase(std::remove_if(merged.begin(), merged.end(), [](const auto& item) { return std::abs(item.second) < kNegligible; }),
               merged.end());
  entries = std::move(merged);
}

// The least barred of those corners that are not taken, of these the one with the largest integral d; -1: all are taken.
int bestCorner(const SurfaceFace& face, const Eigen::VectorXd& d, const std::vector<Bar>& bars) {
  const auto barOf = [&](int i) { return bars[std::size_t(face.nodes[std::size_t(i)])]; };
  int best = -1;
  for (int i = 0; i < int(d.size()); ++i)
    if (barOf(i) != Bar::Taken && (best < 0 || barOf(i) < barOf(best) || (barOf(i) == barOf(best) && d[i] > d[best]))) best = i;
  return best;
}

}  // namespace

MultiplierNodes chooseMultipliers(const ContactSurface& secondary, const SurfaceOverlap& overlap, const std::vector<Bar>& bars,
                                  bool linearOnly) {
  MultiplierNodes result{std::vector<char>(secondary.numNodes(), 0), std::vector<char>(secondary.faces.size(), 0)};
  const auto isFree = [&](int node) { return overlap.isCovered[std::size_t(node)] && bars[std::size_t(node)] == Bar::None; };
  for (std::size_t f = 0; f < secondary.faces.size(); ++f) {
    const SurfaceFace& face = secondary.faces[f];
    const auto first = face.nodes.begin(), end = first + face.size;
    result.isFull[f] = !linearOnly && !isLinear(face.size) && overlap.faces[f].area >= kWhole * overlap.areas[f] && std::all_of(first, end, isFree);
    if (!(overlap.faces[f].area > 0)) continue;
    std::for_each(first, result.isFull[f] ? end : first + numCorners(face.size), [&](int node) {
      if (isFree(node)) result.isKept[std::size_t(node)] = 1;
    });
  }
  for (std::size_t f = 0; f < secondary.faces.size(); ++f) {
    const SurfaceFace& face = secondary.faces[f];
    if (!(overlap.faces[f].area > 0) || !keptCorners(face, result.isKept).empty()) continue;
    const int best = bestCorner(face, cornerFunctions(face.size) * overlap.faces[f].d, bars);
    if (best >= 0) result.isKept[std::size_t(face.nodes[std::size_t(best)])] = 1;
  }
  return result;
}

std::vector<MortarRow> dualMortarRows(const ContactSurface& secondary, const ContactSurface& primary, const SurfaceOverlap& overlap,
                                      const MultiplierNodes& multipliers) {
  std::vector<MortarRow> rows(secondary.numNodes());
  std::vector<double> facesAt(secondary.numNodes(), 0.0);
  for (std::size_t f = 0; f < secondary.faces.size(); ++f) {
    const SurfaceFace& face = secondary.faces[f];
    const FaceIntegrals& sums = overlap.faces[f];
    auto places = keptCorners(face, multipliers.isKept);
    if (!(sums.area > 0) || places.empty()) continue;
    FaceBasis basis = multipliers.isFull[f] ? FaceBasis(face.size) : FaceBasis(std::move(places), face.size);
    const Eigen::MatrixXd phi = dualCoefficients(sums, basis);
    const Eigen::MatrixXd D = phi * sums.M, gap = phi * sums.gap;
    const Eigen::VectorXd w = phi * sums.d;
    for (int i = 0; i < face.size; ++i) ++facesAt[std::size_t(face.nodes[std::size_t(i)])];
    for (std::size_t k = 0; k < basis.kept.size(); ++k) {
      const auto row = Eigen::Index(k);
      MortarRow& target = rows[std::size_t(face.nodes[basis.kept[k]])];
      target.w += w[row];
      target.isShared = target.isShared || basis.isShared;
      add(target.secondary, face, D.row(row));
      add(target.spread, face, basis.C.row(row));
      for (const auto& [other, N] : sums.across) add(target.primary, primary.faces[std::size_t(other)], phi.row(row) * N);
      for (std::size_t c = 0; c < 3; ++c) target.gap[c] += gap(row, Eigen::Index(c));
    }
  }
  std::vector<MortarRow> kept;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!(rows[i].w > 0)) continue;
    rows[i].node = int(i);
    finish(rows[i].secondary, rows[i].w);
    finish(rows[i].primary, rows[i].w);
    for (auto& [node, share] : rows[i].spread) share /= facesAt[std::size_t(node)];
    finish(rows[i].spread, 1);
    for (double& g : rows[i].gap) g /= rows[i].w;
    kept.push_back(std::move(rows[i]));
  }
  return kept;
}

}  // namespace Haptos
