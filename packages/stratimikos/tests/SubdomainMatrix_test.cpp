// SPDX-License-Identifier: BSD-3-Clause
// A chain of subdomains, one on each rank: the operator against the matrix that they add up to, and what is refused.
#include "Haptos_SubdomainMatrix.hpp"

#include <Eigen/Core>
#include <Teuchos_DefaultSerialComm.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_MultiVector.hpp>
#include <functional>

#include "Haptos_Error.hpp"

namespace {

using namespace Haptos;

constexpr int kUnknowns = 6;  // of the two nodes of a link

double entryOfLink(int i, int j) { return i == j ? 4.0 : i + j == kUnknowns ? -1.5 : std::abs(i - j) == 1 ? -1.0 : 0.0; }

/// \param outside one more entry, in a column that is no row
RCP<CrsMatrix> makeMatrix(int rows, bool outside = false) {
  const auto self = Teuchos::rcp(new Teuchos::SerialComm<int>());
  const auto map = Teuchos::rcp(new Map(Tpetra::global_size_t(rows), 0, self));
  const auto domain = Teuchos::rcp(new Map(Tpetra::global_size_t(rows + 1), 0, self));
  const auto K = Teuchos::rcp(new CrsMatrix(map, std::size_t(rows + 1)));
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j)
      if (entryOfLink(i, j) != 0) K->insertGlobalValues(i, Teuchos::tuple<GlobalOrdinal>(j), Teuchos::tuple(entryOfLink(i, j)));
  if (outside) K->insertGlobalValues(0, Teuchos::tuple<GlobalOrdinal>(rows), Teuchos::tuple(1.0));
  if (outside) K->fillComplete(domain, map);
  else K->fillComplete();
  return K;
}

/// Link r of the chain joins nodes r and r + 1; what is wrong with one of them is the caller's.
struct Link {
  std::vector<GlobalOrdinal> nodes;
  std::vector<double> coordinates;
  RCP<CrsMatrix> K = makeMatrix(kUnknowns);
  std::vector<GlobalOrdinal> held;
  RCP<const Map> map;

  explicit Link(int rank) : nodes{rank, rank + 1}, coordinates{0, 0, 1.0 * rank, 0, 0, rank + 1.0} {}

  SubdomainMatrix operatorOf(const RCP<const Communicator>& comm) const {
    return {comm, {{0, Teuchos::arrayViewFromVector(nodes), Teuchos::arrayViewFromVector(coordinates), K}}, held, map};
  }
};

/// What all ranks are told where the last one alone does wrong.
std::string refusal(const std::function<void(Link&)>& spoil) {
  const auto comm = Tpetra::getDefaultComm();
  Link link(comm->getRank());
  if (comm->getRank() == comm->getSize() - 1) spoil(link);
  try {
    link.operatorOf(comm);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEUCHOS_UNIT_TEST(SubdomainMatrix, AppliesTheSumOfItsSubdomains) {
  const auto comm = Tpetra::getDefaultComm();
  const int ranks = comm->getSize(), n = 3 * (ranks + 1);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  for (int r = 0; r < ranks; ++r)
    for (int i = 0; i < kUnknowns; ++i)
      for (int j = 0; j < kUnknowns; ++j) A(3 * r + i, 3 * r + j) += entryOfLink(i, j);
  const int held = 4;  // component 1 of node 1, which two ranks have where there are two
  A.row(held).setZero();
  A.col(held).setZero();
  A(held, held) = 1;

  Link link(comm->getRank());
  link.held = {held, held};
  const SubdomainMatrix matrix = link.operatorOf(comm);
  MultiVector x(matrix.getDomainMap(), 2), y(matrix.getRangeMap(), 2);
  const auto entryOf = [](GlobalOrdinal row, int column) { return 1.0 + 0.5 * double(row) * (column + 1) - 0.1 * double(row * row); };
  for (std::size_t row = 0; row < x.getLocalLength(); ++row)
    for (int v = 0; v < 2; ++v) x.replaceLocalValue(LocalOrdinal(row), std::size_t(v), entryOf(x.getMap()->getGlobalElement(LocalOrdinal(row)), v));
  y.putScalar(2.0);
  matrix.apply(x, y, Teuchos::NO_TRANS, 3.0, -1.0);
  for (int v = 0; v < 2; ++v) {
    Eigen::VectorXd all(n);
    for (int row = 0; row < n; ++row) all[row] = entryOf(row, v);
    const Eigen::VectorXd expected = 3 * A * all - Eigen::VectorXd::Constant(n, 2.0);
    const auto values = y.getData(std::size_t(v));
    for (int row = 0; row < int(values.size()); ++row) TEST_FLOATING_EQUALITY(values[row], expected[y.getMap()->getGlobalElement(row)], 1e-13);
  }
  int mine = int(matrix.held().size()), all = 0;
  Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, mine, Teuchos::outArg(all));
  TEST_EQUALITY(all, 1);
}

TEUCHOS_UNIT_TEST(SubdomainMatrix, RefusesOnAllRanksWhatOneGetsWrong) {
  TEST_EQUALITY(refusal([](Link&) {}), std::string());
  TEST_ASSERT(contains(refusal([](Link& link) { link.K = {}; }), "The stiffness of a subdomain of body 0 is missing"));
  TEST_ASSERT(contains(refusal([](Link& link) { link.K = makeMatrix(5); }), "has 5 rows; its 2 nodes have 6 unknowns"));
  TEST_ASSERT(contains(refusal([](Link& link) { link.K = makeMatrix(kUnknowns, true); }), "has an entry in column 6, which is none of its rows"));
  TEST_ASSERT(contains(refusal([](Link& link) { link.coordinates.pop_back(); }), "have 5 coordinates; its 2 nodes have three each"));
  TEST_ASSERT(contains(refusal([](Link& link) { link.held = {3 * 99 + 2}; }), "Component 2 of node 99 is held and in no subdomain"));
}

TEUCHOS_UNIT_TEST(SubdomainMatrix, RefusesAMapThatLacksAnUnknown) {
  const auto comm = Tpetra::getDefaultComm();
  Link link(comm->getRank());
  link.map = Teuchos::rcp(new Map(Tpetra::global_size_t(3 * comm->getSize()), 0, comm));  // none of the last node
  std::string message;
  try {
    link.operatorOf(comm);
  } catch (const InputError& e) {
    message = e.what();
  }
  TEST_ASSERT(contains(message, "Component 0 of node " + std::to_string(comm->getSize()) + " is not in the map"));
}
