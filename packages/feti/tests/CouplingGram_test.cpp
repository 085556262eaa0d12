// SPDX-License-Identifier: BSD-3-Clause
// Pairs of lists of nodes on several ranks, against dense matrices that know neither lists nor ranks.
#include "Haptos_CouplingGram.hpp"

#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "DensePreconditioner.hpp"
#include "Haptos_ContactBlock.hpp"
#include "Haptos_DeflatedContactBlock.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DependentUnknowns.hpp"
#include "Haptos_PanelJumps.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_RowGram.hpp"
#include "Haptos_SparseLdl.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

constexpr double kRoundOff = 1e-12;

// One secondary node opposite seven nodes of a finer mesh.
Scene sevenScene() {
  SceneOptions options = heldScene(9);
  options.lower = {6, 4, 1};
  options.upper = {1, 1, 1};
  options.contact = false;
  Scene scene = makeScene(options);
  ContactInterface interface;
  interface.name = "seven";
  ContactPair pair{-1, {}, {}, makeFrame({0.1, 0.2, -1.0}, {1, 0, 0}), 0.01, 0.5};
  std::vector<std::int64_t> opposite;
  for (std::size_t i = 0; i < scene.mesh.numNodes(); ++i) {
    const Point& x = scene.mesh.coordinates[i];
    const bool isUpper = i >= scene.mesh.numNodes() - 8;
    if (std::abs(x[2]) > 1e-9 || x[0] < 1e-9) continue;
    if (isUpper && pair.secondaryNode < 0) pair.secondary = {{pair.secondaryNode = std::int64_t(i), 1.0}};
    if (!isUpper) opposite.push_back(std::int64_t(i));
  }
  for (std::size_t k = 0; k < 7; ++k) pair.primary.push_back({opposite[k * (opposite.size() - 1) / 6], 1.0 / 7});
  interface.pairs = {pair};
  scene.interfaces = {interface};
  buildRows(scene);
  return scene;
}

// Lists on both sides that have nodes in common, none of them prescribed in any component.
Scene chainScene() {
  SceneOptions options;
  options.lower = options.upper = {5, 4, 2};
  options.subdomains = 7;
  options.frictional = true;
  options.hold = [](int body, const Point& x) { return std::string(std::abs(x[2]) > 1 - 1e-9 && (x[2] < 0) == (body == 0) ? "xyz" : ""); };
  Scene scene = makeScene(options);
  auto& pairs = scene.interfaces.front().pairs;
  const auto matching = pairs;
  const auto next = [&](std::size_t i) { return matching[(i + 1) % matching.size()]; };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    pairs[i].frame = makeFrame({0.1 * double(i), 0.2, -1.0}, {1, 0.1 * double(i), 0});
    pairs[i].secondary = {{matching[i].secondary.front().node, 0.75}, {next(i).secondary.front().node, 0.25}};
    pairs[i].primary = {{matching[i].primary.front().node, 0.5}, {next(i).primary.front().node, 0.5}};
  }
  buildRows(scene);
  return scene;
}

// A panel of this rank's boundary unknowns as vectors, and back
RCP<MultiVector> vectorsOf(const DualPreconditioner& M, const PanelJumps& jumps, const RowPanel& t) {
  auto x = Teuchos::rcp(new MultiVector(M.jump().getDomainMap(), RowPanel::kColumns));
  for (std::size_t i = 0; i + 1 < M.jump().primalOffsets().size(); ++i) {
    const auto& boundary = M.surface().boundary(M.systems()[int(i)].congruenceClass);
    for (std::size_t v = 0; v < std::size_t(RowPanel::kColumns); ++v) {
      const auto data = x->getDataNonConst(v);
      for (std::size_t k = 0; k < boundary.size(); ++k) data[M.jump().primalOffsets()[i] + std::size_t(boundary[k])] = t[jumps.first(i) + k][v];
    }
  }
  return x;
}

double largestDifference(const MultiVector& x, const MultiVector& y) {
  MultiVector difference(x, Teuchos::Copy);
  difference.update(-1.0, y, 1.0);
  Teuchos::Array<double> norms(x.getNumVectors());
  difference.normInf(norms());
  return *std::max_element(norms.begin(), norms.end());
}

