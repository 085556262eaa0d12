// SPDX-License-Identifier: BSD-3-Clause
// Coarse matrices with a factor on every rank and with one a group of ranks: the same answers.
#include "Haptos_CoarseProblem.hpp"

#include <Teuchos_UnitTestHarness.hpp>

#include "CoarseScene.hpp"
#include "Haptos_CoarseSchur.hpp"

using namespace Haptos;
using namespace Haptos::Testing;

// Boxes of subdomains, each coupled to all that touch it; rows between those of the lowest layer change.
struct Lattice {
  static constexpr int kLong = 10, kWide = 4, kHigh = 4, kSubdomains = kLong * kWide * kHigh;
  CoarseRows fixed{0, 6 * kSubdomains}, changing{fixed};

  Lattice() {
    const RCP<const Communicator> comm = Tpetra::getDefaultComm();
    std::vector<Eigen::Triplet<double>> stays, changes;
    int row = 0;
    for (int s = 0; s < kSubdomains; ++s)
      for (int t = 0; t <= s; ++t) {
        if (std::abs(s / 16 - t / 16) > 1 || std::abs(s / 4 % 4 - t / 4 % 4) > 1 || std::abs(s % 4 - t % 4) > 1) continue;
        for (int k = 0; k < 6; ++k, ++row) {
          if (row % comm->getSize() != comm->getRank()) continue;
          for (int j = 0; j < 6; ++j) {
            const double value = std::sin(1.7 * (row + 1) * (j + 1)) + (s == t && j == k ? 6 : 0);
            auto& list = s % 4 == 0 && t % 4 == 0 && s != t ? changes : stays;
            list.emplace_back(row, 6 * s + j, value);
            if (s != t) list.emplace_back(row, 6 * t + j, 0.9 * value - 0.2);
          }
        }
      }
    fixed.resize(row, 6 * kSubdomains);
    changing.resize(row, 6 * kSubdomains);
    fixed.setFromTriplets(stays.begin(), stays.end());
    changing.setFromTriplets(changes.begin(), changes.end());
  }
};

// Whole subdomains, parts of one, and six columns across two.
TEUCHOS_UNIT_TEST(CoarseRows, ProductsAreThoseOfDenseMatrices) {
  Dense D = someColumns(5, 18);
  D.row(0).tail(12).setZero();
  D.row(1).head(3).setZero();
  D.row(1).tail(9).setZero();
  D(2, 7) = D(2, 9) = 0;
  D.row(3).setZero();
  const CoarseRows C = D.sparseView();
  const Eigen::VectorXd x = someColumns(5, 1), a = someColumns(18, 1);
  TEST_ASSERT(isSmall(multiplyTransposed(C, x) - D.transpose() * x, D.transpose() * x, 1e-14));
  TEST_ASSERT(isSmall(multiply(C, a) - D * a, D * a, 1e-14));
}

TEUCHOS_UNIT_TEST(CoarseProblem, SameAnswerWhereverTheFactorLives) {
  const Model m;
  const Communicator& comm = *m.feti.comm;
  const Dense b = someColumns(m.feti.G->dimension(), 3), shift = someColumns(b.rows(), 3).reverse();
  const CoarseProblem reference(comm, m.feti.G->rows(), m.q, {});
  const Dense wanted = reference.solve(b), shifted = reference.solve(b - shift);
  TEST_ASSERT(wanted.norm() > 0);
  for (const Case& c : allCases(comm.getSize())) {
    out << c.name << "\n";
    const auto placement = m.place(c.options);
    const CoarseProblem A(placement, m.feti.G->rows(), m.q, {});
    TEST_EQUALITY(placement->numHolders(), c.holders);
    TEST_EQUALITY(placement->isShared(), ranksShare(c, comm));
    if (!placement->isShared()) TEST_EQUALITY(placement->costs().factorEntries > 0, placement->holds());
    const double roundOff = 1e-12 * largest(wanted);
    TEST_ASSERT(largest(A.solve(b) - wanted) <= roundOff);
    TEST_ASSERT(largest(A.solveSum(partOf(b, comm)) - wanted) <= roundOff);
    TEST_ASSERT(largest(A.solveSum(partOf(b, comm), shift) - shifted) <= roundOff);
    TEST_EQUALITY(A.solves(), 9L);
    TEST_EQUALITY(placement->costs().setUps, 1L);
  }
}

