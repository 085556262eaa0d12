// SPDX-License-Identifier: BSD-3-Clause
// Matrices in, displacements out: against the same problem posed by parameters, and against systems made anew.
#include "Haptos_ContactSystem.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <map>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_NodalGather.hpp"
#include "Haptos_Parameters.hpp"
#include "Haptos_Simulation.hpp"
#include "Haptos_StiffnessAssembler.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace {

using namespace Haptos;
using Teuchos::ParameterList;
using Point = std::array<double, 3>;

const std::vector<IsotropicMaterial> kMaterials = {{"soft", 7.0, 0.3}, {"hard", 21.0, 0.25}};
constexpr double kTolerance = 1e-10;

// Two blocks on each other, held at x = 0, every rank has the whole mesh.
Mesh blocks() {
  std::vector<BoxSpec> boxes(2);
  for (int b = 0; b < 2; ++b) {
    boxes[b].blockName = b == 0 ? "lower" : "upper";
    boxes[b].lower = {0, 0, double(b - 1)};
    boxes[b].upper = {2, 1, double(b)};
    boxes[b].divisions = {4, 2, 2};
    const std::string name = boxes[b].blockName;
    boxes[b].sideSetNames = {name + "_x0", "", "", "", name + "_z0", name + "_z1"};
  }
  return makeBoxes(boxes);
}

GlobalOrdinal idOf(std::int64_t node) { return 7 * node + 3; }  // callers number as they like

Point forceAt(const Point& x, double factor) {
  if (x[2] < 1 - 1e-9) return {0, 0, 0};
  return {0.03 * factor, 0.01 * factor * x[0], -0.06 * factor};
}

struct Piece {
  int body;
  std::vector<std::int64_t> nodes;
  Coordinates coordinates;
  ElementGroup group;
};

Piece pieceOf(const Mesh& mesh, int body, const std::vector<std::size_t>& elements) {
  Piece piece{body, {}, {}, {}};
  const auto& block = mesh.blocks[std::size_t(body)];
  std::map<std::int64_t, int> local;
  for (auto e : elements)
    for (std::size_t i = 8 * e; i < 8 * e + 8; ++i) local[block.connectivity[i]] = 0;
  for (auto& [node, place] : local) {
    place = int(piece.nodes.size());
    piece.nodes.push_back(node);
    piece.coordinates.push_back(mesh.coordinates[std::size_t(node)]);
  }
  piece.group.topology = Topology::Hex8;
  piece.group.material = body;
  for (auto e : elements)
    for (std::size_t i = 8 * e; i < 8 * e + 8; ++i) piece.group.connectivity.push_back(local[block.connectivity[i]]);
  return piece;
}

// Every body in two halves along x.
std::vector<Piece> halves(const Mesh& mesh) {
  std::vector<Piece> pieces;
  for (int body = 0; body < 2; ++body)
    for (int half = 0; half < 2; ++half) {
      std::vector<std::size_t> elements;
      for (std::size_t e = 0; e < mesh.blocks[std::size_t(body)].numElements(); ++e) {
        double x = 0;
        for (std::size_t i = 8 * e; i < 8 * e + 8; ++i) x += mesh.coordinates[std::size_t(mesh.blocks[std::size_t(body)].connectivity[i])][0] / 8;
        if ((x > 1) == (half == 1)) elements.push_back(e);
      }
      pieces.push_back(pieceOf(mesh, body, elements));
    }
  return pieces;
}

Eigen::SparseMatrix<double> stiffnessOf(const Piece& piece) {
  return assembleStiffness(piece.coordinates, {piece.group}, kMaterials, Formulation::Standard);
}

