// SPDX-License-Identifier: BSD-3-Clause
// Two blocks on each other as a ContactSystem takes them: matrices of halves, or elements; and the same by parameters.
#pragma once
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <functional>
#include <map>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_ContactSystem.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_NodalGather.hpp"
#include "Haptos_Parameters.hpp"
#include "Haptos_Simulation.hpp"
#include "Haptos_StiffnessAssembler.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos::Testing {

using Teuchos::ParameterList;
using Point = std::array<double, 3>;

inline const std::vector<IsotropicMaterial> kMaterials = {{"soft", 7.0, 0.3}, {"hard", 21.0, 0.25}};
constexpr double kTolerance = 1e-10;

// Two blocks on each other, held at x = 0, every rank has the whole mesh.
inline Mesh blocks() {
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

// Of a node in the interface of `blocks`.
inline double areaAt(const Point& x) {
  const auto isEdge = [](double value, double high) { return value < 1e-9 || value > high - 1e-9; };
  return 0.25 * (isEdge(x[0], 2) ? 0.5 : 1.0) * (isEdge(x[1], 1) ? 0.5 : 1.0);
}

inline GlobalOrdinal idOf(std::int64_t node) { return 7 * node + 3; }  // callers number as they like

inline Point forceAt(const Point& x, double factor) {
  if (x[2] < 1 - 1e-9) return {0, 0, 0};
  return {0.03 * factor, 0.01 * factor * x[0], -0.06 * factor};
}

struct Piece {
  int body;
  std::vector<std::int64_t> nodes;
  Coordinates coordinates;
  ElementGroup group;
};

inline Piece pieceOf(const Mesh& mesh, int body, const std::vector<std::size_t>& elements) {
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
inline std::vector<Piece> halves(const Mesh& mesh) {
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

inline Eigen::SparseMatrix<double> stiffnessOf(const Piece& piece) {
  return assembleStiffness(piece.coordinates, {piece.group}, kMaterials, Formulation::Standard);
}

inline RCP<CrsMatrix> crsOf(const Eigen::SparseMatrix<double>& K) {
  const auto self = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
  const auto map = Teuchos::rcp(new Map(Tpetra::global_size_t(K.rows()), 0, self));
  const auto result = Teuchos::rcp(new CrsMatrix(map, 81));
  for (int column = 0; column < K.cols(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator it(K, column); it; ++it)
      result->insertGlobalValues(GlobalOrdinal(column), Teuchos::tuple<GlobalOrdinal>(it.row()), Teuchos::tuple(it.value()));
  result->fillComplete();
  return result;
}

inline std::vector<GlobalOrdinal> idsOf(const std::vector<std::int64_t>& nodes) {
  std::vector<GlobalOrdinal> ids;
  for (auto node : nodes) ids.push_back(idOf(node));
  return ids;
}

inline std::vector<double> flat(const Coordinates& coordinates) {
  std::vector<double> values;
  for (const auto& x : coordinates) values.insert(values.end(), x.begin(), x.end());
  return values;
}

inline RCP<ParameterList> parameters() {
  const auto list = Teuchos::rcp(new ParameterList);
  list->sublist("Solver").set("Relative Tolerance", kTolerance);
  list->sublist("Local Solver").set<std::string>("Dual Operator", "Implicit");
  list->sublist("Decomposition").set("Subdomains", 4);
  return list;
}

// A system that is filled as each test wants.
struct Filled {
  Mesh mesh;
  std::vector<RCP<CrsMatrix>> matrices;  // of this rank
  std::vector<Piece> pieces = halves(mesh);
  std::vector<int> pairs;                // numbers on this rank
  std::vector<std::size_t> secondaries;  // their nodes
  ContactSystem system;
  FrictionSpec friction{FrictionLaw::Coulomb, {0.3, 0.15}, 0, false};
  bool isUpperHeld = true;

  explicit Filled(Mesh m = blocks(), const RCP<const Communicator>& comm = Tpetra::getDefaultComm())
      : mesh(std::move(m)), system(comm, parameters()), comm_(comm) {}

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
  void addElements(const std::function<Eigen::SparseMatrix<double>(const Piece&)>& stiffness = stiffnessOf) {
    forMyElements([&](int body, const Piece& piece) {
      const auto ids = idsOf(piece.nodes);
      const auto x = flat(piece.coordinates);
      const Eigen::MatrixXd Ke(stiffness(piece));
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
    hold();
    addPairs(gap, smallestX);
  }
  void hold() {
    for (std::size_t node = 0; node < mesh.numNodes(); ++node)
      if (mesh.coordinates[node][0] < 1e-9 && (isUpperHeld || node < mesh.numNodes() / 2) && int(node) % comm_->getSize() == comm_->getRank())
        for (int d = 0; d < 3; ++d) system.prescribe(idOf(std::int64_t(node)), d, 0.0);
  }
  void addPairs(double gap = 0, double smallestX = -1) {
    pairs.clear();
    secondaries.clear();
    addPairs(0, gap, smallestX, 3);
  }
  void addPairs(int interface, double gap, double smallestX, double largestX) {
    const std::size_t half = mesh.numNodes() / 2;  // the blocks' nodes are numbered alike
    const double top = 0;
    for (std::size_t upper = half; upper < mesh.numNodes(); ++upper) {
      const Point& x = mesh.coordinates[upper];
      if (std::abs(x[2] - top) > 1e-9 || (isUpperHeld && x[0] < 1e-9) || x[0] < smallestX || x[0] > largestX || int(upper) % comm_->getSize() != comm_->getRank()) continue;
      for (std::size_t lower = 0; lower < half; ++lower)
        if (std::abs(mesh.coordinates[lower][2]) < 1e-9 && std::hypot(mesh.coordinates[lower][0] - x[0], mesh.coordinates[lower][1] - x[1]) < 1e-9) {
          secondaries.push_back(upper);
          pairs.push_back(system.addPair({interface, idOf(std::int64_t(upper)), {{idOf(std::int64_t(lower)), 1.0}}, {0, 0, -1}, {1, 0, 0}, gap, areaAt(x)}));
        }
    }
  }

  // Displacements by mesh node, on all ranks.
  Eigen::VectorXd solve(double factor = 1) {
    return solve([&](const Point& x) { return forceAt(x, factor); });
  }
  Eigen::VectorXd solve(const std::function<Point(const Point&)>& force) {
    system.setUp();
    Vector f(system.map()), u(system.map());
    {
      const auto data = f.getDataNonConst(0);
      for (int i = 0; i < int(data.size()); ++i) {
        const auto unknown = system.map()->getGlobalElement(i);
        data[i] = force(mesh.coordinates[std::size_t((unknown / 3 - 3) / 7)])[std::size_t(unknown % 3)];
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

inline std::unique_ptr<Filled> makeSystem(double gap = 0, double smallestX = -1) {
  auto filled = std::make_unique<Filled>();
  filled->addMatrices();
  filled->addRest(gap, smallestX);
  return filled;
}

inline double difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return (a - b).lpNorm<Eigen::Infinity>() / a.lpNorm<Eigen::Infinity>(); }

inline Eigen::VectorXd solveByParameters(const Mesh& mesh, const FrictionSpec& friction = {FrictionLaw::Coulomb, {0.3, 0.15}, 0, false}) {
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
  interface.sublist("Friction").set<std::string>("Law", nameOf(std::optional<FrictionLaw>(friction.law)));
  interface.sublist("Friction").set("Coefficients", Teuchos::Array<double>(friction.coefficients.begin(), friction.coefficients.end()));
  if (friction.law == FrictionLaw::Tresca) interface.sublist("Friction").set("Slip Bound", friction.slipBound);
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

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace Haptos::Testing
