// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SpectralModes.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_NeighbourStiffness.hpp"
#include "Haptos_Reductions.hpp"
#include "HeldBeams.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

// Flat elements.
struct FlatBeams : HeldBeams {
  explicit FlatBeams(double distortion = 0) : HeldBeams(0.2, distortion) {}
  const std::vector<int>& boundary(int i) const { return M->surface().boundary((*feti.systems)[i].congruenceClass); }

  Dense stiffness(int i) const {
    const Eigen::Index n = Eigen::Index(boundary(i).size());
    Dense S(n, n);
    M->surface().apply((*feti.systems)[i].congruenceClass, Dense::Identity(n, n), S);
    return 0.5 * (S + S.transpose());
  }
  std::vector<Dense> stiffnesses() const {
    std::vector<Dense> all(std::size_t(feti.systems->numClasses()));
    for (int i = 0; i < feti.systems->size(); ++i) all[std::size_t((*feti.systems)[i].congruenceClass)] = stiffness(i);
    return all;
  }
  Eigen::VectorXd motionOffContact(int i) const {
    Eigen::VectorXd w(Eigen::Index(boundary(i).size()));
    for (Eigen::Index k = 0; k < w.size(); ++k) w[k] = std::sin(1.3 * double(k) + double(i));
    for (const CoupledCopy& copy : feti.dealt.jump->multipliers().coupledCopies())
      for (Eigen::Index k = 0; k < w.size(); ++k)
        if (copy.subdomain == feti.dealt.jump->firstSubdomain() + i && boundary(i)[std::size_t(k)] / 3 == copy.localNode) w[k] = 0;
    return w;
  }
  // sum over the subdomains of all ranks
  double energyOf(const MultiVector& t) const {
    double mine = 0;
    for (int i = 0; i < feti.systems->size(); ++i) {
      Eigen::VectorXd w(Eigen::Index(boundary(i).size()));
      for (Eigen::Index k = 0; k < w.size(); ++k)
        w[k] = t.getData(0)[std::ptrdiff_t(feti.dealt.jump->primalOffsets()[std::size_t(i)]) + boundary(i)[std::size_t(k)]];
      mine += w.dot(stiffness(i) * w);
    }
    return sumOfAll(*t.getMap()->getComm(), mine);
  }
  Dense rigid(int i) const {
    Dense R(Eigen::Index(boundary(i).size()), 6);
    for (Eigen::Index k = 0; k < R.rows(); ++k) R.row(k) = (*feti.systems)[i].R().row(boundary(i)[std::size_t(k)]);
    return R;
  }
};

}  // namespace

// What is left to a subdomain of a unit displacement of one unknown, by B_D^T B itself, one unknown of every subdomain of the scene at a time.
TEUCHOS_UNIT_TEST(SpectralModes, WeightsAreThoseOfThePreconditioner) {
  const FlatBeams t;
  const std::vector<CopyWeights> weights = copyWeights(*t.M);
  TEST_EQUALITY(weights.size(), t.feti.dealt.mine.size());
  const int first = t.feti.dealt.jump->firstSubdomain();
  for (int subdomain = 0; subdomain < t.scene.partition.count; ++subdomain)
    for (int k = 0; k < 40; k += 3) {
      const int i = subdomain - first;
      const bool isMine = i >= 0 && i < int(weights.size()) && k < int(t.boundary(i).size());
      MultiVector e(t.feti.dealt.jump->getDomainMap(), 1), jumps(t.feti.map(), 1), moved(e.getMap(), 1);
      const std::size_t at = isMine ? t.feti.dealt.jump->primalOffsets()[std::size_t(i)] + std::size_t(t.boundary(i)[std::size_t(k)]) : 0;
      if (isMine) e.getDataNonConst(0)[std::ptrdiff_t(at)] = 1;
      t.feti.dealt.jump->apply(e, jumps);
      t.M->spread(jumps, moved);
      if (!isMine) continue;
      const double left = moved.getData(0)[std::ptrdiff_t(at)];
      TEST_COMPARE(std::abs(weights[std::size_t(i)].coeff(k, 0) - left), <=, 1e-12);
    }
  // where nothing is prescribed the shares of all copies are 1 together: sum v_i v_j = v_i (1 - v_i)
  int shared = 0;
  for (const CopyWeights& D : weights) {
    const Dense all = D;
    for (Eigen::Index k = 0; k < all.rows(); ++k) {
      const double own = 1 - all(k, 0), others = all.row(k).tail(all.cols() - 1).squaredNorm();
      if (own == 0) continue;
      ++shared;
      TEST_COMPARE(std::abs(others - own * (1 - own)), <=, 1e-12);
    }
  }
  TEST_ASSERT(shared > 0 || weights.empty());
}

