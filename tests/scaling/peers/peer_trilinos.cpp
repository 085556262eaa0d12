// SPDX-License-Identifier: BSD-3-Clause
// Solvers of Trilinos and Haptos on the two beams bonded, through Stratimikos, one core:
//   peer_trilinos beams.xml [OPTIONS OF HAPTOS] -- n FILE.xml...
// Every file has Stratimikos' parameters of one solver; they run in turns, `n` times.  Solvers of merged matrices get the merged
// matrix, Haptos its subdomains.  Prints a line of JSON a solver: medians of the processor's seconds and the least of both together,
// iterations, true residual.
#include <Haptos_CommandLine.hpp>
#include <Haptos_DistributedModel.hpp>
#include <Haptos_ElasticStiffness.hpp>
#include <Haptos_NodalLoads.hpp>
#include <Haptos_Parameters.hpp>
#include <Haptos_Stratimikos.hpp>
#include <Haptos_SubdomainMatrix.hpp>
#include <Stratimikos_MueLuHelpers.hpp>
#ifdef PEER_FROSCH
#include <Stratimikos_FROSch_def.hpp>
#endif
#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_XMLParameterListHelpers.hpp>
#include <Thyra_LinearOpWithSolveFactoryHelpers.hpp>
#include <Thyra_TpetraThyraWrappers.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace {

using namespace Haptos;
using Teuchos::RCP;
using Teuchos::rcp;

/// The model of the input with its bodies bonded: nodes at one place are one.
class Bonded {
 public:
  Bonded(const RCP<const Communicator>& comm, const RunOptions& options) {
    RunClock clock;
    model_ = distributeModel(comm, options, nullptr, clock);
    numberNodes();
    takeSubdomains();
    const auto map = rcp(new Map(Tpetra::global_size_t(3 * place_.size()), 0, comm));
    subdomains = rcp(new SubdomainMatrix(comm, inputs_, {held_.begin(), held_.end()}, map));
    merge(map);
    fillVectors(map);
  }

  RCP<SubdomainMatrix> subdomains;
  RCP<CrsMatrix> merged;
  RCP<Vector> load;
  RCP<MultiVector> motions;  // rigid ones, for multigrid
  int count() const { return int(inputs_.size()); }

 private:
  void numberNodes() {
    std::map<std::array<double, 3>, GlobalOrdinal> numbers;
    std::map<std::int64_t, GlobalOrdinal> numberOf;
    for (const auto& sub : model_.subdomains) {
      nodes_.emplace_back();
      for (int i = 0; i < sub.numNodes(); ++i) {
        const auto number = numbers.emplace(sub.coordinates[std::size_t(i)], GlobalOrdinal(numbers.size())).first->second;
        nodes_.back().push_back(numberOf[sub.nodes[std::size_t(i)]] = number);
      }
    }
    place_.resize(numbers.size());
    for (const auto& [x, number] : numbers) place_[std::size_t(number)] = x;
    for (const auto& value : model_.prescribed) held_.insert(3 * numberOf.at(value.node) + value.component);
  }

  void takeSubdomains() {
    const ElasticStiffness stiffness(model_.subdomains, model_.data.materials, model_.data.formulation);
    const auto self = rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
    for (int s = 0; s < stiffness.size(); ++s) {
      const auto K = stiffness.assemble(s);
      const auto map = rcp(new Map(Tpetra::global_size_t(K.rows()), 0, self));
      const auto matrix = rcp(new CrsMatrix(map, 81));
      for (int j = 0; j < K.cols(); ++j)
        for (Eigen::SparseMatrix<double>::InnerIterator it(K, j); it; ++it)
          matrix->insertGlobalValues(it.row(), Teuchos::tuple<GlobalOrdinal>(j), Teuchos::tuple(it.value()));
      matrix->fillComplete();
      matrices_.push_back(matrix);
      const auto& sub = model_.subdomains[std::size_t(s)];
      coordinates_.push_back({});
      for (const auto& x : sub.coordinates) coordinates_.back().insert(coordinates_.back().end(), x.begin(), x.end());
    }
    for (std::size_t s = 0; s < matrices_.size(); ++s)
      inputs_.push_back({0, Teuchos::arrayViewFromVector(nodes_[s]), Teuchos::arrayViewFromVector(coordinates_[s]), matrices_[s]});
  }

