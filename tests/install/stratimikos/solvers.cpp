// SPDX-License-Identifier: BSD-3-Clause
// A stranger's elasticity problem, solved by whatever Stratimikos is told to: every argument is a file of its parameters.
//   solvers [--bricks p] [--cubes k] [--tolerance t] [--alike] FILE.xml...
// A block of k x k x k cubes of p x p x p bricks each, held at x = 0 and loaded by its weight.  Every cube has a stiffness of its own,
// unless they are alike.  Solvers of merged matrices get the merged matrix, Haptos its cubes; what they find, their iterations and the
// processor's seconds are printed side by side.
#include <Haptos_Stratimikos.hpp>
#include <Haptos_SubdomainMatrix.hpp>
#include <Stratimikos_MueLuHelpers.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_XMLParameterListHelpers.hpp>
#include <Thyra_LinearOpWithSolveFactoryHelpers.hpp>
#include <Thyra_TpetraThyraWrappers.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

namespace {

using Haptos::CrsMatrix;
using Haptos::GlobalOrdinal;
using Haptos::Map;
using Haptos::MultiVector;
using Haptos::Vector;
using Teuchos::ParameterList;
using Teuchos::RCP;
using Teuchos::rcp;

// 2 x 2 x 2 Gauss points; nodes by bits of x, y, z.
Eigen::Matrix<double, 24, 24> makeBrick(double h) {
  const double lame = 1.2, shear = 0.8, g = 1 / std::sqrt(3.0);
  Eigen::Matrix<double, 6, 6> C = Eigen::Matrix<double, 6, 6>::Zero();
  C.diagonal() << 2 * shear, 2 * shear, 2 * shear, shear, shear, shear;
  C.topLeftCorner<3, 3>().array() += lame;
  Eigen::Matrix<double, 24, 24> K = Eigen::Matrix<double, 24, 24>::Zero();
  for (int p = 0; p < 8; ++p) {
    Eigen::Matrix<double, 6, 24> B = Eigen::Matrix<double, 6, 24>::Zero();
    for (int i = 0; i < 8; ++i) {
      std::array<double, 3> d;
      const auto sign = [](int bits, int k) { return bits >> k & 1 ? 1.0 : -1.0; };
      for (int k = 0; k < 3; ++k) {
        d[k] = sign(i, k) / (4 * h);
        for (int l = 0; l < 3; ++l) d[k] *= l == k ? 1.0 : 1 + sign(i, l) * sign(p, l) * g;
      }
      B.block<6, 3>(0, 3 * i) << d[0], 0, 0, 0, d[1], 0, 0, 0, d[2], 0, d[2], d[1], d[2], 0, d[0], d[1], d[0], 0;
    }
    K += h * h * h / 8 * B.transpose() * C * B;
  }
  return K;
}

class Block {
 public:
  Block(const RCP<const Haptos::Communicator>& comm, int p, int k, bool areAlike)
      : comm_(comm), p_(p), k_(k), brick_(makeBrick(1.0 / (p * k))) {
    std::vector<Haptos::SubdomainInput> cubes;
    for (int c = 0; c < k * k * k; ++c)
      if (c % comm->getSize() == comm->getRank()) addCube({c % k, c / k % k, c / (k * k)}, areAlike ? 1.0 : 1 + 0.5 * std::sin(1.3 * c));
    for (const auto& cube : cubes_) {
      cubes.push_back({0, Teuchos::arrayViewFromVector(cube.nodes), Teuchos::arrayViewFromVector(cube.places), cube.K});
      for (std::size_t i = 0; i < cube.nodes.size(); ++i)
        for (int d = 0; d < 3; ++d)
          if (cube.places[3 * i] == 0) held_.push_back(3 * cube.nodes[i] + d);
    }
    const GlobalOrdinal nodes = GlobalOrdinal(p * k + 1) * (p * k + 1) * (p * k + 1), first = nodes * comm->getRank() / comm->getSize(),
                        last = nodes * (comm->getRank() + 1) / comm->getSize();
    const auto slabs = rcp(new Map(Tpetra::global_size_t(3 * nodes), std::size_t(3 * (last - first)), 0, comm));  // not as the cubes are dealt
    subdomains = rcp(new Haptos::SubdomainMatrix(comm, cubes, held_, slabs));
    merge();
    fillVectors();
  }

  RCP<Haptos::SubdomainMatrix> subdomains;
  RCP<CrsMatrix> merged;
  RCP<Vector> load;
  RCP<MultiVector> motions;  // rigid ones, for multigrid

  void scale(double factor) {
    for (const auto& cube : cubes_) {
      cube.K->resumeFill();
      cube.K->scale(factor);
      cube.K->fillComplete();
    }
  }

 private:
  struct Cube {
    double factor;  // of the stiffness
    std::vector<GlobalOrdinal> nodes;
    std::vector<double> places;
    std::vector<std::array<int, 8>> elements;  // local nodes
    RCP<CrsMatrix> K;
  };