RCP<CrsMatrix> crsOf(const Eigen::SparseMatrix<double>& K) {
  const auto self = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
  const auto map = Teuchos::rcp(new Map(Tpetra::global_size_t(K.rows()), 0, self));
  const auto result = Teuchos::rcp(new CrsMatrix(map, 81));
  for (int column = 0; column < K.cols(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator it(K, column); it; ++it)
      result->insertGlobalValues(GlobalOrdinal(column), Teuchos::tuple<GlobalOrdinal>(it.row()), Teuchos::tuple(it.value()));
  result->fillComplete();
  return result;
}

std::vector<GlobalOrdinal> idsOf(const std::vector<std::int64_t>& nodes) {
  std::vector<GlobalOrdinal> ids;
  for (auto node : nodes) ids.push_back(idOf(node));
  return ids;
}

std::vector<double> flat(const Coordinates& coordinates) {
  std::vector<double> values;
  for (const auto& x : coordinates) values.insert(values.end(), x.begin(), x.end());
  return values;
}

RCP<ParameterList> parameters() {
  const auto list = Teuchos::rcp(new ParameterList);
  list->sublist("Solver").set("Relative Tolerance", kTolerance);
  list->sublist("Local Solver").set<std::string>("Dual Operator", "Implicit");
  list->sublist("Decomposition").set("Subdomains", 4);
  return list;
}

// A system that is filled as each test wants.
struct Filled {
  Mesh mesh = blocks();
  std::vector<RCP<CrsMatrix>> matrices;  // of this rank
  std::vector<Piece> pieces = halves(mesh);
  std::vector<int> pairs;                // numbers on this rank
  ContactSystem system;
  FrictionSpec friction{FrictionLaw::Coulomb, {0.3, 0.15}, 0, false};

  explicit Filled(const RCP<const Communicator>& comm = Tpetra::getDefaultComm()) : system(comm, parameters()), comm_(comm) {}

  void addMatrices() {
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (int(i) % comm_->getSize() != comm_->getRank()) continue;
      matrices.push_back(crsOf(stiffnessOf(pieces[i])));
      addPiece(pieces[i], matrices.back());
    }
  }
  void addPiece(const Piece& piece, const RCP<const CrsMatrix>& K) {
    const auto ids = idsOf(piece.nodes);
    const auto x = flat(piece.coordinates);
    system.addSubdomain({piece.body, Teuchos::arrayViewFromVector(ids), Teuchos::arrayViewFromVector(x), K});
  }
  void addElements() {
    forMyElements([&](int body, const Piece& piece) {
      const auto ids = idsOf(piece.nodes);
      const auto x = flat(piece.coordinates);
      const Eigen::MatrixXd Ke(stiffnessOf(piece));
      system.addNodes(Teuchos::arrayViewFromVector(ids), Teuchos::arrayViewFromVector(x));
      system.addElement(body, Teuchos::arrayViewFromVector(ids), Teuchos::ArrayView<const double>(Ke.data(), Ke.size()));
    });
  }
  void setElements(double factor) {
    int number = 0;
    forMyElements([&](int, const Piece& piece) {
      const Eigen::MatrixXd Ke(factor * Eigen::MatrixXd(stiffnessOf(piece)));
      system.setElement(number++, Teuchos::ArrayView<const double>(Ke.data(), Ke.size()));
    });
  }
  void addRest(double gap = 0, double smallestX = -1) {
    if (system.addInterface("interface", friction) != 0) throw std::logic_error("first interface");
    for (std::size_t node = 0; node < mesh.numNodes(); ++node)
      if (mesh.coordinates[node][0] < 1e-9 && int(node) % comm_->getSize() == comm_->getRank())
        for (int d = 0; d < 3; ++d) system.prescribe(idOf(std::int64_t(node)), d, 0.0);
    addPairs(gap, smallestX);
  }
  void addPairs(double gap = 0, double smallestX = -1) {
    pairs.clear();
    const std::size_t half = mesh.numNodes() / 2;  // the blocks' nodes are numbered alike
    const double top = 0;
    for (std::size_t upper = half; upper < mesh.numNodes(); ++upper) {
      const Point& x = mesh.coordinates[upper];
      if (std::abs(x[2] - top) > 1e-9 || x[0] < 1e-9 || x[0] < smallestX || int(upper) % comm_->getSize() != comm_->getRank()) continue;
      for (std::size_t lower = 0; lower < half; ++lower)
        if (std::abs(mesh.coordinates[lower][2]) < 1e-9 && std::hypot(mesh.coordinates[lower][0] - x[0], mesh.coordinates[lower][1] - x[1]) < 1e-9)
          pairs.push_back(system.addPair({0, idOf(std::int64_t(upper)), {{idOf(std::int64_t(lower)), 1.0}}, {0, 0, -1}, {1, 0, 0}, gap, 1.0}));
    }
  }

  // Displacements by mesh node, on all ranks.
  Eigen::VectorXd solve(double factor = 1) {
    system.setUp();
    Vector f(system.map()), u(system.map());
    {
      const auto data = f.getDataNonConst(0);
      for (int i = 0; i < int(data.size()); ++i) {
        const auto unknown = system.map()->getGlobalElement(i);
        data[i] = forceAt(mesh.coordinates[std::size_t((unknown / 3 - 3) / 7)], factor)[std::size_t(unknown % 3)];
      }
    }
    outcome = system.solve(f, u);
    Eigen::VectorXd mine = Eigen::VectorXd::Zero(3 * Eigen::Index(mesh.numNodes())), all(mine.size());
    const auto data = u.getData(0);
    for (int i = 0; i < int(data.size()); ++i) {
      const auto unknown = system.map()->getGlobalElement(i);
      mine[3 * ((unknown / 3 - 3) / 7) + unknown % 3] = data[i];
    }
    Teuchos::reduceAll(*comm_, Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), all.data());
    return all;
  }
  ContactSystem::Outcome outcome;

 private:
  template <class Visit>
  void forMyElements(Visit&& visit) const {
    for (int body = 0; body < 2; ++body)
      for (std::size_t e = 0; e < mesh.blocks[std::size_t(body)].numElements(); ++e)
        if (int(e) % comm_->getSize() == comm_->getRank()) visit(body, pieceOf(mesh, body, {e}));
  }

  RCP<const Communicator> comm_;
};