  // Rows and columns of supports become those of the identity.
  void merge(const RCP<const Map>& map) {
    merged = rcp(new CrsMatrix(map, 320));
    for (std::size_t s = 0; s < matrices_.size(); ++s) {
      const auto K = matrices_[s]->getLocalMatrixHost();
      const auto global = [&](int local) { return 3 * nodes_[s][std::size_t(local / 3)] + local % 3; };
      for (int i = 0; i < K.numRows(); ++i)
        for (auto e = K.graph.row_map(i); e < K.graph.row_map(i + 1); ++e) {
          const GlobalOrdinal row = global(i), column = global(int(matrices_[s]->getColMap()->getGlobalElement(K.graph.entries(e))));
          const bool isHeld = held_.count(row) > 0 || held_.count(column) > 0;
          if (!isHeld) merged->insertGlobalValues(row, Teuchos::tuple(column), Teuchos::tuple(K.values(e)));
        }
    }
    for (const GlobalOrdinal row : held_) merged->insertGlobalValues(row, Teuchos::tuple(row), Teuchos::tuple(1.0));
    merged->fillComplete();
  }

  Eigen::VectorXd loadsOf(const Subdomain& sub) const {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(sub.numDofs());
    for (const auto& load : model_.data.loads)
      for (int g = 0; g < int(sub.groups.size()); ++g) {
        std::vector<GroupSide> sides;
        for (const auto& side : sub.sides)
          if (side.group == g && std::count(load.sideSets.begin(), load.sideSets.end(), side.sideSet)) sides.push_back({side.element, side.side});
        const auto& group = sub.groups[std::size_t(g)];
        if (load.kind == Load::Kind::Pressure)
          addPressure(sub.coordinates, group, sides, [&](double x, double y, double z) { return load.pressure(x, y, z); }, f);
        else addTraction(sub.coordinates, group, sides, [&](double x, double y, double z) { return load.value(x, y, z); }, f);
      }
    return f;
  }

  void fillVectors(const RCP<const Map>& map) {
    load = rcp(new Vector(map));
    motions = rcp(new MultiVector(map, 6));
    for (std::size_t s = 0; s < nodes_.size(); ++s) {
      const Eigen::VectorXd f = loadsOf(model_.subdomains[s]);
      for (Eigen::Index i = 0; i < f.size(); ++i)
        if (const GlobalOrdinal row = 3 * nodes_[s][std::size_t(i / 3)] + i % 3; held_.count(row) == 0) load->sumIntoLocalValue(int(row), f[i]);
    }
    for (int node = 0; node < int(place_.size()); ++node)
      for (int d = 0; d < 3; ++d) {
        motions->replaceLocalValue(3 * node + d, std::size_t(d), 1.0);
        motions->replaceLocalValue(3 * node + (d + 1) % 3, std::size_t(3 + d), -place_[std::size_t(node)][std::size_t((d + 2) % 3)]);
        motions->replaceLocalValue(3 * node + (d + 2) % 3, std::size_t(3 + d), place_[std::size_t(node)][std::size_t((d + 1) % 3)]);
      }
  }

  DistributedModel model_;
  std::vector<std::vector<GlobalOrdinal>> nodes_;  // [subdomains]
  std::vector<std::array<double, 3>> place_;
  std::set<GlobalOrdinal> held_;
  std::vector<std::vector<double>> coordinates_;
  std::vector<RCP<CrsMatrix>> matrices_;
  std::vector<SubdomainInput> inputs_;
};

double seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

struct Runs {
  std::string file;
  std::vector<double> setUp, solve;
  int iterations = 0;
  double residual = 0, work = 0;
  bool converged = true;
};

RCP<Thyra::LinearOpWithSolveFactoryBase<double>> makeSolver(const std::string& file, const Bonded& beams) {
  const auto list = Teuchos::getParametersFromXmlFile(file);
  if (list->get<std::string>("Preconditioner Type", "None") == "MueLu")
    list->sublist("Preconditioner Types").sublist("MueLu").set("Nullspace", beams.motions);
  Stratimikos::DefaultLinearSolverBuilder builder;
  Stratimikos::enableMueLu(builder);
#ifdef PEER_FROSCH
  Stratimikos::enableFROSch<LocalOrdinal, GlobalOrdinal, Map::node_type>(builder);
#endif
  Stratimikos::enableHaptos(builder);
  builder.setParameterList(list);
  return builder.createLinearSolveStrategy("");
}