// By B_D^T B itself and all S, of motions of one subdomain that contact does not see: those of neighbours on other ranks, too.
TEUCHOS_UNIT_TEST(NeighbourStiffness, IsTheEnergyOfCopiesThatPart) {
  const FlatBeams t;
  const JumpOperator& jump = *t.feti.dealt.jump;
  const std::vector<Dense> S = t.stiffnesses();
  const NeighbourStiffness neighbours(*t.M, S);
  for (int subdomain = 0; subdomain < t.scene.partition.count; ++subdomain) {
    const int i = subdomain - jump.firstSubdomain();
    const bool isMine = i >= 0 && i < t.feti.systems->size();
    MultiVector e(jump.getDomainMap(), 1), jumps(t.feti.map(), 1), moved(e.getMap(), 1);
    const Eigen::VectorXd w = isMine ? t.motionOffContact(i) : Eigen::VectorXd();
    for (Eigen::Index k = 0; k < w.size(); ++k)
      e.getDataNonConst(0)[std::ptrdiff_t(jump.primalOffsets()[std::size_t(i)]) + t.boundary(i)[std::size_t(k)]] = w[k];
    jump.apply(e, jumps);
    t.M->spread(jumps, moved);
    const double all = t.energyOf(moved);
    if (!isMine) continue;
    TEST_COMPARE(all, >, 0.0);
    TEST_COMPARE(std::abs(w.dot(neighbours.energy(i) * w) / all - 1), <=, 1e-11);
  }
}

// Where no neighbour's S is made its own stands for all of them.
TEUCHOS_UNIT_TEST(NeighbourStiffness, TakesItsOwnWhereANeighbourHasNone) {
  const FlatBeams t(0.1);  // no two subdomains are congruent
  const LocalSystems& systems = *t.feti.systems;
  const std::vector<CopyWeights> weights = copyWeights(*t.M);
  const auto shared = sharedBoundaries(*t.M);
  const int first = t.feti.dealt.jump->firstSubdomain();
  int compared = 0;
  for (int subdomain = 0; subdomain < t.scene.partition.count; ++subdomain) {
    const int i = subdomain - first;
    const bool isMine = i >= 0 && i < systems.size();
    std::vector<Dense> S(std::size_t(systems.numClasses()));
    if (isMine) S[std::size_t(systems[i].congruenceClass)] = t.stiffness(i);
    const NeighbourStiffness neighbours(*t.M, S);
    if (!isMine) continue;
    const auto isAlike = [&](const SharedBoundary& b) {
      const int j = b.neighbour - first;
      return j >= 0 && j < systems.size() && systems[j].congruenceClass == systems[i].congruenceClass;
    };
    if (std::any_of(shared[std::size_t(i)].begin(), shared[std::size_t(i)].end(), isAlike)) continue;
    ++compared;
    const Dense D = weights[std::size_t(i)], expected = t.stiffness(i).cwiseProduct(D * D.transpose());
    TEST_COMPARE((neighbours.energy(i) - expected).cwiseAbs().maxCoeff(), <=, 1e-12 * expected.cwiseAbs().maxCoeff());
  }
  TEST_ASSERT(compared > 0 || systems.size() == 0);
}

// All eigenvalues by another way: with S = C^T C beside the rigid motions.
TEUCHOS_UNIT_TEST(SpectralModes, AreThoseThatWeightsMakeStiff) {
  constexpr double kLeast = 2;
  const FlatBeams t;
  const std::vector<CopyWeights> weights = copyWeights(*t.M);
  for (int i = 0; i < int(weights.size()); ++i) {
    const Dense S = t.stiffness(i), R = t.rigid(i), D = weights[std::size_t(i)];
    Dense A = Dense::Zero(S.rows(), S.cols());
    for (Eigen::Index g = 0; g < D.cols(); ++g) A += D.col(g).asDiagonal() * S * D.col(g).asDiagonal();
    const SpectralModes found = spectralModes(S, A, R, kLeast);
    for (Eigen::Index j = 0; j < found.modes.cols(); ++j) {
      const Eigen::VectorXd w = found.modes.col(j);
      const double energy = w.dot(S * w);
      TEST_COMPARE(std::abs(w.dot(A * w) / energy / found.theta[j] - 1), <=, 1e-8);
      TEST_COMPARE((t.rigid(i).transpose() * S.diagonal().cwiseProduct(w)).norm(), <=, 1e-7 * S.diagonal().cwiseProduct(w).norm());
    }
    // motions beside rigid ones, in the product of diag S
    const Eigen::VectorXd root = S.diagonal().cwiseSqrt();
    const Dense all = squareQ(root.asDiagonal() * R);
    const Dense V = root.cwiseInverse().asDiagonal() * all.rightCols(S.rows() - 6);
    const Eigen::VectorXd theta = generalizedEigenvalues(V.transpose() * A * V, V.transpose() * S * V);
    TEST_EQUALITY(found.theta.size(), (theta.array() > kLeast).count());
    TEST_ASSERT(found.theta.size() > 0);
    for (Eigen::Index j = 0; j < found.theta.size(); ++j) TEST_COMPARE(std::abs(found.theta[j] / theta[theta.size() - 1 - j] - 1), <=, 1e-7);
  }
}