std::unique_ptr<Filled> makeSystem(double gap = 0, double smallestX = -1) {
  auto filled = std::make_unique<Filled>();
  filled->addMatrices();
  filled->addRest(gap, smallestX);
  return filled;
}

double difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return (a - b).lpNorm<Eigen::Infinity>() / a.lpNorm<Eigen::Infinity>(); }

Eigen::VectorXd solveByParameters(const Mesh& mesh) {
  ParameterList list("Haptos");
  list.sublist("Mesh").set<std::string>("File", "in_memory.exo");
  list.sublist("Decomposition").set("Subdomains", 4);
  for (int b = 0; b < 2; ++b) {
    auto& m = list.sublist("Materials").sublist(b == 0 ? "soft" : "hard");
    m.set("Element Blocks", Teuchos::Array<std::string>(1, b == 0 ? "lower" : "upper"));
    m.set("Young's Modulus", kMaterials[std::size_t(b)].youngsModulus);
    m.set("Poisson's Ratio", kMaterials[std::size_t(b)].poissonsRatio);
  }
  auto& clamp = list.sublist("Boundary Conditions").sublist("clamp");
  clamp.set<std::string>("Type", "Displacement");
  clamp.set("Sets", Teuchos::Array<std::string>(std::vector<std::string>{"lower_x0", "upper_x0"}));
  clamp.set("Value", Teuchos::Array<double>(3, 0.0));
  auto& interface = list.sublist("Contact").sublist("interface");
  interface.set<std::string>("Secondary Side Set", "upper_z0");
  interface.set<std::string>("Primary Side Set", "lower_z1");
  interface.sublist("Friction").set<std::string>("Law", "Coulomb");
  interface.sublist("Friction").set("Coefficients", Teuchos::Array<double>(std::vector<double>{0.3, 0.15}));
  list.sublist("Solver").set("Relative Tolerance", kTolerance);
  list.sublist("Output").set<std::string>("File", "");
  SourceMesh source;
  source.mesh = mesh;
  const auto comm = Tpetra::getDefaultComm();
  Simulation simulation(comm, validatedParameters(list), nullptr, &source);
  simulation.addNodalForces([](std::int64_t, const Point& x) { return forceAt(x, 1); });
  simulation.prepare();
  const auto result = simulation.solve();
  auto whole = wholeOnRoot(*comm, result.displacement);
  whole.resize(3 * mesh.numNodes());
  Teuchos::broadcast(*comm, 0, int(whole.size()), whole.data());
  return Eigen::Map<const Eigen::VectorXd>(whole.data(), Eigen::Index(whole.size()));
}

template <class Work>
std::string refusal(Work&& work) {
  try {
    work();
  } catch (const InputError& e) {
    return e.what();
  } catch (const InsufficientModel& e) {
    return std::string("insufficient: ") + e.what();
  }
  return "";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

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

  const auto other = [&](auto&& change) {
    const auto filled = makeSystem();
    change(filled->system);
    return refusal([&] { filled->system.setUp(); });
  };
  TEST_ASSERT(contains(other([&](ContactSystem& s) { if (rank == 0) s.addPair({0, 999999, {}, {0, 0, -1}, {1, 0, 0}}); }), "999999"));
  TEST_ASSERT(contains(other([&](ContactSystem& s) { if (rank == 0) s.addPair({3, idOf(20), {}, {0, 0, -1}, {1, 0, 0}}); }), "interface 3"));
  TEST_ASSERT(contains(other([&](ContactSystem& s) { if (rank == 0) s.addPair({0, idOf(20), {{idOf(1), 0.5}}, {0, 0, -1}, {1, 0, 0}}); }), "add up"));
  TEST_ASSERT(contains(other([&](ContactSystem& s) { if (rank == 0) s.prescribe(5, 0, 0.0); }), "no subdomain"));
  TEST_ASSERT(contains(other([&](ContactSystem& s) { if (rank == 0) s.prescribe(idOf(20), 7, 0.0); }), "Component 7"));
  TEST_ASSERT(contains(other([&](ContactSystem& s) { if (rank == 0) s.setGap(1000, 0.0); }), "pair 1000"));

  const auto list = parameters();
  list->sublist("Solver").set("Relative Tolerence", 1e-3);
  TEST_ASSERT(contains(refusal([&] { ContactSystem wrong(Tpetra::getDefaultComm(), list); }), "Relative Tolerance"));
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