  void addCube(const std::array<int, 3>& at, double factor) {
    Cube cube;
    cube.factor = factor;
    const int n = p_ + 1, all = p_ * k_ + 1;
    const auto local = [&](int i, int j, int l) { return (l * n + j) * n + i; };
    for (int l = 0; l < n; ++l)
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const std::array<int, 3> g = {at[0] * p_ + i, at[1] * p_ + j, at[2] * p_ + l};
          cube.nodes.push_back((GlobalOrdinal(g[2]) * all + g[1]) * all + g[0]);
          for (int d = 0; d < 3; ++d) cube.places.push_back(double(g[d]) / (all - 1));
          if (i == p_ || j == p_ || l == p_) continue;
          cube.elements.emplace_back();
          for (int b = 0; b < 8; ++b) cube.elements.back()[b] = local(i + (b & 1), j + (b >> 1 & 1), l + (b >> 2));
        }
    const auto self = rcp(new Map(Tpetra::global_size_t(3 * cube.nodes.size()), 0, rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF))));
    cube.K = rcp(new CrsMatrix(self, 192));
    assemble(cube, *cube.K, [](int node) { return GlobalOrdinal(node); });
    cube.K->fillComplete();
    cubes_.push_back(std::move(cube));
  }

  template <class Number>
  void assemble(const Cube& cube, CrsMatrix& K, Number&& number) const {
    const Eigen::Matrix<double, 24, 24> brick = cube.factor * brick_;
    for (const auto& element : cube.elements) {
      std::array<GlobalOrdinal, 24> unknowns;
      for (int i = 0; i < 24; ++i) unknowns[i] = 3 * number(element[i / 3]) + i % 3;
      for (int i = 0; i < 24; ++i) K.insertGlobalValues(unknowns[i], 24, brick.col(i).data(), unknowns.data());
    }
  }

  bool isHeld(GlobalOrdinal unknown) const { return unknown / 3 % (p_ * k_ + 1) == 0; }

  // Rows and columns of supports become those of the identity.
  void merge() {
    const auto map = subdomains->getDomainMap();
    merged = rcp(new CrsMatrix(map, 320));
    for (const auto& cube : cubes_) assemble(cube, *merged, [&](int node) { return cube.nodes[node]; });
    merged->fillComplete();
    merged->resumeFill();
    const auto columns = merged->getColMap();
    const auto K = merged->getLocalMatrixHost();
    for (std::size_t i = 0; i + 1 < K.graph.row_map.extent(0); ++i)
      for (auto e = K.graph.row_map(i); e < K.graph.row_map(i + 1); ++e) {
        const GlobalOrdinal row = map->getGlobalElement(int(i)), column = columns->getGlobalElement(K.graph.entries(e));
        if (isHeld(row) || isHeld(column)) K.values(e) = row == column ? 1.0 : 0.0;
      }
    merged->fillComplete();
  }

  void fillVectors() {
    const auto map = subdomains->getDomainMap();
    load = rcp(new Vector(map));
    motions = rcp(new MultiVector(map, 6));
    const auto f = load->getDataNonConst(0);
    const GlobalOrdinal all = p_ * k_ + 1;
    for (int i = 0; i < int(f.size()); ++i) {
      const GlobalOrdinal unknown = map->getGlobalElement(i), node = unknown / 3;
      const int d = int(unknown % 3);
      f[i] = isHeld(unknown) ? 0.0 : d == 2 ? -1e-3 / double(all) : 2e-4 / double(all);
      const double x[3] = {double(node % all), double(node / all % all), double(node / (all * all))};
      motions->replaceLocalValue(i, d, 1.0);
      motions->replaceLocalValue(i, 3 + (d + 1) % 3, x[(d + 2) % 3]);
      motions->replaceLocalValue(i, 3 + (d + 2) % 3, -x[(d + 1) % 3]);
    }
  }

  RCP<const Haptos::Communicator> comm_;
  int p_, k_;
  Eigen::Matrix<double, 24, 24> brick_;
  std::vector<Cube> cubes_;
  std::vector<GlobalOrdinal> held_;
};

double seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }
double tolerance = 1e-12;

struct Result {
  RCP<Vector> x;
  int iterations = 0;
  double setUp = 0, solve = 0;
  bool converged = false;
};

using Solver = RCP<Thyra::LinearOpWithSolveFactoryBase<double>>;

Solver makeSolver(const std::string& file, const Block& block) {
  const auto list = Teuchos::getParametersFromXmlFile(file);
  if (list->get<std::string>("Preconditioner Type", "None") == "MueLu")
    list->sublist("Preconditioner Types").sublist("MueLu").set("Nullspace", block.motions);
  Stratimikos::DefaultLinearSolverBuilder builder;
  Stratimikos::enableMueLu(builder);
  Stratimikos::enableHaptos(builder);
  builder.setParameterList(list);
  return builder.createLinearSolveStrategy("");
}

RCP<const Thyra::LinearOpBase<double>> wrap(const RCP<const Haptos::Operator>& A) {
  const auto space = Thyra::createVectorSpace<double>(A->getDomainMap());
  return Thyra::constTpetraLinearOp<double>(space, space, A);
}