// Of panels that are filled in one subdomain a column, or in one row, all ranks together: what M does to whole vectors.
void comparePanels(const DualPreconditioner& M, Teuchos::FancyOStream& out, bool& success) {
  PanelJumps jumps(M);
  RowPanel t(jumps.size());
  const auto fill = [&] {
    t.clear();
    for (std::size_t i = 0; i + 1 < M.jump().primalOffsets().size(); ++i)
      for (std::size_t k = jumps.first(i); k < jumps.first(i + 1); ++k)
        t.fill(k)[(M.jump().firstSubdomain() + int(i)) % RowPanel::kColumns] = std::sin(1.0 + 2.3 * double(k));
  };
  for (int round = 0; round < 2; ++round) {  // nothing stays from the first
    fill();
    const auto averaged = vectorsOf(M, jumps, t);
    M.average(*averaged);
    jumps.average(t);
    TEST_COMPARE(largestDifference(*vectorsOf(M, jumps, t), *averaged), <=, 1e-12);
  }
  fill();
  MultiVector whole(M.getRangeMap(), RowPanel::kColumns);
  M.collect(*vectorsOf(M, jumps, t), whole);
  std::vector<int> rows(localNumElements(*M.getRangeMap()));
  std::iota(rows.begin(), rows.end(), 0);
  Dense y(Eigen::Index(rows.size()), RowPanel::kColumns);
  jumps.collect(t, rows, y);
  for (Eigen::Index v = 0; v < y.cols(); ++v)
    for (Eigen::Index i = 0; i < y.rows(); ++i) TEST_COMPARE(std::abs(y(i, v) - whole.getData(std::size_t(v))[i]), <=, 1e-12);
  MultiVector unit(M.getRangeMap(), RowPanel::kColumns), spread(M.jump().getDomainMap(), RowPanel::kColumns);
  std::vector<std::array<int, 2>> units;  // all over the rows: gluing, Dirichlet and those of pairs
  const auto number = int(localNumElements(*M.getRangeMap()));
  for (int v = 0; v < RowPanel::kColumns && number > 0; ++v) {
    units.push_back({int(std::int64_t(v) * (number - 1) / (RowPanel::kColumns - 1)), v});
    unit.getDataNonConst(std::size_t(v))[units.back()[0]] = 1;
  }
  M.spread(unit, spread);
  t.clear();
  jumps.spread(units, t);
  TEST_COMPARE(largestDifference(*vectorsOf(M, jumps, t), spread), <=, 1e-12);
}

// S from its entries is what is solved with: S S^-1 S x = S x, some rows depending on others.
void compareEntries(const Feti& feti, Teuchos::FancyOStream& out, bool& success) {
  const CouplingGram gram(feti.dealt.jump->multipliers(), true);
  const auto& map = *feti.map();
  const auto rows = Eigen::Index(gram.rows().size());
  Eigen::VectorXd numbers(rows);
  for (Eigen::Index i = 0; i < rows; ++i) numbers[i] = double(map.getGlobalElement(gram.rows()[std::size_t(i)]));
  Dense S = Dense::Zero(Eigen::Index(map.getGlobalNumElements()), Eigen::Index(map.getGlobalNumElements()));
  for (const auto& entry : gram.entries(numbers)) S(entry.row, entry.column) += entry.value;
  S = sumOfAll(*map.getComm(), S);
  TEST_ASSERT(largest(S - S.transpose()) < kRoundOff * largest(S));
  const Dense SX = S * someColumns(S.rows(), 2);
  Dense mine(rows, 2), Y = Dense::Zero(S.rows(), 2);
  for (Eigen::Index i = 0; i < rows; ++i) mine.row(i) = SX.row(Eigen::Index(numbers[i]));
  mine = gram.solve(mine);
  for (Eigen::Index i = 0; i < rows; ++i) Y.row(Eigen::Index(numbers[i])) = mine.row(i);
  TEST_ASSERT(largest(S * sumOfAll(*map.getComm(), Y) - SX) < kRoundOff * largest(SX));
  TEST_ASSERT(gram.entries(Eigen::VectorXd::Constant(rows, -1)).empty());
}