// The rank with one matrix of a group is not the one with the next, which costs memory as well.
TEUCHOS_UNIT_TEST(CoarseProblem, NextMatrixLiesOnAnotherRank) {
  const Model m;
  const Communicator& comm = *m.feti.comm;
  const Dense b = someColumns(m.feti.G->dimension(), 2), wanted = CoarseProblem(comm, m.feti.G->rows(), m.q, {}).solve(b);
  const CoarseRows nothing(m.feti.G->rows().rows(), m.feti.G->rows().cols());
  for (const Case& c : allCases(comm.getSize())) {
    out << c.name << "\n";
    const auto first = m.place(c.options), second = first->onNextRanks();
    TEST_EQUALITY(second->numHolders(), c.holders);
    TEST_EQUALITY(second->isReplicated(), first->isReplicated());
    int inOneGroup = comm.getSize();  // ranks that hold both, and must be alone in their groups
    const int both = first->holds() && second->holds();
    Teuchos::reduceAll(comm, Teuchos::REDUCE_SUM, both, Teuchos::outArg(inOneGroup));
    if (!first->isReplicated() && !first->isShared())
      TEST_EQUALITY(inOneGroup, int(comm.getSize() == 1 || (c.options.ranksPerFactor > 1 && comm.getSize() % c.options.ranksPerFactor == 1)));
    const CoarseProblem A(second, m.feti.G->rows(), m.q, {});
    TEST_ASSERT(largest(A.solveSum(partOf(b, comm)) - wanted) <= 1e-12 * largest(wanted));
    TEST_EQUALITY(first->costs().setUps, 1L);
    if (!first->isShared()) TEST_EQUALITY(first->costs().factorEntries > 0, second->holds());
    TEST_THROW(CoarseProblem(second, nothing, m.q, {}), std::runtime_error);
  }
}

// The same digits on all ranks: they take branches by them.
TEUCHOS_UNIT_TEST(CoarseProblem, SameDigitsOnAllRanks) {
  const Model m;
  const Communicator& comm = *m.feti.comm;
  const Dense b = someColumns(m.feti.G->dimension(), 1);
  for (const Case& c : allCases(comm.getSize())) {
    const Dense x = CoarseProblem(m.place(c.options), m.feti.G->rows(), m.q, {}).solveSum(partOf(b, comm));
    Dense ofRoot = x;
    Teuchos::broadcast(comm, 0, int(ofRoot.size()), ofRoot.data());
    TEST_ASSERT(x == ofRoot);
  }
}

TEUCHOS_UNIT_TEST(CoarseProblem, RenewedPartIsThatOfAFreshMatrix) {
  const Model m;
  CoarseRows even = m.feti.G->rows(), odd = even;
  for (Eigen::Index row = 0; row < even.rows(); ++row)
    for (CoarseRows::InnerIterator it(row % 2 ? even : odd, row); it; ++it) it.valueRef() = 0;
  const Dense b = someColumns(even.cols(), 2);
  for (const Case& c : allCases(m.feti.comm->getSize())) {
    const auto placement = m.place(c.options);
    CoarseProblem A(placement, {even, m.q}, {odd, m.q}, {});
    const Dense wanted = CoarseProblem(*m.feti.comm, m.feti.G->rows(), m.q, {}).solve(b);
    A.renew({odd, m.q});
    TEST_ASSERT(largest(A.solve(b) - wanted) <= 1e-12 * largest(wanted));
    for (double factor : {3.0, 0.25}) {
      const CoarseRows other = factor * odd, all = even + other;
      const Dense fresh = CoarseProblem(*m.feti.comm, all, m.q, {}).solve(b);
      A.renew({other, m.q});
      TEST_ASSERT(largest(A.solve(b) - fresh) <= 1e-12 * largest(fresh));
      TEST_ASSERT(largest(fresh - wanted) > 1e-3 * largest(wanted));
    }
    TEST_EQUALITY(placement->costs().setUps, 3L);
  }
}