Result solve(const Thyra::LinearOpWithSolveBase<double>& inverse, const Block& block) {
  Result result;
  result.x = rcp(new Vector(block.load->getMap()));
  const auto space = inverse.domain();
  const auto x = Thyra::createVector<double>(result.x, space);
  const auto b = Thyra::createConstVector<double>(RCP<const Vector>(block.load), space);
  const double start = seconds();
  const Thyra::SolveCriteria<double> criteria({Thyra::SOLVE_MEASURE_NORM_RESIDUAL, Thyra::SOLVE_MEASURE_NORM_RHS}, tolerance);
  const auto status = inverse.solve(Thyra::NOTRANS, *b, x.ptr(), Teuchos::constPtr(criteria));
  result.solve = seconds() - start;
  result.converged = status.solveStatus == Thyra::SOLVE_STATUS_CONVERGED;
  if (!status.extraParameters.is_null()) result.iterations = status.extraParameters->get<int>("Iteration Count", 0);
  return result;
}

double difference(const Vector& a, const Vector& b) {
  Vector d(a, Teuchos::Copy);
  d.update(-1.0, b, 1.0);
  return d.normInf() / b.normInf();
}

bool isHaptos(const std::string& file) { return file.find("haptos") != std::string::npos; }

Result run(const std::string& file, const Block& block) {
  const auto factory = makeSolver(file, block);
  const double start = seconds();
  RCP<const Haptos::Operator> A = block.merged;
  if (isHaptos(file)) A = block.subdomains;
  const auto inverse = Thyra::linearOpWithSolve(*factory, wrap(A));
  const double setUp = seconds() - start;
  Result result = solve(*inverse, block);
  result.setUp = setUp;
  return result;
}

int failures = 0;
void check(bool holds, const std::string& what) {
  if (holds) return;
  ++failures;
  std::fprintf(stderr, "%s\n", what.c_str());
}

std::string refusal(const Solver& factory, const RCP<const Haptos::Operator>& A) {
  try {
    Thyra::linearOpWithSolve(*factory, wrap(A));
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

// The operator is the merged matrix; other values are taken; a merged matrix is refused, and the next one is not.
void tryRest(const std::string& file, Block& block, const Vector& x) {
  Vector a(x.getMap()), b(x.getMap());
  block.merged->apply(*block.motions->getVector(3), a);
  block.subdomains->apply(*block.motions->getVector(3), b);
  check(difference(a, b) < 1e-13, "the operator is not the merged matrix");
  const auto factory = makeSolver(file, block), other = makeSolver(file, block);
  check(refusal(factory, block.merged).find("FROSch") != std::string::npos, "a merged matrix is not refused: " + refusal(factory, block.merged));
  other->getNonconstParameterList()->sublist("Solver").set("Relative Tolerence", 1e-3);
  check(refusal(other, block.subdomains).find("Relative Tolerance") != std::string::npos, "a wrong name is not refused");
  const auto source = Thyra::defaultLinearOpSource<double>(wrap(block.subdomains));
  const auto inverse = factory->createOp(), second = factory->createOp();
  factory->initializeOp(source, inverse.get(), Thyra::SUPPORT_SOLVE_UNSPECIFIED);
  check(difference(*solve(*inverse, block).x, x) < 1e-10, "after an error");
  block.scale(2);
  factory->initializeOp(source, inverse.get(), Thyra::SUPPORT_SOLVE_UNSPECIFIED);
  factory->initializeOp(source, second.get(), Thyra::SUPPORT_SOLVE_UNSPECIFIED);  // two at once
  for (const auto& op : {inverse, second, inverse}) {
    Result stiff = solve(*op, block);
    stiff.x->scale(2);
    check(stiff.converged && difference(*stiff.x, x) < 1e-10, "other values");
  }
}

}  // namespace

int main(int argc, char* argv[]) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  const auto world = Tpetra::getDefaultComm();
  const auto comm = world->split(world->getRank() < 2 ? 0 : -1, world->getRank());  // the others have something else to do
  if (comm.is_null()) return 0;
  int p = 4, k = 2;
  bool areAlike = false;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--bricks") p = std::stoi(argv[++i]);
    else if (argument == "--cubes") k = std::stoi(argv[++i]);
    else if (argument == "--tolerance") tolerance = std::stod(argv[++i]);
    else if (argument == "--alike") areAlike = true;
    else files.push_back(argument);
  }
  Block block(comm, p, k, areAlike);
  RCP<Vector> first;
  for (const auto& file : files) {
    const Result result = run(file, block);
    if (first.is_null()) first = result.x;
    const double distance = difference(*result.x, *first);
    check(result.converged && distance < 1e3 * tolerance, file + " does not find the same");
    if (comm->getRank() == 0)
      std::printf("%-12s %4d iterations, %6.2f s to set up, %6.2f s to solve, %.1e from the first\n",
                  file.substr(file.find_last_of('/') + 1).c_str(), result.iterations, result.setUp, result.solve, distance);
    if (isHaptos(file) && p * k <= 16) tryRest(file, block, *result.x);
  }
  if (comm->getRank() == 0) std::printf("%d unknowns on %d ranks: %d failures\n", int(first->getGlobalLength()), comm->getSize(), failures);
  return failures != 0 || files.empty();
}
