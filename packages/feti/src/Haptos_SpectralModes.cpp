// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SpectralModes.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DualPreconditioner.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_SurfaceOperators.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

// Two neighbours of one subdomain that fall together count as one, which does little.  One that falls together with the subdomain
// itself would hide a face: it does so under one prime only, since numbers that agree modulo both are 1147 apart.
constexpr int kPrime = 37, kOtherPrime = 31;
constexpr int kAtATime = 8;  // at a time

// The share in the means of copies of all subdomains of one number modulo `prime`, at every unknown: means of what is 1 on these, else 0.
template <class Take>
void forEachGroup(const DualPreconditioner& M, int prime, Take&& take) {
  const auto& offsets = M.jump().primalOffsets();
  for (int first = 0; first < prime; first += kAtATime) {
    const int width = std::min(kAtATime, prime - first);
    MultiVector t(M.jump().getDomainMap(), std::size_t(width));
    for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
      const int column = (M.jump().firstSubdomain() + int(i)) % prime - first;
      if (column < 0 || column >= width) continue;
      const auto data = t.getDataNonConst(std::size_t(column));
      std::fill(data.begin() + std::ptrdiff_t(offsets[i]), data.begin() + std::ptrdiff_t(offsets[i + 1]), 1.0);
    }
    M.average(t);
    for (int j = 0; j < width; ++j) take(first + j, t.getData(std::size_t(j)));
  }
}

}  // namespace

int columnOfCopies(int subdomain) { return 1 + subdomain % kPrime; }

std::vector<CopyWeights> copyWeights(const DualPreconditioner& M) {
  const auto& offsets = M.jump().primalOffsets();
  const auto groupOf = [&](std::size_t i, int prime) { return (M.jump().firstSubdomain() + int(i)) % prime; };
  const std::size_t count = offsets.size() - 1;
  std::vector<std::vector<Eigen::Triplet<double>>> shares(count);
  std::vector<Eigen::VectorXd> own(count);
  const auto boundaryOf = [&](std::size_t i) -> const std::vector<int>& { return M.surface().boundary(M.systems()[int(i)].congruenceClass); };
  forEachGroup(M, kOtherPrime, [&](int group, const auto& mean) {
    for (std::size_t i = 0; i < count; ++i) {
      if (groupOf(i, kOtherPrime) != group) continue;
      own[i].resize(Eigen::Index(boundaryOf(i).size()));
      for (Eigen::Index k = 0; k < own[i].size(); ++k) own[i][k] = mean[Teuchos_Ordinal(offsets[i]) + boundaryOf(i)[std::size_t(k)]];
    }
  });
  forEachGroup(M, kPrime, [&](int group, const auto& mean) {
    for (std::size_t i = 0; i < count; ++i)
      for (Eigen::Index k = 0; k < own[i].size(); ++k) {
        const double share = mean[Teuchos_Ordinal(offsets[i]) + boundaryOf(i)[std::size_t(k)]];
        if (groupOf(i, kPrime) == group) own[i][k] = std::min(own[i][k], share);
        if (share > 0) shares[i].emplace_back(int(k), 1 + group, share);
      }
  });
  std::vector<CopyWeights> weights;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& share : shares[i]) {
      const double mine = std::max(0.0, own[i][share.row()]);
      const double others = share.col() - 1 == groupOf(i, kPrime) ? share.value() - mine : share.value();
      if (mine * others > 0) entries.emplace_back(share.row(), share.col(), std::sqrt(mine * others));
    }
    for (Eigen::Index k = 0; k < own[i].size(); ++k) entries.emplace_back(int(k), 0, 1 - own[i][k]);
    CopyWeights& D = weights.emplace_back(own[i].size(), 1 + kPrime);
    D.setFromTriplets(entries.begin(), entries.end());
  }
  return weights;
}

// In the scale D = diag(S), as S w = mu D w has it; rigid motions, whose energy is 0, are moved out of the way by what is added to S and
// taken from the other side.
SpectralModes spectralModes(const Eigen::MatrixXd& S, const Eigen::MatrixXd& energy, const Eigen::MatrixXd& rigid, double least) {
  const Eigen::VectorXd root = S.diagonal().cwiseSqrt(), inverse = root.cwiseInverse();
  Eigen::MatrixXd B = inverse.asDiagonal() * S * inverse.asDiagonal(), A = inverse.asDiagonal() * energy * inverse.asDiagonal();
  const Eigen::MatrixXd scaledRigid = root.asDiagonal() * rigid, Q = orthonormalBasis(scaledRigid);
  const Eigen::MatrixXd AQ = A * Q, QAQ = Q.transpose() * AQ, half = AQ - 0.5 * Q * QAQ;
  A -= Q * half.transpose() + half * Q.transpose();
  B += 2 * B.trace() * Q * Q.transpose();
  const LargestEigen eigen(std::move(A), std::move(B), least);
  return {eigen.values.reverse(), inverse.asDiagonal() * eigen.vectors.rowwise().reverse()};
}

}  // namespace Haptos
