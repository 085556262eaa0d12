// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DualMortar.hpp"

#include <algorithm>

#include "Haptos_DenseDecompositions.hpp"

namespace Haptos {
namespace {

constexpr double kSingular = 1e-8;   // of the largest eigenvalue of M', scaled to 1
constexpr double kNegligible = 1e-14;  // of a row whose weights add up to 1: what biorthogonality leaves of zeros

// C: [kept nodes of the face x its nodes]
struct FaceBasis {
  std::vector<std::size_t> kept;  // places in the face
  Eigen::MatrixXd C;
  bool isShared = false;

  FaceBasis(std::vector<std::size_t> places, Eigen::Index size) : kept(std::move(places)) {
    const auto k = Eigen::Index(kept.size());
    isShared = k < size;
    C = Eigen::MatrixXd::Constant(k, size, 1.0 / double(k));
    for (Eigen::Index i = 0; i < k; ++i) C.col(Eigen::Index(kept[std::size_t(i)])) = Eigen::VectorXd::Unit(k, i);
  }
};

std::vector<std::size_t> keptPlaces(const SurfaceFace& face, const std::vector<char>& isKept) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < std::size_t(face.size); ++i)
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
    basis = FaceBasis({basis.kept[std::size_t(largest)]}, sums.d.size());
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

}  // namespace

std::vector<char> keptNodes(const ContactSurface& secondary, const SurfaceOverlap& overlap, const std::vector<char>& isBarred) {
  std::vector<char> isKept = overlap.isCovered;
  for (std::size_t i = 0; i < isKept.size(); ++i) isKept[i] = isKept[i] && !isBarred[i];
  for (std::size_t f = 0; f < secondary.faces.size(); ++f) {
    const SurfaceFace& face = secondary.faces[f];
    const FaceIntegrals& sums = overlap.faces[f];
    if (!(sums.area > 0) || !keptPlaces(face, isKept).empty()) continue;
    int best = -1;
    for (int i = 0; i < face.size; ++i)
      if (!isBarred[std::size_t(face.nodes[std::size_t(i)])] && (best < 0 || sums.d[i] > sums.d[best])) best = i;
    if (best >= 0) isKept[std::size_t(face.nodes[std::size_t(best)])] = 1;
  }
  return isKept;
}

std::vector<MortarRow> dualMortarRows(const ContactSurface& secondary, const ContactSurface& primary, const SurfaceOverlap& overlap,
                                      const std::vector<char>& isKept) {
  std::vector<MortarRow> rows(secondary.numNodes());
  for (std::size_t f = 0; f < secondary.faces.size(); ++f) {
    const SurfaceFace& face = secondary.faces[f];
    const FaceIntegrals& sums = overlap.faces[f];
    auto places = keptPlaces(face, isKept);
    if (!(sums.area > 0) || places.empty()) continue;
    FaceBasis basis(std::move(places), face.size);
    const Eigen::MatrixXd phi = dualCoefficients(sums, basis);
    const Eigen::MatrixXd D = phi * sums.M, gap = phi * sums.gap;
    const Eigen::VectorXd w = phi * sums.d;
    for (std::size_t k = 0; k < basis.kept.size(); ++k) {
      const auto row = Eigen::Index(k);
      MortarRow& target = rows[std::size_t(face.nodes[basis.kept[k]])];
      target.w += w[row];
      target.isShared = target.isShared || basis.isShared;
      add(target.secondary, face, D.row(row));
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
    for (double& g : rows[i].gap) g /= rows[i].w;
    kept.push_back(std::move(rows[i]));
  }
  return kept;
}

}  // namespace Haptos
