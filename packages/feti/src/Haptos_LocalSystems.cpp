// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_LocalSystems.hpp"

#include <Tpetra_MultiVector.hpp>
#include <map>

#include "Haptos_RigidBodyModes.hpp"
#include "Haptos_StiffnessAssembler.hpp"

namespace Haptos {
namespace {

constexpr double kCongruenceTolerance = 1e-12;  // of the largest entry of K

bool samePattern(const Eigen::SparseMatrix<double>& a, const Eigen::SparseMatrix<double>& b) {
  return a.rows() == b.rows() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.outerSize() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr());
}

bool congruent(const LocalSystem& a, const LocalSystem& b) {
  if (!samePattern(a.K, b.K)) return false;
  const Eigen::Map<const Eigen::VectorXd> va(a.K.valuePtr(), a.K.nonZeros()), vb(b.K.valuePtr(), b.K.nonZeros());
  if ((va - vb).lpNorm<Eigen::Infinity>() > kCongruenceTolerance * va.lpNorm<Eigen::Infinity>()) return false;
  return (a.R - b.R).lpNorm<Eigen::Infinity>() <= kCongruenceTolerance * 10;
}

}  // namespace

void LocalSystems::assemble(const std::vector<Subdomain>& subdomains, const std::vector<IsotropicMaterial>& materials,
                            Formulation formulation) {
  systems_.resize(subdomains.size());
  for (std::size_t i = 0; i < subdomains.size(); ++i) {
    systems_[i].K = assembleStiffness(subdomains[i].coordinates, subdomains[i].groups, materials, formulation);
    systems_[i].R = rigidBodyModes(subdomains[i].coordinates, {});
  }
}

void LocalSystems::findClasses() {
  representative_.clear();
  members_.clear();
  std::map<std::pair<Eigen::Index, Eigen::Index>, std::vector<int>> bySize;  // cheap hash: rows, nonzeros
  for (int i = 0; i < size(); ++i) {
    auto& candidates = bySize[{systems_[i].K.rows(), systems_[i].K.nonZeros()}];
    int found = -1;
    for (int c : candidates)
      if (congruent(systems_[representative_[c]], systems_[i])) {
        found = c;
        break;
      }
    if (found < 0) {
      found = numClasses();
      representative_.push_back(i);
      members_.emplace_back();
      candidates.push_back(found);
    }
    systems_[i].congruenceClass = found;
    members_[found].push_back(i);
  }
}

void LocalSystems::factor(const std::vector<Subdomain>& subdomains, LocalSolverMethod method) {
  findClasses();
  solvers_.clear();
  for (int i : representative_)
    solvers_.push_back(std::make_unique<LocalSolver>(systems_[i].K, systems_[i].R, subdomains[i].coordinates, method));
}

void LocalSystems::applyPseudoInverse(const std::vector<std::size_t>& offsets, const MultiVector& f, MultiVector& u) const {
  constexpr int kBlock = 64;  // right-hand sides at once: enough for BLAS 3, small enough for the cache
  for (std::size_t v = 0; v < f.getNumVectors(); ++v) {
    const auto fData = f.getData(v);
    const auto uData = u.getDataNonConst(v);
    for (const auto& members : members_) {
      const Eigen::Index n = systems_[members.front()].K.rows();
      for (std::size_t first = 0; first < members.size(); first += kBlock) {
        const int width = int(std::min<std::size_t>(kBlock, members.size() - first));
        Eigen::MatrixXd B(n, width), X(n, width);
        for (int j = 0; j < width; ++j)
          B.col(j) = Eigen::Map<const Eigen::VectorXd>(fData.getRawPtr() + offsets[members[first + j]], n);
        solver(members.front()).solve(B, X);
        for (int j = 0; j < width; ++j)
          Eigen::Map<Eigen::VectorXd>(uData.getRawPtr() + offsets[members[first + j]], n) = X.col(j);
        localSolves_ += width;
      }
    }
  }
}

}  // namespace Haptos