void run(const Bonded& beams, double tolerance, Runs& runs) {
  const auto factory = makeSolver(runs.file, beams);
  RCP<const Operator> A = beams.merged;
  if (runs.file.find("haptos") != std::string::npos) A = beams.subdomains;
  const double start = seconds();
  const auto space = Thyra::createVectorSpace<double>(A->getDomainMap());
  const RCP<const Thyra::LinearOpBase<double>> forward = Thyra::constTpetraLinearOp<double>(space, space, A);
  const auto inverse = Thyra::linearOpWithSolve(*factory, forward);
  const double middle = seconds();
  const auto x = rcp(new Vector(beams.load->getMap()));
  const Thyra::SolveCriteria<double> criteria({Thyra::SOLVE_MEASURE_NORM_RESIDUAL, Thyra::SOLVE_MEASURE_NORM_RHS}, tolerance);
  const auto status = inverse->solve(Thyra::NOTRANS, *Thyra::createConstVector<double>(RCP<const Vector>(beams.load), space),
                                     Thyra::createVector<double>(x, space).ptr(), Teuchos::constPtr(criteria));
  runs.solve.push_back(seconds() - middle);
  runs.setUp.push_back(middle - start);
  runs.converged = runs.converged && status.solveStatus == Thyra::SOLVE_STATUS_CONVERGED;
  if (!status.extraParameters.is_null()) runs.iterations = status.extraParameters->get<int>("Iteration Count", 0);
  Vector r(*beams.load, Teuchos::Copy);
  beams.merged->apply(*x, r, Teuchos::NO_TRANS, -1.0, 1.0);
  runs.residual = r.norm2() / beams.load->norm2();
  runs.work = beams.load->dot(*x);
}

// Of the run that is median in all: the two belong together.
void print(const Runs& runs, const Bonded& beams) {
  std::vector<std::size_t> order(runs.solve.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return runs.setUp[a] + runs.solve[a] < runs.setUp[b] + runs.solve[b]; });
  const auto median = order[order.size() / 2];
  std::printf("{\"solver\": \"%s\", \"unknowns\": %d, \"subdomains\": %d, \"setup\": %.3f, \"solve\": %.3f, \"least\": %.3f, "
              "\"iterations\": %d, \"residual\": %.2e, \"work\": %.10g, \"converged\": %s}\n",
              runs.file.substr(runs.file.find_last_of('/') + 1).c_str(), int(beams.load->getGlobalLength()), beams.count(), runs.setUp[median],
              runs.solve[median], runs.setUp[order.front()] + runs.solve[order.front()], runs.iterations, runs.residual, runs.work,
              runs.converged ? "true" : "false");
}

int work(const RCP<const Communicator>& comm, int argc, char* argv[]) {
  constexpr double kTolerance = 1e-6;
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto end = std::find(words.begin(), words.end(), "--");
  TEUCHOS_TEST_FOR_EXCEPTION(words.end() - end < 3 || comm->getSize() > 1, std::invalid_argument,
                             "beams.xml [OPTIONS OF HAPTOS] -- n FILE.xml..., on one rank");
  std::vector<Runs> all;
  for (auto file = end + 2; file != words.end(); ++file) all.push_back({*file, {}, {}});
  const Bonded beams(comm, runOptions(readParameters(*comm, parseCommandLine({words.begin(), end}))));
  for (int i = 0; i < std::stoi(*(end + 1)); ++i)
    for (auto& runs : all) run(beams, kTolerance, runs);
  bool converged = true;
  for (const auto& runs : all) {
    print(runs, beams);
    converged = converged && runs.converged;
  }
  return converged ? 0 : 2;
}

}  // namespace

int main(int argc, char* argv[]) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  try {
    return work(Tpetra::getDefaultComm(), argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "peer_trilinos: %s\n", error.what());
    return 1;
  }
}
