// SPDX-License-Identifier: BSD-3-Clause
// The preconditioner of a small scene as a dense matrix.
#pragma once
#include <algorithm>
#include <set>

#include "FetiScene.hpp"
#include "Haptos_SurfaceOperators.hpp"

namespace Haptos::Testing {

inline bool samePattern(const Subdomain& a, const Subdomain& b) {
  return std::equal(a.groups.begin(), a.groups.end(), b.groups.begin(), b.groups.end(), [](const auto& x, const auto& y) {
    return x.topology == y.topology && x.connectivity == y.connectivity;
  });
}

/// Unknowns that rows touch in a subdomain or in one whose K has the same pattern.
inline std::vector<int> boundaryOf(const Scene& scene, const Subdomain& sub) {
  std::set<int> all;
  for (const auto& entry : scene.rows.entries)
    if (samePattern(scene.subdomains[std::size_t(entry.subdomain)], sub)) all.insert(entry.dof);
  return {all.begin(), all.end()};
}

/// W: 1 / weight where B has an entry, 0 elsewhere.
inline Eigen::VectorXd denseW(const Scene& scene) {
  const auto offsets = scene.offsets();
  Eigen::VectorXd w = Eigen::VectorXd::Zero(offsets.back());
  for (const auto& entry : scene.rows.entries) w[offsets[entry.subdomain] + entry.dof] = 1.0 / entry.weight;
  return w;
}

/// Schur complement on the surface, or its block of K; zero elsewhere.
inline Dense denseS(const std::vector<int>& boundary, const Dense& K, PreconditionerKind kind) {
  std::vector<char> on(K.rows(), 0);
  for (int i : boundary) on[i] = 1;
  std::vector<int> interior;
  for (int i = 0; i < K.rows(); ++i)
    if (!on[i]) interior.push_back(i);
  const Eigen::Index nb = Eigen::Index(boundary.size()), ni = Eigen::Index(interior.size());
  Dense Kbb(nb, nb), Kib(ni, nb), Kii(ni, ni);
  for (Eigen::Index j = 0; j < nb; ++j) {
    for (Eigen::Index i = 0; i < nb; ++i) Kbb(i, j) = K(boundary[i], boundary[j]);
    for (Eigen::Index i = 0; i < ni; ++i) Kib(i, j) = K(interior[i], boundary[j]);
  }
  for (Eigen::Index j = 0; j < ni; ++j)
    for (Eigen::Index i = 0; i < ni; ++i) Kii(i, j) = K(interior[i], interior[j]);
  if (kind == PreconditionerKind::Dirichlet && ni > 0) Kbb -= Kib.transpose() * ldltSolve(Kii, Kib);
  Dense S = Dense::Zero(K.rows(), K.rows());
  for (Eigen::Index j = 0; j < nb; ++j)
    for (Eigen::Index i = 0; i < nb; ++i) S(boundary[i], boundary[j]) = Kbb(i, j);
  return S;
}

inline Dense denseM(const Scene& scene, PreconditionerKind kind) {
  const Dense B = denseB(scene);
  const Dense BW = B * denseW(scene).asDiagonal();
  const Dense BD = densePseudoInverse(BW * B.transpose()) * BW;
  const auto K = denseStiffness(scene);
  const auto offsets = scene.offsets();
  Dense M = Dense::Zero(B.rows(), B.rows());
  for (std::size_t s = 0; s < K.size(); ++s) {
    const Dense D = BD.middleCols(offsets[s], K[s].rows());
    M += D * denseS(boundaryOf(scene, scene.subdomains[s]), K[s], kind) * D.transpose();
  }
  return M;
}

}  // namespace Haptos::Testing