// All contact rows as one group are M between them, where no tied rows couple them; a row that is not there has nothing.
void compareGroups(const Scene& scene, const RCP<const DualPreconditioner>& M, const Dense& between, Teuchos::FancyOStream& out, bool& success) {
  for (const RowKind kind : scene.rows.kinds)
    if (kind == RowKind::Tied) return;
  const std::vector<int>& contact = M->jump().multipliers().contactRows();
  std::vector<int> positions(contact.size() + 1, -1);
  std::iota(positions.begin() + 1, positions.end(), 0);
  const auto groups = DeflatedContactBlock(M, Dense(Eigen::Index(contact.size()), 0)).ofGroups({positions});
  std::vector<int> global{-1};
  for (int row : contact) global.push_back(int(M->getDomainMap()->getGlobalElement(row)));
  global = gatheredOnAll(*M->getDomainMap()->getComm(), global);
  TEST_EQUALITY(groups[0].rows(), Eigen::Index(global.size()));
  for (std::size_t i = 0; i < global.size(); ++i)
    for (std::size_t j = 0; j < global.size(); ++j) {
      const double wanted = global[i] < 0 || global[j] < 0 ? 0.0 : between(global[i], global[j]);
      TEST_ASSERT(std::abs(groups[0](Eigen::Index(i), Eigen::Index(j)) - wanted) < kRoundOff * largest(between));
    }
}

// M between contact rows as a matrix, tied rows or not.
void compareMatrix(const DualPreconditioner& M, const Dense& matrix, const Dense& between, Teuchos::FancyOStream& out, bool& success) {
  std::vector<int> global;
  for (int row : M.jump().multipliers().contactRows()) global.push_back(int(M.getDomainMap()->getGlobalElement(row)));
  global = gatheredOnAll(*M.getDomainMap()->getComm(), global);
  TEST_EQUALITY(matrix.rows(), Eigen::Index(global.size()));
  TEST_ASSERT(largest(matrix - between(global, global)) < kRoundOff * largest(between));
}

// What holds for B W B^T, M, its contact rows and its contact block.
void compareWithDense(const Scene& scene, Teuchos::FancyOStream& out, bool& success) {
  const Feti feti = makeFeti(Tpetra::getDefaultComm(), scene);
  const Dense B = denseB(scene), F = denseF(scene);
  TEST_ASSERT(largest(denseOf(*feti.F) - F) < kRoundOff * largest(F));
  for (bool scaled : {true, false}) {
    const Dense gram = scaled ? Dense(B * denseW(scene).asDiagonal() * B.transpose()) : Dense(B * B.transpose());
    const Dense reference = densePseudoInverse(gram), x = someColumns(B.rows(), 2);
    const RowGram rowGram(feti.dealt.jump->multipliers(), scaled);
    const auto y = scatteredColumns(feti.map(), x);
    rowGram.apply(*y, *y);
    TEST_ASSERT(largest(gathered(*y) - reference * x) < kRoundOff * largest(reference));
  }
  const Dense reference = denseM(scene, PreconditionerKind::Dirichlet);
  const auto M = Teuchos::rcp(new DualPreconditioner(
      feti.dealt.jump, feti.systems,
      SurfaceOperators(*feti.systems, {*feti.systems, *feti.dealt.jump}, PreconditionerKind::Dirichlet, LocalSolverMethod::Automatic,
                       std::vector<char>(feti.dealt.mine.size(), 1))));
  const auto block = Teuchos::rcp(new ContactBlock(M));
  TEST_ASSERT(largest(denseOf(*M) - reference) < kRoundOff * largest(reference));
  Dense between = reference, rows = reference;
  for (Eigen::Index i = 0; i < reference.rows(); ++i)
    if (isEquality(scene.rows.kinds[std::size_t(i)])) {
      rows.row(i).setZero();
      between.row(i).setZero();
      between.col(i).setZero();
    }
  TEST_ASSERT(largest(between) > 1e-3 * largest(reference));
  TEST_ASSERT(largest(denseOf(*block) - between) < kRoundOff * largest(reference));
  TEST_ASSERT(largest(denseOf(ContactRows(M, block)) - rows) < kRoundOff * largest(reference));
  comparePanels(*M, out, success);
  compareEntries(feti, out, success);
  compareGroups(scene, M, between, out, success);
  compareMatrix(*M, block->matrix(), between, out, success);
  const Eigen::VectorXd diagonal = gathered(*M->diagonal());
  for (Eigen::Index i = 0; i < diagonal.size(); ++i)
    if (!scene.rows.pinned[std::size_t(i)]) TEST_ASSERT(diagonal[i] > 0.05 * reference(i, i) && diagonal[i] < 20 * reference(i, i));
  // r of the law is made of it: not by which rows one rank has
  const Feti alone = makeFeti(Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF)), scene);
  for (bool scaled : {true, false}) {
    const auto diagonalOf = [&](const Feti& feti) {
      const auto d = Teuchos::rcp(new Vector(feti.map()));
      const Eigen::VectorXd mine = RowGram(feti.dealt.jump->multipliers(), scaled).diagonal();
      std::copy(mine.data(), mine.data() + mine.size(), d->getDataNonConst(0).begin());
      return Eigen::VectorXd(gathered(*d));
    };
    const Eigen::VectorXd here = diagonalOf(feti), there = diagonalOf(alone);
    TEST_ASSERT((here - there).norm() < kRoundOff * there.norm());
  }
}

}  // namespace

