// SPDX-License-Identifier: BSD-3-Clause
// Coarse matrices of which a part changes: in single precision, in a series, and where a part is not positive definite.
#include <Teuchos_UnitTestHarness.hpp>

#include "CoarseScene.hpp"
#include "Haptos_DenseSymmetric.hpp"

using namespace Haptos;
using namespace Haptos::Testing;

// What changes may be factored in single precision, where something is condensed.
TEUCHOS_UNIT_TEST(CoarseProblem, RoughRenewalsHaveSomeDigits) {
  for (int touched : {10, Chain::kSubdomains}) {
    const Chain chain(touched);
    const Dense b = someColumns(chain.fixed.cols(), 2);
    const Dense wanted = choleskySolve(denseGram(chain.fixed, chain.q) + denseGram(chain.changing, chain.q), b);
    for (const Case& c : allCases(chain.comm->getSize())) {
      CoarseProblem A(chain.place(c.options), {chain.fixed, chain.q}, {chain.changing, chain.q}, {}, CoarseProblem::Factor::WithRoughRenewal);
      A.renew({chain.changing, chain.q});
      const Dense error = A.solve(b) - wanted;
      TEST_ASSERT(isSmall(error, wanted, 1e-3));
      const bool isSingle = hasCholmod() && touched < Chain::kSubdomains && !ranksShare(c, *chain.comm);
      TEST_EQUALITY(largest(error) > 1e-10 * largest(wanted), isSingle);
      const CoarseProblem fixedAlone(A, {});  // in double all the same
      TEST_ASSERT(isSmall(denseGram(chain.fixed, chain.q) * fixedAlone.solve(b) - b, b, 1e-10));
    }
  }
}

TEUCHOS_UNIT_TEST(SingleCholesky, SolvesOrSaysThatItDoesNot) {
  const Dense X = someColumns(60, 60), B = someColumns(60, 2);
  const Eigen::VectorXd units = Eigen::VectorXd::LinSpaced(60, -200, 200).unaryExpr([](double e) { return std::pow(10.0, e / 2); });
  const Dense well = X * X.transpose() + 60 * Dense::Identity(60, 60);
  Dense A = units.asDiagonal() * well * units.asDiagonal(), x = units.asDiagonal() * B;
  SingleCholesky factor;
  TEST_ASSERT(factor.factor(A));  // entries from 1e-200 to 1e200
  factor.solve(x);
  const Dense wanted = choleskySolve(well, B), error = Dense(units.asDiagonal() * x) - wanted;
  TEST_ASSERT(isSmall(error, wanted, 1e-4));
  TEST_ASSERT(largest(error) > 1e-10 * largest(wanted));
  A = Dense::Ones(60, 60) + 3e-6 * Dense::Identity(60, 60);  // definite in single precision, too, but of no use
  TEST_ASSERT(!factor.factor(A));
  A = -well;
  TEST_ASSERT(!factor.factor(A));
}

// Holds count as fixed.
TEUCHOS_UNIT_TEST(CoarseProblem, SeriesSolvesForWhatIsLeft) {
  for (int touched : {10, Chain::kSubdomains}) {
    const Chain chain(touched);
    const Eigen::Index l = chain.fixed.cols(), c = 6 * touched;
    const Dense F = denseGram(chain.fixed, chain.q), changing = denseGram(chain.changing, chain.q);
    const Eigen::VectorXd stays = someColumns(l, 1);
    for (const auto& holds : {CoarseProblem::Holds{}, twoHolds(l)}) {
      Dense H = Dense::Zero(l, l);
      for (const auto& w : holds) H += Dense(w) * Dense(w).transpose();
      const Dense held = F + (F + changing).diagonal().maxCoeff() * H, A = held + changing, alone = F + F.diagonal().maxCoeff() * H;
      for (const Case& place : allCases(chain.comm->getSize())) {
        out << touched << " change, " << holds.size() << " holds, " << place.name << "\n";
        CoarseProblem problem(chain.place(place.options), {chain.fixed, chain.q}, {chain.changing, chain.q}, holds);
        problem.renew({chain.changing, chain.q});
        CoarseProblem::Series series(problem, partOf(stays, *chain.comm));
        Eigen::VectorXd total = Eigen::VectorXd::Zero(l);
        for (int k = 0; k < 3; ++k) {
          Eigen::VectorXd changes = Eigen::VectorXd::Zero(l);
          changes.head(c) = someColumns(c, 3).col(k);
          const Eigen::VectorXd wanted = choleskySolve(A, stays + changes - held * total);
          total += wanted;
          const Eigen::VectorXd found = series.next(partOf(changes, *chain.comm));
          TEST_ASSERT(isSmall((found - wanted).head(c), wanted));
        }
        const CoarseProblem fixedAlone(problem, holds);
        Eigen::VectorXd changes = Eigen::VectorXd::Zero(l);
        changes.head(c) = someColumns(c, 4).col(3);
        const Eigen::VectorXd wanted = choleskySolve(alone, stays + changes);
        TEST_ASSERT(isSmall(series.last(fixedAlone, partOf(changes, *chain.comm)) - wanted, wanted));
        TEST_EQUALITY(problem.solves(), 3L);
        TEST_EQUALITY(fixedAlone.solves(), 1L);
      }
    }
  }
}

TEUCHOS_UNIT_TEST(CoarseProblem, NotPositiveDefiniteRenewalIsToldOnAllRanks) {
  const Chain chain(10);
  const CoarseRows nothing(chain.fixed.rows(), chain.fixed.cols());
  CoarseRows headless = chain.fixed;  // the first subdomain is left to the changing rows
  headless.prune([](Eigen::Index, Eigen::Index column, double) { return column >= 6; });
  for (const Case& c : allCases(chain.comm->getSize())) {
    CoarseProblem others(chain.place(c.options), {nothing, chain.q}, {chain.changing, chain.q}, {});
    TEST_THROW(others.renew({chain.changing, chain.q}), std::runtime_error);
    CoarseProblem changing(chain.place(c.options), {headless, chain.q}, {chain.changing, chain.q}, {});
    TEST_THROW(changing.renew({nothing, chain.q}), std::runtime_error);
  }
}
