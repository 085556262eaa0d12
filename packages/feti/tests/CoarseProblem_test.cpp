// SPDX-License-Identifier: BSD-3-Clause
// Coarse matrices with a factor on every rank and with one a group of ranks: the same answers.
#include "Haptos_CoarseProblem.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

#include "FetiScene.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

struct Case {
  const char* name;
  CoarseOptions options;
  int holders;  // expected
};

std::vector<Case> allCases(int ranks) {
  return {{"every rank", {1 << 20, 0}, ranks},
          {"every rank, as groups of one", {0, 1}, ranks},
          {"groups of two", {0, 2}, (ranks + 1) / 2},
          {"groups of three", {0, 3}, (ranks + 2) / 3},
          {"one a node", {0, 0}, 1}};  // all ranks of a test share one memory
}

struct Model {
  Scene scene = makeScene(heldScene(7));
  Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
  std::vector<double> q;

  Model() {
    for (std::size_t i = 0; i < localNumElements(*feti.map()); ++i)
      q.push_back(1.5 + std::sin(double(feti.map()->getGlobalElement(LocalOrdinal(i)))));
  }
  CoarseProblem::Placement place(const CoarseOptions& options) const {
    return std::make_shared<CoarsePlacement>(feti.comm, feti.G->dimension(), options);
  }
};

// C^T diag(q) C b, summed over the ranks
Dense gathered(const CoarseRows& C, const Dense& b, const std::vector<double>& q) {
  const Dense mine = C.transpose() * (Eigen::Map<const Eigen::VectorXd>(q.data(), Eigen::Index(q.size())).asDiagonal() * Dense(C * b));
  Dense sum(mine.rows(), mine.cols());
  Teuchos::reduceAll(*Tpetra::getDefaultComm(), Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), sum.data());
  return sum;
}

// b as a sum of different parts of the ranks.
Dense partOf(const Dense& b, const Communicator& comm) {
  const double ranks = comm.getSize(), mine = comm.getRank() + 1;
  return b * (2 * mine / (ranks * (ranks + 1)));
}

}  // namespace

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
    TEST_EQUALITY(placement->costs().factorEntries > 0, placement->holds());
    const double roundOff = 1e-12 * largest(wanted);
    TEST_ASSERT(largest(A.solve(b) - wanted) <= roundOff);
    TEST_ASSERT(largest(A.solveSum(partOf(b, comm)) - wanted) <= roundOff);
    TEST_ASSERT(largest(A.solveSum(partOf(b, comm), shift) - shifted) <= roundOff);
    TEST_EQUALITY(A.solves(), 9L);
    TEST_EQUALITY(placement->costs().setUps, 1L);
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
    Dense fixed = gathered(even, b, m.q), product = A.multiplyFixed(b);
    TEST_EQUALITY(product.size() > 0, placement->holds());
    if (product.size() > 0) TEST_ASSERT(largest(product - fixed) <= 1e-12 * largest(fixed));
  }
}

TEUCHOS_UNIT_TEST(CoarseProblem, NotPositiveDefiniteIsToldOnAllRanks) {
  const Model m;
  const CoarseRows nothing(m.feti.G->rows().rows(), m.feti.G->rows().cols());
  for (const Case& c : allCases(m.feti.comm->getSize()))
    TEST_THROW(CoarseProblem(m.place(c.options), nothing, m.q, {}), std::runtime_error);
}