TEUCHOS_UNIT_TEST(CouplingGram, SevenPrimaryNodes) {
  const Scene scene = sevenScene();
  const auto comm = Tpetra::getDefaultComm();
  const auto rankOf = deal(comm, scene).rankOf;
  std::set<int> ranks;
  TEST_EQUALITY(scene.interfaces[0].pairs[0].primary.size(), 7u);
  for (const auto& sub : scene.subdomains)
    for (const auto& [node, weight] : scene.interfaces[0].pairs[0].primary)
      if (std::binary_search(sub.nodes.begin(), sub.nodes.end(), node)) ranks.insert(rankOf[std::size_t(sub.id)]);
  TEST_EQUALITY(int(ranks.size()), comm->getSize());
  compareWithDense(scene, out, success);
}

// Lists on both sides, nodes in many pairs, tied pairs among them, some components prescribed.
TEUCHOS_UNIT_TEST(CouplingGram, ChainsOfListsAndTiedPairs) {
  for (bool frictional : {true, false}) {
    const Scene scene = makeListScene(frictional);
    const Dealt dealt = deal(Tpetra::getDefaultComm(), scene);
    int mine = 0, held = 0;  // rows that meet those of other ranks
    for (const auto& coupling : dealt.multipliers->couplings()) mine += coupling.holder >= 0;
    Teuchos::reduceAll(*Tpetra::getDefaultComm(), Teuchos::REDUCE_SUM, mine, Teuchos::outArg(held));
    TEST_EQUALITY(held > 0, Tpetra::getDefaultComm()->getSize() > 1);
    if (frictional) TEST_ASSERT(CouplingGram(*dealt.multipliers, true).hasFactors());  // too many rows for an inverse, on one rank too
    compareWithDense(scene, out, success);
  }
}

// One factor for all components, three and more right-hand sides of it at a time.
TEUCHOS_UNIT_TEST(CouplingGram, ComponentsShareAFactor) {
  const auto comm = Tpetra::getDefaultComm();
  const auto shares = [&](const Scene& scene) {
    const Dealt dealt = deal(comm, scene);
    const int mine = CouplingGram(*dealt.multipliers, true).sharesFactor();
    int any = 0;
    Teuchos::reduceAll(*comm, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(any));
    return any != 0;
  };
  TEST_ASSERT(shares(chainScene()));
  if (comm->getSize() == 1) TEST_ASSERT(!shares(makeListScene()));  // some components are prescribed
  compareWithDense(chainScene(), out, success);
}

