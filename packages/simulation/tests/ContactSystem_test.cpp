// SPDX-License-Identifier: BSD-3-Clause
// Matrices in, displacements out: against the same problem posed by parameters, and against systems made anew.
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>
#include <numeric>

#include "ContactScene.hpp"
#include "Haptos_OwnStiffness.hpp"

using namespace Haptos;
using namespace Haptos::Testing;

namespace {

// The last row has an entry in a column more than there are rows.
RCP<CrsMatrix> withColumnOutside(const Eigen::SparseMatrix<double>& K) {
  const auto rows = crsOf(K)->getRowMap();
  const auto domain = Teuchos::rcp(new Map(Tpetra::global_size_t(K.cols() + 1), 0, rows->getComm()));
  const auto result = Teuchos::rcp(new CrsMatrix(rows, 82));
  for (int column = 0; column < K.cols(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator it(K, column); it; ++it)
      result->insertGlobalValues(GlobalOrdinal(column), Teuchos::tuple<GlobalOrdinal>(it.row()), Teuchos::tuple(it.value()));
  result->insertGlobalValues(GlobalOrdinal(K.rows() - 1), Teuchos::tuple<GlobalOrdinal>(K.cols()), Teuchos::tuple(1.0));
  result->fillComplete(domain, rows);
  return result;
}

}  // namespace

TEUCHOS_UNIT_TEST(ContactSystem, MatricesElementsAndParametersAgree) {
  const auto matrices = makeSystem();
  const Eigen::VectorXd u = matrices->solve();
  TEST_ASSERT(matrices->outcome.solved && matrices->outcome.kkt <= kTolerance);
  TEST_ASSERT(u.lpNorm<Eigen::Infinity>() > 1e-3);
  Filled elements;
  elements.addElements();
  elements.addRest();
  TEST_ASSERT(difference(u, elements.solve()) < 1e-8);
  TEST_ASSERT(difference(u, solveByParameters(matrices->mesh)) < 1e-8);
  int mine[3] = {0, 0, 0}, all[3];  // open, slipping, sticking: the hard path was taken
  double normal = 0, sum = 0;
  for (const auto& force : matrices->system.contactForces()) {
    const double level = force[0] > 1e-9 ? std::hypot(force[1] / 0.3, force[2] / 0.15) / force[0] : 0.0;
    ++mine[force[0] < 1e-9 ? 0 : level > 1 - 1e-6 ? 1 : 2];
    normal += force[0];
  }
  Teuchos::reduceAll(*Tpetra::getDefaultComm(), Teuchos::REDUCE_SUM, 3, mine, all);
  Teuchos::reduceAll(*Tpetra::getDefaultComm(), Teuchos::REDUCE_SUM, normal, Teuchos::outArg(sum));
  out << "open " << all[0] << ", slip " << all[1] << ", stick " << all[2] << ", normal force " << sum << "\n";
  TEST_ASSERT(all[0] + all[1] + all[2] == 12 && all[1] > 0 && sum > 0.1);
}

// An application's matrix tells who is a neighbour, that is enough to find what is thin and bent.
TEUCHOS_UNIT_TEST(ContactSystem, ThinPartsAreFoundByTheirMatrices) {
  for (const double thickness : {0.02, 0.5}) {
    std::vector<BoxSpec> box(1);
    box[0].divisions = {24, 3, 2};
    box[0].map = [&](const Point& x) {
      const double radius = 1 + thickness * x[2];
      return Point{-radius * std::cos(3 * x[0]), 0.5 * x[1], radius * std::sin(3 * x[0])};
    };
    const Mesh mesh = makeBoxes(box);
    std::vector<std::size_t> all(std::size_t(mesh.numElements()));
    std::iota(all.begin(), all.end(), 0);
    const Piece piece = pieceOf(mesh, 0, all);
    const OwnStiffness stiffness({{"part", piece.coordinates, crsOf(stiffnessOf(piece)), {}}});
    out << thickness << ": " << stiffness.aspect(0) << "\n";
    TEST_EQUALITY(isSlender(stiffness.aspect(0)), thickness < 0.1);
  }
}

// And what a thin plate's nodes meet, by the normals of pairs.
TEUCHOS_UNIT_TEST(ContactSystem, ThinPlatesAreWeighedByTheirPairs) {
  const double thickness = 0.005;
  std::vector<BoxSpec> boxes(2);
  for (int b = 0; b < 2; ++b) {
    boxes[b].blockName = b == 0 ? "block" : "plate";
    boxes[b].lower = {0, 0, b == 0 ? -0.5 : 0.0};
    boxes[b].upper = {3, 0.5, b == 0 ? 0.0 : thickness};
    boxes[b].divisions = {12, 4, 4};
  }
  Filled filled(makeBoxes(boxes));
  filled.pieces.resize(2);  // the plate is one
  std::vector<std::size_t> all(filled.mesh.blocks[1].numElements());
  std::iota(all.begin(), all.end(), 0);
  filled.pieces.push_back(pieceOf(filled.mesh, 1, all));
  filled.addMatrices();
  filled.addRest();
  for (std::size_t node = 0; node < filled.mesh.numNodes(); ++node)
    if (const Point& x = filled.mesh.coordinates[node]; x[2] < -0.499 && x[0] > 0 && Tpetra::getDefaultComm()->getRank() == 0)
      for (int d = 0; d < 3; ++d) filled.system.prescribe(idOf(std::int64_t(node)), d, 0.0);
  filled.solve([&](const Point& x) { return x[2] > 0.9 * thickness ? Point{1e-4, 2e-4, -1e-2} : Point{}; });
  out << filled.outcome.multiplications << " multiplications, kkt " << filled.outcome.kkt << "\n";
  TEST_ASSERT(filled.outcome.solved);
  TEST_COMPARE(filled.outcome.multiplications, <=, 24);
}

// Without contact, nearly incompressible: what is kept of a solve of many iterations serves other loads.
TEUCHOS_UNIT_TEST(ContactSystem, LaterLoadsBeginWithWhatDirectionsKnow) {
  const auto rubber = [](const Piece& piece) {
    return assembleStiffness(piece.coordinates, {piece.group}, {{"rubber", 7.0, 0.4999}, {"rubber", 7.0, 0.4999}}, Formulation::BBar);
  };
  std::vector<BoxSpec> cubes(2);
  for (int b = 0; b < 2; ++b) {
    cubes[b].blockName = b == 0 ? "lower" : "upper";
    cubes[b].lower = {0, 0, double(b - 1)};
    cubes[b].upper = {1, 1, double(b)};
    cubes[b].divisions = {6, 6, 6};
  }
  const auto loads = [](double x, double y) {
    return [x, y](const Point& at) { return at[0] > 0.9 ? Point{0.01 * y, 0.02 * x, 0.03 * at[2] * y} : Point{}; };
  };
  Filled filled(makeBoxes(cubes)), other(makeBoxes(cubes));
  for (Filled* system : {&filled, &other}) {
    system->addElements(rubber);
    system->hold();
  }
  for (const auto& [x, y] : {std::pair(1.0, 0.2), {-0.3, 1.0}}) {
    filled.solve(loads(x, y));
    out << filled.outcome.multiplications << " multiplications\n";
  }
  const Eigen::VectorXd u = filled.solve(loads(0.7, 0.5)), expected = other.solve(loads(0.7, 0.5));
  out << filled.outcome.multiplications << ", afresh " << other.outcome.multiplications << "\n";
  TEST_ASSERT(filled.outcome.solved && other.outcome.solved);
  TEST_COMPARE(difference(expected, u), <, 1e-7);
  TEST_COMPARE(3 * filled.outcome.multiplications, <=, 2 * other.outcome.multiplications);
}

// Every row of the table of what is done again.
TEUCHOS_UNIT_TEST(ContactSystem, OnlyWhatChangedIsDoneAgain) {
  const auto filled = makeSystem();
  ContactSystem& system = filled->system;
  const Eigen::VectorXd u = filled->solve();
  const long factored = system.counters().factorizations;
  TEST_ASSERT(factored > 0);
  TEST_EQUALITY(system.counters().rows, 1L);

  const Eigen::VectorXd twice = filled->solve(2);  // loads: all is homogeneous
  TEST_ASSERT(difference(2 * u, twice) < 1e-7);
  TEST_EQUALITY(system.counters().factorizations, factored);
  TEST_EQUALITY(system.counters().rows, 1L);

  for (int pair : filled->pairs) system.setGap(pair, 2e-3);
  const Eigen::VectorXd apart = filled->solve();
  TEST_ASSERT(difference(apart, makeSystem(2e-3)->solve()) < 1e-7);
  TEST_ASSERT(difference(apart, u) > 1e-3);
  for (int pair : filled->pairs) system.setGap(pair, 0);

  FrictionSpec less = filled->friction;
  less.coefficients = {0.05, 0.02};
  system.setFriction(0, less);
  const Eigen::VectorXd slippery = filled->solve();
  Filled other;
  other.friction = less;
  other.addMatrices();
  other.addRest();
  TEST_ASSERT(difference(slippery, other.solve()) < 1e-7);
  TEST_ASSERT(difference(slippery, u) > 1e-4);
  TEST_EQUALITY(system.counters().factorizations, factored);
  TEST_EQUALITY(system.counters().rows, 1L);
  system.setFriction(0, filled->friction);

  system.clearPairs();
  filled->addPairs(0, 0.9);
  const Eigen::VectorXd fewer = filled->solve();
  TEST_ASSERT(difference(fewer, makeSystem(0, 0.9)->solve()) < 1e-7);
  TEST_EQUALITY(system.counters().factorizations, factored);
  TEST_EQUALITY(system.counters().rows, 2L);

  for (const auto& K : filled->matrices) {
    K->resumeFill();
    K->scale(2.0);
    K->fillComplete();
  }
  system.updateStiffness();
  const Eigen::VectorXd stiff = filled->solve();
  TEST_ASSERT(difference(fewer, 2 * stiff) < 1e-7);
  TEST_EQUALITY(system.counters().factorizations, 2 * factored);
  TEST_ASSERT(filled->outcome.multiplications <= 2);  // the multipliers are those of before

  for (int pair : filled->pairs) system.setGap(pair, 1e-3);  // nothing was iterated with the new matrices: no pairs to start with
  TEST_ASSERT(difference(2 * filled->solve(), makeSystem(2e-3, 0.9)->solve()) < 1e-7);
}

TEUCHOS_UNIT_TEST(ContactSystem, ElementsTakeOtherMatrices) {
  Filled filled;
  filled.addElements();
  filled.addRest();
  const Eigen::VectorXd u = filled.solve();
  const long factored = filled.system.counters().factorizations;
  filled.setElements(4.0);
  TEST_ASSERT(difference(u, 4 * filled.solve()) < 1e-7);
  TEST_EQUALITY(filled.system.counters().factorizations, 2 * factored);
  filled.system.setTolerance(1e-3);
  filled.setElements(1.0);
  const Eigen::VectorXd rough = filled.solve(1.5);
  TEST_ASSERT(filled.outcome.solved && filled.outcome.kkt > kTolerance && filled.outcome.kkt <= 1e-3);
  TEST_ASSERT(difference(1.5 * u, rough) < 1e-1);
  filled.system.setElement(100000, {});
  TEST_ASSERT(contains(refusal([&] { filled.system.setUp(); }), "element 100000"));
  filled.system.setTolerance(0);
  TEST_ASSERT(contains(refusal([&] { filled.system.setUp(); }), "tolerance"));
}

TEUCHOS_UNIT_TEST(ContactSystem, PrescribedValuesMove) {
  const auto filled = makeSystem();
  filled->solve();
  const long factored = filled->system.counters().factorizations;
  const auto comm = Tpetra::getDefaultComm();
  for (std::size_t node = 0; node < filled->mesh.numNodes(); ++node)
    if (filled->mesh.coordinates[node][0] < 1e-9 && int(node) % comm->getSize() == comm->getRank())
      filled->system.prescribe(idOf(std::int64_t(node)), 1, 0.25);
  const Eigen::VectorXd moved = filled->solve();
  const auto still = makeSystem();
  Eigen::VectorXd expected = still->solve();
  for (Eigen::Index i = 1; i < expected.size(); i += 3) expected[i] += 0.25;  // all bodies move along
  TEST_ASSERT(difference(expected, moved) < 1e-7);
  TEST_EQUALITY(filled->system.counters().factorizations, factored);
}

TEUCHOS_UNIT_TEST(ContactSystem, TwoSystemsLiveAtOnce) {
  const auto a = makeSystem(), b = makeSystem(2e-3);
  const Eigen::VectorXd first = a->solve(), second = b->solve();
  TEST_ASSERT(difference(first, second) > 1e-3);
  TEST_ASSERT(difference(first, a->solve()) < 1e-8);
  TEST_ASSERT(difference(second, b->solve()) < 1e-8);
}

// With its own coefficients, as if it had been there from the start.
TEUCHOS_UNIT_TEST(ContactSystem, InterfacesMayComeLater) {
  const FrictionSpec slippery{FrictionLaw::Coulomb, {0.05, 0.02}, 0, false};
  const auto addSecond = [&](Filled& filled) {
    const int second = filled.system.addInterface("second", slippery);
    TEST_EQUALITY(second, 1);
    filled.addPairs(second, 0, -1, 1.2);
  };
  const auto filled = makeSystem(0, 1.2), other = makeSystem(0, 1.2), alike = makeSystem();
  const Eigen::VectorXd before = filled->solve();
  addSecond(*filled);
  TEST_ASSERT(contains(refusal([&] { filled->system.contactForces(); }), "solve first"));
  const Eigen::VectorXd after = filled->solve();
  addSecond(*other);
  TEST_ASSERT(difference(after, other->solve()) < 1e-7);
  TEST_ASSERT(filled->outcome.solved && difference(after, before) > 1e-4 && difference(after, alike->solve()) > 1e-4);
  TEST_EQUALITY(filled->system.contactForces().size(), filled->pairs.size());
}

TEUCHOS_UNIT_TEST(ContactSystem, FrictionIsLookedAtWhereverItChanges) {
  const auto comm = Tpetra::getDefaultComm();
  const auto filled = makeSystem();
  const Eigen::VectorXd u = filled->solve();
  const auto refusalOf = [&](std::array<double, 2> coefficients, bool isEverywhere) {
    FrictionSpec friction = filled->friction;
    if (isEverywhere || comm->getRank() == 0) friction.coefficients = coefficients;
    filled->system.setFriction(0, friction);
    return refusal([&] { filled->system.setUp(); });
  };
  TEST_ASSERT(contains(refusalOf({-0.3, 0.3}, true), "'interface' has the coefficient of friction -0.3"));
  TEST_ASSERT(contains(refusalOf({0.3, std::nan("")}, true), "'interface' has the coefficient of friction"));
  if (comm->getSize() > 1) TEST_ASSERT(contains(refusalOf({0.2, 0.1}, false), "differ from rank to rank"));
  filled->system.setFriction(0, filled->friction);
  TEST_ASSERT(difference(u, filled->solve()) < 1e-7);
}

// A body that contact alone holds may slide where a coefficient is 0; once it is not, that motion is one of the unknowns.
TEUCHOS_UNIT_TEST(ContactSystem, FrictionMayBeginToHoldABody) {
  const auto push = [](const Point& x) { return x[2] < 1 - 1e-9 ? Point{0, 0, 0} : Point{0.004, 0, -0.06}; };
  const auto press = [](const Point& x) { return x[2] < 1 - 1e-9 ? Point{0, 0, 0} : Point{0, 0.002, -0.06}; };
  const auto make = [](std::array<double, 2> coefficients) {
    auto filled = std::make_unique<Filled>();
    filled->isUpperHeld = false;
    filled->friction.coefficients = coefficients;
    filled->addMatrices();
    filled->addRest();
    return filled;
  };
  const auto filled = make({0, 0.3});
  filled->solve(press);
  TEST_ASSERT(filled->outcome.solved);
  TEST_ASSERT(contains(refusal([&] { filled->solve(push); }), "cannot carry the loads"));
  FrictionSpec rough = filled->friction;
  rough.coefficients = {0.3, 0.3};
  filled->system.setFriction(0, rough);
  const Eigen::VectorXd held = filled->solve(push);
  TEST_EQUALITY(filled->outcome.method, std::string("Subspace Newton"));
  TEST_ASSERT(filled->outcome.solved && difference(held, make({0.3, 0.3})->solve(push)) < 1e-6);
}

// What is left of multipliers then is round-off, and no start.
TEUCHOS_UNIT_TEST(ContactSystem, NothingMovesWithoutLoads) {
  for (const double gap : {0.0, 1e-3}) {
    const auto filled = makeSystem(gap);
    const Eigen::VectorXd u = filled->solve();
    TEST_EQUALITY(filled->solve(0).lpNorm<Eigen::Infinity>(), 0.0);
    TEST_ASSERT(filled->outcome.solved && filled->outcome.multiplications <= 2);
    for (const auto& force : filled->system.contactForces()) TEST_EQUALITY(std::hypot(force[0], force[1], force[2]), 0.0);
    TEST_ASSERT(difference(u, filled->solve()) < 1e-7);
  }
}

TEUCHOS_UNIT_TEST(ContactSystem, ForcesAreThoseOfSolvedPairs) {
  const auto filled = makeSystem();
  const auto text = [&] { return refusal([&] { filled->system.contactForces(); }); };
  TEST_ASSERT(contains(text(), "solve first"));
  filled->solve();
  TEST_EQUALITY(text(), std::string());
  filled->system.clearPairs();
  TEST_ASSERT(contains(text(), "solve first"));
  filled->system.addPair({0, 999999, {}, {0, 0, -1}, {1, 0, 0}});
  TEST_ASSERT(contains(refusal([&] { filled->system.setUp(); }), "999999"));
  TEST_ASSERT(contains(text(), "solve first"));
}

TEUCHOS_UNIT_TEST(ContactSystem, RefusesWhatItCannotTake) {
  const int rank = Tpetra::getDefaultComm()->getRank();
  const auto refusedWith = [&](auto&& fill) {
    Filled filled;
    fill(filled);
    return refusal([&] { filled.system.setUp(); });
  };
  const auto everywhere = [&](Filled& filled, auto&& change) {  // one rank has a matrix of its own kind
    for (std::size_t i = 0; i < filled.pieces.size(); ++i) {
      if (int(i) % Tpetra::getDefaultComm()->getSize() != rank) continue;
      Eigen::SparseMatrix<double> K = stiffnessOf(filled.pieces[i]);
      if (i == 0) change(K);
      filled.addPiece(filled.pieces[i], crsOf(K));
    }
    filled.addRest();
  };
  const auto text = [&](auto&& change) { return refusedWith([&](Filled& filled) { everywhere(filled, change); }); };
  TEST_ASSERT(contains(refusedWith([](Filled&) {}), "empty"));
  TEST_ASSERT(contains(text([](auto& K) { for (int i = 0; i < K.rows(); ++i) K.coeffRef(i, i) *= 2; }), "definite"));
  TEST_ASSERT(contains(text([](auto& K) { K.coeffRef(0, 1) += 1; }), "not symmetric"));
  TEST_ASSERT(contains(text([](auto& K) { K.conservativeResize(K.rows() - 3, K.cols() - 3); }), "rows"));
  TEST_ASSERT(contains(text([](auto& K) { K.coeffRef(4, 4) = std::nan(""); }), "not finite"));
  TEST_ASSERT(contains(text([](auto& K) { K = Eigen::SparseMatrix<double>(K.rows(), K.cols()); }), "no entries"));
  TEST_ASSERT(contains(refusedWith([&](Filled& filled) {
                         filled.addMatrices();
                         Piece piece = filled.pieces[0];
                         piece.body = 1;
                         if (rank == 0) filled.addPiece(piece, crsOf(stiffnessOf(piece)));
                         filled.addRest();
                       }),
                       "is in bodies 0 and 1"));
  TEST_ASSERT(contains(refusedWith([&](Filled& filled) { filled.addPiece(filled.pieces[0], withColumnOutside(stiffnessOf(filled.pieces[0]))); }),
                       "none of its rows"));
  TEST_ASSERT(contains(refusedWith([&](Filled& filled) {
                         const std::vector<GlobalOrdinal> ids = {5};
                         const std::vector<double> x = {0, std::nan(""), 0};
                         filled.system.addNodes(Teuchos::arrayViewFromVector(ids), Teuchos::arrayViewFromVector(x));
                       }),
                       "Node 5 has a coordinate that is not finite"));

  const auto other = [&](auto&& change) {
    const auto filled = makeSystem();
    change(filled->system);
    return refusal([&] { filled->system.setUp(); });
  };
  TEST_ASSERT(contains(other([&](ContactSystem& s) { if (rank == 0) s.addPair({0, 999999, {}, {0, 0, -1}, {1, 0, 0}}); }), "999999"));
  TEST_ASSERT(contains(other([&](ContactSystem& s) { if (rank == 0) s.addPair({3, idOf(20), {}, {0, 0, -1}, {1, 0, 0}}); }), "interface 3"));
  TEST_ASSERT(contains(other([&](ContactSystem& s) { if (rank == 0) s.addPair({0, idOf(20), {{idOf(1), 0.5}}, {0, 0, -1}, {1, 0, 0}}); }), "add up"));
  TEST_ASSERT(contains(other([&](ContactSystem& s) { if (rank == 0) s.addPair({0, idOf(20), {}, {0, 0, 0}, {1, 0, 0}}); }), "node 143: "));
  TEST_ASSERT(contains(other([&](ContactSystem& s) { if (rank == 0) s.prescribe(5, 0, 0.0); }), "no subdomain"));
  TEST_ASSERT(contains(other([&](ContactSystem& s) { if (rank == 0) s.prescribe(idOf(20), 7, 0.0); }), "Component 7"));
  TEST_ASSERT(contains(other([&](ContactSystem& s) { if (rank == 0) s.setGap(1000, 0.0); }), "pair 1000"));

  const auto list = parameters();
  list->sublist("Solver").set("Relative Tolerence", 1e-3);
  TEST_ASSERT(contains(refusal([&] { ContactSystem wrong(Tpetra::getDefaultComm(), list); }), "Relative Tolerance"));
  TEST_ASSERT(contains(refusal([&] { ContactSystem wrong(Teuchos::null); }), "communicator"));
}

TEUCHOS_UNIT_TEST(ContactSystem, GoesOnAfterAnError) {
  const auto filled = makeSystem();
  const Eigen::VectorXd u = filled->solve();
  filled->system.addPair({0, 999999, {}, {0, 0, -1}, {1, 0, 0}});
  TEST_ASSERT(contains(refusal([&] { filled->system.setUp(); }), "999999"));
  filled->system.clearPairs();
  filled->addPairs();
  TEST_ASSERT(difference(u, filled->solve()) < 1e-7);
}
