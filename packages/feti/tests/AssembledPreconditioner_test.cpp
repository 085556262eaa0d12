// SPDX-License-Identifier: BSD-3-Clause
// F^-1 by a factor of whole bodies, against dense formulas: all of it, and between contact rows in three ways.
#include "Haptos_AssembledPreconditioner.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>

#include "Haptos_LocalSystems.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "HeldBeams.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

constexpr AssembledPreconditioner::Limits kNoLimits{1e30, 1.0, 1e30};

// Beams or plates held at one end.
struct AssembledBeams : HeldBeams {
  RCP<const AssembledPreconditioner> assembled;

  explicit AssembledBeams(double height) : HeldBeams(height, 0, {4, 2, 2}), assembled(AssembledPreconditioner::make(M, feti.systems, kNoLimits)) {}

  const std::vector<LocalPair>& pairs() const { return feti.dealt.jump->multipliers().pairs(); }
  // Rows of the contact values of all ranks, by global numbers.
  std::vector<int> contactRows() const {
    std::vector<int> rows;
    for (const LocalPair& pair : pairs())
      for (const int row : {pair.normal, pair.tangential[0], pair.tangential[1]}) rows.push_back(int(feti.map()->getGlobalElement(row)));
    return gatheredOnAll(*feti.map()->getComm(), rows);
  }
  Eigen::Index firstValue() const { return sumOfLower(*feti.map()->getComm(), 3 * Eigen::Index(pairs().size())); }
  Eigen::VectorXd mine(const Eigen::VectorXd& all) const { return all.segment(firstValue(), 3 * Eigen::Index(pairs().size())); }
  double largestOf(const Eigen::VectorXd& x) const { return largestOfAll(*feti.map()->getComm(), x.size() > 0 ? x.cwiseAbs().maxCoeff() : 0.0); }
};

Eigen::Matrix3d blockOf(Eigen::Index pair, double stiffness) {
  const Eigen::Matrix3d A = Eigen::Matrix3d::NullaryExpr([&](Eigen::Index i, Eigen::Index j) { return std::sin(1.0 + double(3 * pair + i + 5 * j)); });
  return stiffness * std::pow(10.0, double(pair % 5) - 3) * A * A.transpose();
}

}  // namespace

// P F M F P = P F P with P = 1 - G^T (G G^T)^-1 G, and G M = 0; plates 1 : .02 bend 1e5 times softer than nodes give way.  F feels nothing of pinned rows.
TEUCHOS_UNIT_TEST(AssembledPreconditioner, IsTheInverseOfFInBalance) {
  for (double height : {1.0, 0.02}) {
    const AssembledBeams t(height);
    TEST_ASSERT(!t.assembled.is_null());
    const Eigen::Index l = 6 * t.scene.partition.count;
    MultiVector columns(t.feti.map(), std::size_t(l));
    t.feti.G->applyGT(Dense::Identity(l, l), columns);
    const Dense GT = gathered(columns), F = denseOf(*t.feti.F), M = denseOf(*t.assembled);
    const Dense P = Dense::Identity(F.rows(), F.rows()) - GT * densePseudoInverse(GT.transpose() * GT) * GT.transpose();
    const Dense PFP = P * F * P;
    TEST_COMPARE(largest(P * F * M * F * P - PFP), <=, 1e-8 * largest(PFP));
    TEST_COMPARE(largest(GT.transpose() * M), <=, 1e-10 * largest(M) * largest(GT));
    TEST_COMPARE(largest(M - M.transpose()), <=, 1e-10 * largest(M));
  }
}

TEUCHOS_UNIT_TEST(AssembledPreconditioner, IsKnownBetweenContactRows) {
  for (double height : {1.0, 0.02}) {
    const AssembledBeams t(height);
    const std::vector<int> rows = t.contactRows();
    const Dense wanted = denseOf(*t.assembled)(rows, rows), M = t.assembled->contactMatrix();
    TEST_COMPARE(largest(M - wanted), <=, 1e-10 * largest(wanted));
    const Eigen::VectorXd x = Eigen::VectorXd::NullaryExpr(wanted.rows(), [](Eigen::Index i) { return std::sin(double(i * i)); });
    TEST_COMPARE(t.largestOf(t.assembled->onContact(t.mine(x)) - t.mine(wanted * x)), <=, 1e-10 * largest(wanted));

    // Rows of which M has nothing are pinned: no jump, whatever y.
    const Eigen::VectorXd felt = (wanted.diagonal().array() > 0).cast<double>();
    TEST_COMPARE(felt.sum(), <, double(felt.size()));
    Dense MD = wanted;
    std::vector<Eigen::Matrix3d> D;
    for (Eigen::Index pair = 0; pair < MD.rows() / 3; ++pair) {
      const auto keeps = felt.segment<3>(3 * pair).asDiagonal();
      const Eigen::Matrix3d block = keeps * blockOf(pair, largest(wanted)) * keeps;
      MD.block<3, 3>(3 * pair, 3 * pair) += block;
      if (3 * pair >= t.firstValue() && D.size() < t.pairs().size()) D.push_back(block);
    }
    MD.diagonal() += largest(wanted) * (1 - felt.array()).matrix();
    const auto solve = t.assembled->solverWith(D);
    for (const Eigen::VectorXd& y : {x, Eigen::VectorXd(x.reverse())}) {
      const Eigen::VectorXd d = Testing::ldltSolve(MD, felt.cwiseProduct(y));
      TEST_COMPARE(t.largestOf(solve(t.mine(y)) - t.mine(d)), <=, 1e-9 * largest(d));
    }
  }
}

// Nothing is kept of what would take more than it may; what is cheaper is told by the model of contact.
TEUCHOS_UNIT_TEST(AssembledPreconditioner, KeepsToItsLimits) {
  const AssembledBeams t(1.0);
  const auto with = [&](double flops, double denseModel, double bytes) { return AssembledPreconditioner::make(t.M, t.feti.systems, {flops, denseModel, bytes}); };
  TEST_ASSERT(with(1, 1, 1e30).is_null());
  TEST_ASSERT(with(1e30, 1, 1).is_null());
  TEST_ASSERT(with(1e30, 1, 1e30)->isDenseCheaper());
  TEST_ASSERT(!with(1e30, 1e29, 1e30)->isDenseCheaper());
}

// Bodies that nothing holds have no inverse.
TEUCHOS_UNIT_TEST(AssembledPreconditioner, IsNoneOfBodiesThatNothingHolds) {
  SceneOptions options = heldScene(4);
  options.hold = [](int, const Point&) { return std::string(); };
  const Scene scene = makeScene(options);
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
  const std::vector<char> all(feti.dealt.mine.size(), 1);
  const auto M = Teuchos::rcp(new DualPreconditioner(
      feti.dealt.jump, feti.systems,
      SurfaceOperators(*feti.systems, {*feti.systems, *feti.dealt.jump}, PreconditionerKind::Dirichlet, LocalSolverMethod::Automatic, all)));
  const auto assembled = AssembledPreconditioner::make(M, feti.systems, kNoLimits);
  TEST_ASSERT(assembled.is_null());
}