TEUCHOS_UNIT_TEST(SparseLdl, SolvesAnyNumberOfColumns) {
  const int n = 30;
  Dense C = Dense::Zero(n, n + 3);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 3; ++j) C(i, (i + 5 * j * j) % (n + 3)) += j == 0 ? 4.0 : 1.0 + 0.1 * j;
  const Dense A = C * C.transpose();
  const SparseLdl factor(Eigen::SparseMatrix<double>(A.sparseView()));
  for (int columns : {1, 2, 3, 7}) {
    const Dense B = someColumns(n, columns);
    TEST_ASSERT(largest(A * factor.solve(B) - B) < 1e-10);
    for (int j = 0; j < columns; ++j) TEST_ASSERT(largest(factor.solve(B).col(j) - factor.solve(B.col(j))) < 1e-15);
  }
}

// Unknowns that others determine are left out; the rest is solved.
TEUCHOS_UNIT_TEST(SparseLdl, SolvesAndDropsWhatDepends) {
  const int n = 40;
  Dense C = Dense::Zero(n, n + 5);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < 4; ++j) C(i, (i + 7 * j * j) % (n + 5)) += j == 0 ? 4.0 : 1.0 + 0.1 * j;
  const Eigen::VectorXd b = someVector(n);
  const Dense A = C * C.transpose();
  const SparseLdl factor(Eigen::SparseMatrix<double>(A.sparseView()));
  TEST_EQUALITY(factor.numDropped(), 0);
  TEST_ASSERT(largest(A * factor.solve(b) - b) < 1e-10);
  C.row(7) = C.row(3) - 2 * C.row(11);
  C.row(20).setZero();
  const Dense singular = C * C.transpose();
  const SparseLdl dropping(Eigen::SparseMatrix<double>(singular.sparseView()));
  TEST_EQUALITY(dropping.numDropped(), 1);  // an empty row is none
  const Eigen::VectorXd consistent = singular * b, x = dropping.solve(consistent);
  TEST_EQUALITY(x[20], 0.0);
  TEST_ASSERT(largest(singular * x - consistent) < 1e-10 * largest(consistent));
}

// Hats of m nodes at n > m nodes of another division, but for round-off that a rough surface makes: n - m rows are nearly those of others, whatever comes first.
TEUCHOS_UNIT_TEST(DependentUnknowns, WhateverTheOrder) {
  const int n = 28, m = 22;
  Dense C = Dense::Zero(n, m);
  for (int i = 0; i < n; ++i) {
    const double x = double(i) * (m - 1) / (n - 1);
    for (int j = 0; j < m; ++j) C(i, j) = std::max(0.0, 1 - std::abs(x - j)) + 1e-7 * std::sin(1.0 + 3 * i + 5 * j) * (std::abs(x - j) < 2);
  }
  for (const int step : {1, 3, 5, 9, 11}) {
    Dense turned = C;
    for (int i = 0; i < n; ++i) turned.row(i) = C.row((i * step) % n);
    const Dense A = turned * turned.transpose();
    const std::vector<int> found = dependentUnknowns(Eigen::SparseMatrix<double>(A.sparseView()), 1e-6);
    TEST_EQUALITY(int(found.size()), n - m);
    std::vector<int> kept;
    for (int i = 0; i < n; ++i)
      if (!std::binary_search(found.begin(), found.end(), i)) kept.push_back(i);
    TEST_COMPARE(SymmetricEigen(Dense(A(kept, kept))).values[0], >, 1e-3);
  }
}

TEUCHOS_UNIT_TEST(DependentUnknowns, EmptyOnesDoNotCount) {
  Dense A = Dense::Identity(5, 5);
  A(2, 2) = 0;
  TEST_ASSERT(dependentUnknowns(Eigen::SparseMatrix<double>(A.sparseView()), 1e-6).empty());
  A(0, 1) = A(1, 0) = 1;
  TEST_EQUALITY(dependentUnknowns(Eigen::SparseMatrix<double>(A.sparseView()), 1e-6).size(), 1u);
}