// So many that dissection orders them.
TEUCHOS_UNIT_TEST(CoarseProblem, ThousandsOfSubdomainsAreEliminated) {
  const Chain chain(5, 1500);
  const Dense b = someColumns(chain.fixed.cols(), 2);
  for (const Case& c : allCases(chain.comm->getSize())) {
    const auto placement = chain.place(c.options);
    CoarseProblem A(placement, {chain.fixed, chain.q}, {chain.changing, chain.q}, {}, CoarseProblem::Factor::Now);
    const Dense x = A.solve(b);
    const Dense rest = gathered(chain.fixed, x, chain.q) + gathered(chain.changing, x, chain.q) - b;
    TEST_ASSERT(isSmall(rest, b, 1e-9));
    // a chain hardly fills in
    if (placement->holds()) TEST_COMPARE(placement->costs().factorEntries, <, std::size_t(6 * 18 * 2 * 1500));
  }
}

// The factor that ranks share: right for a matrix whose parts meet in planes, edges and corners; no rank has most of it.
TEUCHOS_UNIT_TEST(CoarseProblem, SharedFactorIsRightAndSpread) {
  const Lattice lattice;
  const auto comm = Tpetra::getDefaultComm();
  const Eigen::Index l = lattice.fixed.cols();
  const std::vector<double> ones(std::size_t(lattice.fixed.rows()), 1.0);
  const Dense b = someColumns(l, 2), F = denseGram(lattice.fixed, ones), E = denseGram(lattice.changing, ones);
  const auto placement = std::make_shared<CoarsePlacement>(comm, l, CoarseOptions{0, 0});
  CoarseProblem A(placement, {lattice.fixed, ones}, {lattice.changing, ones}, {}, CoarseProblem::Factor::Now);
  const Dense wanted = choleskySolve(F + E, b);
  TEST_ASSERT(isSmall(A.solve(b) - wanted, wanted));
  A.renew({3.0 * lattice.changing, ones});
  const Dense renewed = choleskySolve(F + 9 * E, b);
  TEST_ASSERT(isSmall(A.solve(b) - renewed, renewed));
  const Dense alone = choleskySolve(F, b);
  TEST_ASSERT(isSmall(CoarseProblem(A, {}).solve(b) - alone, alone));
  if (!placement->isShared()) return;
  const CoarseCosts& costs = placement->costs();
  const double mine[3] = {costs.flops, double(costs.factorEntries), costs.entriesRead};
  double most[3], all[3];
  Teuchos::reduceAll(*comm, Teuchos::REDUCE_MAX, 3, mine, most);
  Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, 3, mine, all);
  for (int i = 0; i < 3; ++i) TEST_COMPARE(most[i], <=, 1.35 * all[i] / comm->getSize());
}

// Condensed where few subdomains change, whole where all do.
TEUCHOS_UNIT_TEST(CoarseProblem, RenewalsSolveLikeDenseMatrices) {
  TEST_EQUALITY(CoarseSchur::pays(6 * Chain::kSubdomains, 60), hasCholmod());
  TEST_ASSERT(!CoarseSchur::pays(6 * Chain::kSubdomains, 6 * Chain::kSubdomains));
  for (const auto& [unknowns, last] : {std::pair{4500, 1500}, {12288, 1536}, {65856, 4704}})  // of beams in contact
    TEST_EQUALITY(CoarseSchur::pays(unknowns, last), hasCholmod());
  for (const auto& [unknowns, last] : {std::pair{4400, 1500}, {65856, 9000}})  // a third of all; more than a sparse factor
    TEST_ASSERT(!CoarseSchur::pays(unknowns, last));
  for (int touched : {1, 10, Chain::kSubdomains}) {
    const Chain chain(touched);
    const Eigen::Index l = chain.fixed.cols();
    const Dense b = someColumns(l, 2), F = denseGram(chain.fixed, chain.q), first = denseGram(chain.changing, chain.q);
    for (const auto& holds : {CoarseProblem::Holds{}, twoHolds(l)}) {
      Dense H = Dense::Zero(l, l);
      for (const auto& w : holds) H += Dense(w) * Dense(w).transpose() * (F + first).diagonal().maxCoeff();
      for (const Case& c : allCases(chain.comm->getSize())) {
        out << touched << " change, " << holds.size() << " holds, " << c.name << "\n";
        CoarseProblem A(chain.place(c.options), {chain.fixed, chain.q}, {chain.changing, chain.q}, holds);
        for (double factor : {1.0, 20.0, 0.0, 0.1}) {
          const CoarseRows changing = factor == 0 ? CoarseRows(chain.fixed.rows(), l) : CoarseRows(factor * chain.changing);
          A.renew({changing, chain.q});
          const Dense wanted = choleskySolve(F + H + factor * factor * first, b);
          TEST_ASSERT(isSmall(A.solve(b) - wanted, wanted));
          TEST_ASSERT(isSmall(A.solveSum(partOf(b, *chain.comm)) - wanted, wanted));
        }
      }
    }
  }
}

// Of the whole matrix, made at once, and of its fixed rows alone, with what the whole one eliminated or not.
TEUCHOS_UNIT_TEST(CoarseProblem, FixedPartAlone) {
  for (int touched : {10, Chain::kSubdomains}) {
    const Chain chain(touched);
    const Eigen::Index l = chain.fixed.cols();
    const Dense b = someColumns(l, 2), F = denseGram(chain.fixed, chain.q), A = F + denseGram(chain.changing, chain.q);
    for (const auto& held : {CoarseProblem::Holds{}, twoHolds(l)})
      for (const auto& heldAlone : {CoarseProblem::Holds{}, twoHolds(l)})
        for (const Case& c : allCases(chain.comm->getSize())) {
          out << touched << " change, " << held.size() << " and " << heldAlone.size() << " holds, " << c.name << "\n";
          Dense H = Dense::Zero(l, l);
          for (const auto& w : twoHolds(l)) H += Dense(w) * Dense(w).transpose();
          const Dense whole = A + (held.empty() ? 0 : A.diagonal().maxCoeff()) * H;
          const Dense alone = F + (heldAlone.empty() ? 0 : F.diagonal().maxCoeff()) * H;
          auto problem = std::make_unique<CoarseProblem>(chain.place(c.options), CoarseProblem::Weighted{chain.fixed, chain.q},
                                                         CoarseProblem::Weighted{chain.changing, chain.q}, held,
                                                         CoarseProblem::Factor::Now);
          const CoarseProblem fixed(*problem, heldAlone);
          const Dense x = choleskySolve(whole, b), xAlone = choleskySolve(alone, b);
          TEST_ASSERT(isSmall(problem->solve(b) - x, x));
          TEST_ASSERT(isSmall(fixed.solve(b) - xAlone, xAlone));
          problem.reset();
          TEST_ASSERT(isSmall(fixed.solveSum(partOf(b, *chain.comm)) - xAlone, xAlone));
        }
  }
}

TEUCHOS_UNIT_TEST(CoarseProblem, NotPositiveDefiniteIsToldOnAllRanks) {
  const Model m;
  const CoarseRows nothing(m.feti.G->rows().rows(), m.feti.G->rows().cols());
  for (const Case& c : allCases(m.feti.comm->getSize()))
    TEST_THROW(CoarseProblem(m.place(c.options), nothing, m.q, {}), std::runtime_error);
}
