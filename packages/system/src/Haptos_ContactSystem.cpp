// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactSystem.hpp"

#include <Teuchos_Comm.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>
#include <map>

#include "Haptos_Error.hpp"
#include "Haptos_FetiSystem.hpp"
#include "Haptos_OptionTable.hpp"
#include "Haptos_PairLaws.hpp"
#include "Haptos_ParameterValue.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SystemChecks.hpp"
#include "Haptos_SystemInput.hpp"

namespace Haptos {
namespace {

using Teuchos::ArrayView;
using Teuchos::ParameterList;

constexpr int kComponents = 3;

template <class Options>
Options readSublist(const ParameterList& list, const std::string& name, const std::vector<std::string>& sublists = {}) {
  if (!list.isSublist(name)) return {};
  const ParameterList& own = list.sublist(name);
  std::vector<std::string> known = sublists;
  for (const auto& option : Options::table()) known.push_back(option.spec.name);
  requireKnownNames(own, known, name);
  return readOptions<Options>(own, name);
}

// The sublists of the program's input that a solve obeys, checked by the same tables.
SystemOptions readSystemOptions(const ParameterList& list) {
  requireKnownNames(list, {"Solver", "Local Solver", "Preconditioner", "Coarse Problem", "Decomposition"}, "");
  SystemOptions options;
  options.localSolver = readSublist<LocalSolverOptions>(list, "Local Solver");
  options.preconditioner = readSublist<PreconditionerOptions>(list, "Preconditioner");
  options.coarse = readSublist<CoarseOptions>(list, "Coarse Problem");
  options.solver = readSublist<SolverOptions>(list, "Solver", {"SMALSE"});
  if (list.isSublist("Solver")) options.solver.smalse = readSublist<SmalseOptions>(list.sublist("Solver"), "SMALSE");
  return options;
}

// Whether rows that are turned half way have the same stretch with both.
bool areProportional(const std::array<double, 2>& F, const std::array<double, 2>& G) {
  return F[0] * G[1] == F[1] * G[0] && (F[0] > 0) == (G[0] > 0) && (F[1] > 0) == (G[1] > 0);
}

// Which axes rows have, and which are left out, may depend on values that are prescribed and on the ratio of coefficients.  Collective.
bool areTurnedAlike(const Communicator& comm, const MultiplierMap& a, const MultiplierMap& b) {
  const auto isAlike = [](const LocalPair& p, const LocalPair& q) { return p.geometry.turn == q.geometry.turn && p.geometry.isPinned == q.geometry.isPinned; };
  return !anyOfAll(comm, !std::equal(a.pairs().begin(), a.pairs().end(), b.pairs().begin(), b.pairs().end(), isAlike));
}

Coordinates coordinatesOf(ArrayView<const double> values) {
  Coordinates result(std::size_t(values.size()) / 3);
  for (std::size_t i = 0; i < result.size(); ++i)
    for (int d = 0; d < kComponents; ++d) result[i][std::size_t(d)] = values[Teuchos::Ordinal(3 * i) + d];
  return result;
}

}  // namespace

struct ContactSystem::Impl {
  // What was given since the last set-up, by what has to be done again.
  struct Changes {
    bool stiffness = false, rows = false, values = false, laws = false;

    // Whether any rank changed something.  Collective.
    Changes ofAll(const Communicator& comm) const {
      const auto all = largestOfAll(comm, std::array<int, 4>{stiffness, rows, values, laws});
      return {all[0] != 0, all[1] != 0, all[2] != 0, all[3] != 0};
    }
  };

  RCP<const Communicator> comm;  // of this object alone
  SystemOptions options;
  DecompositionOptions decomposition;
  std::unique_ptr<SystemInput> input;
  std::string refused;  // what was wrong with an addition on this rank, told by the next Collective call
  Changes changes;
  std::unique_ptr<StepSolver> solver;
  RCP<const Vector> c, lambda;
  bool arePairsSolved = false;  // lambda is there, and of the pairs of this rank as they are
  long rows = 0;

  void refuse(const std::string& text) {
    if (refused.empty()) refused = text;
  }

  // Of rows that are gone.
  void forgetForces() {
    lambda = Teuchos::null;
    arePairsSolved = false;
  }

  void changePairs() {
    changes.rows = true;
    arePairsSolved = false;
  }

  // Rows may be made only for their right-hand sides: the system keeps its own, which are the same but for c.
  void takeRows(const RCP<const MultiplierMap>& rowsOfToday) {
    const auto vector = Teuchos::rcp(new Vector(solver->system().model().multipliers->map()));
    // Changed gaps or prescribed values never change the number of rows; what does is marked as a change of rows.
    TEUCHOS_ASSERT(rowsOfToday->c().size() == vector->getLocalLength());
    const auto data = vector->getDataNonConst(0);
    std::copy(rowsOfToday->c().begin(), rowsOfToday->c().end(), data.begin());
    c = vector;
  }

  void start() {
    // Kept only when all checks passed: after a refusal the next call begins again with what was added since.
    auto fresh = std::make_unique<StepSolver>(input->deal(decomposition), options, StepSolver::Observer{});
    fresh->prepare();
    solver = std::move(fresh);
    ++rows;
    takeRows(solver->system().model().multipliers);
  }

  // A system that was half renewed when something went wrong is made anew by the next call, and has no forces until then.
  template <class Work>
  void renew(Work&& work) {
    try {
      work();
    } catch (...) {
      solver.reset();
      forgetForces();
      throw;
    }
  }

  // Row by row the table of the class: the dearest change that there was decides.
  void update(const Changes& what) {
    if (what.stiffness) input->readStiffness();
    if (what.laws) {
      input->checkInterfaces();
      solver->setFriction(input->names(), input->friction());
    }
    if (what.stiffness || what.rows || what.values) {
      const auto rowsOfToday = input->makeRows();
      const bool others = what.rows || !areTurnedAlike(*comm, *rowsOfToday, *solver->system().model().multipliers);
      if (others) forgetForces();
      const auto rowsAre = others ? StepSolver::Rows::Others : StepSolver::Rows::Same;
      if (what.stiffness) renew([&] { solver->renewStiffness(input->stiffness(), rowsOfToday, rowsAre); });
      else if (others) renew([&] { solver->renewRows(rowsOfToday); });
      rows += what.stiffness || others;
      takeRows(rowsOfToday);
    }
  }
};

ContactSystem::ContactSystem(const RCP<const Communicator>& comm, const RCP<const ParameterList>& parameters) : impl_(std::make_unique<Impl>()) {
  // Messages of this system never meet those of the application or of another system.
  if (comm.is_null()) throw InputError("A system needs a communicator; the one that was given is null.");
  impl_->comm = comm->duplicate();
  impl_->input = std::make_unique<SystemInput>(impl_->comm);
  if (parameters.is_null()) return;
  impl_->options = readSystemOptions(*parameters);
  impl_->decomposition = readSublist<DecompositionOptions>(*parameters, "Decomposition");
}

ContactSystem::ContactSystem(SystemModel model, SystemOptions options, StepSolver::Observer observer) : impl_(std::make_unique<Impl>()) {
  impl_->comm = model.comm;
  impl_->solver = std::make_unique<StepSolver>(std::move(model), std::move(options), std::move(observer));
}

ContactSystem::~ContactSystem() = default;

int ContactSystem::addInterface(std::string name, const FrictionSpec& friction) {
  impl_->input->interfaces.push_back({std::move(name), friction});
  impl_->changePairs();
  impl_->changes.laws = true;  // its name and law come before its rows
  return int(impl_->input->interfaces.size()) - 1;
}

// Views may be gone after the call, so all but the matrix is copied here, and what can be seen here is looked at.
bool ContactSystem::addSubdomain(const SubdomainInput& subdomain) {
  const auto refuse = [&](const std::string& text) {
    impl_->refuse(text);
    return false;
  };
  SystemInput::Subdomain sub{subdomain.body, {}, {}};
  sub.ids.assign(subdomain.nodes.begin(), subdomain.nodes.end());
  const std::string who = "A subdomain of body " + std::to_string(subdomain.body);
  const auto rows = 3 * subdomain.nodes.size();
  if (impl_->solver) return refuse(who + " is added after setUp; other subdomains are another system.");
  if (subdomain.body < 0) return refuse(who + " is given; bodies are numbered from 0.");
  if (subdomain.coordinates.size() != rows)
    return refuse(who + " has " + std::to_string(subdomain.nodes.size()) + " nodes and " +
                  std::to_string(subdomain.coordinates.size()) + " coordinates; each has three.");
  if (subdomain.kernel.size() % std::max<Teuchos::Ordinal>(rows, 1) != 0)
    return refuse(who + " has a kernel whose columns are not of its " + std::to_string(rows) + " unknowns.");
  std::vector<std::int64_t> sorted = sub.ids;
  std::sort(sorted.begin(), sorted.end());
  const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
  if (twice != sorted.end()) return refuse(who + " has node " + std::to_string(*twice) + " twice.");
  for (const auto id : sorted)
    if (id < 0 || id > kLargestId)
      return refuse(who + " has node " + std::to_string(id) + "; ids must be >= 0 and at most " + std::to_string(kLargestId) + ".");
  sub.part.coordinates = coordinatesOf(subdomain.coordinates);
  for (const auto& x : sub.part.coordinates)
    if (!std::all_of(x.begin(), x.end(), isUsable)) return refuse(who + " has a coordinate that is not finite, or beyond 1e100.");
  sub.part.K = subdomain.K;
  if (subdomain.kernel.size() > 0)
    sub.part.kernel = Eigen::Map<const Eigen::MatrixXd>(subdomain.kernel.getRawPtr(), rows, subdomain.kernel.size() / rows);
  impl_->input->subdomains.push_back(std::move(sub));
  return true;
}

void ContactSystem::addNodes(ArrayView<const GlobalOrdinal> nodes, ArrayView<const double> coordinates) {
  if (coordinates.size() != 3 * nodes.size())
    return impl_->refuse(std::to_string(nodes.size()) + " nodes come with " + std::to_string(coordinates.size()) + " coordinates; each has three.");
  const Coordinates places = coordinatesOf(coordinates);
  for (std::size_t i = 0; i < places.size(); ++i)
    if (!std::all_of(places[i].begin(), places[i].end(), isUsable))
      return impl_->refuse("Node " + std::to_string(nodes[Teuchos::Ordinal(i)]) + " has a coordinate that is not finite, or beyond 1e100.");
  for (Teuchos::Ordinal i = 0; i < nodes.size(); ++i) impl_->input->places[nodes[i]] = places[std::size_t(i)];
}

int ContactSystem::addElement(int body, ArrayView<const GlobalOrdinal> nodes, ArrayView<const double> Ke) {
  const auto refuse = [&](const std::string& text) {
    impl_->refuse(text);
    return -1;
  };
  ElementMatrix element{body, {nodes.begin(), nodes.end()}, {Ke.begin(), Ke.end()}, {}};
  const std::string who = "An element of body " + std::to_string(body);
  if (impl_->solver) return refuse(who + " is added after setUp; other elements are another system.");
  if (body < 0) return refuse(who + " is given; bodies are numbered from 0.");
  if (Ke.size() != 9 * nodes.size() * nodes.size())
    return refuse(who + " with " + std::to_string(nodes.size()) + " nodes has a matrix of " + std::to_string(Ke.size()) +
                         " entries; it must have " +
                         std::to_string(9 * nodes.size() * nodes.size()) + ".");
  for (auto node : nodes) {
    const auto place = impl_->input->places.find(node);
    if (place == impl_->input->places.end() || node < 0 || node > kLargestId)
      return refuse(who + " has node " + std::to_string(node) + ", whose place was not given on this rank: call addNodes first, with ids >= 0 and at most " +
                    std::to_string(kLargestId) + ".");
    // Copied now: the cutter needs them after the caller's arrays are gone.
    element.places.push_back(place->second);
  }
  impl_->input->elements.push_back(std::move(element));
  return int(impl_->input->elements.size()) - 1;
}

void ContactSystem::setElement(int element, ArrayView<const double> Ke) {
  auto& elements = impl_->input->elements;
  const std::string who = "A matrix for element " + std::to_string(element) + " of this rank";
  if (element < 0 || element >= int(elements.size()))
    return impl_->refuse(who + " is given; it added " + std::to_string(elements.size()) + ", numbered from 0.");
  auto& K = elements[std::size_t(element)].K;
  if (std::size_t(Ke.size()) != K.size())
    return impl_->refuse(who + " has " + std::to_string(Ke.size()) + " entries; it must have " + std::to_string(K.size()) + ".");
  K.assign(Ke.begin(), Ke.end());
  impl_->changes.stiffness = true;
}

void ContactSystem::prescribe(GlobalOrdinal node, int component, double value) {
  if (component < 0 || component >= kComponents || !isUsable(value))
    return impl_->refuse("Component " + std::to_string(component) + " of node " + std::to_string(node) + " is prescribed as " + numberText(value) +
                         "; components are 0, 1, 2 and values finite, at most 1e100.");
  const auto [at, isNew] = impl_->input->prescribed.insert_or_assign({std::int64_t(node), component}, value);
  // Another value at a support moves c alone; a support more is a row more.
  (isNew ? impl_->changes.rows : impl_->changes.values) = true;
}

void ContactSystem::clearPrescribed() {
  impl_->input->prescribed.clear();
  impl_->changes.rows = true;
}

int ContactSystem::addPair(const PairInput& pair) {
  impl_->input->pairs.push_back(pair);
  impl_->changePairs();
  return int(impl_->input->pairs.size()) - 1;
}

void ContactSystem::clearPairs() {
  impl_->input->pairs.clear();
  impl_->changePairs();
}

void ContactSystem::setGap(int pair, double gap) {
  if (pair < 0 || pair >= int(impl_->input->pairs.size()))
    return impl_->refuse("A gap is given for pair " + std::to_string(pair) + "; this rank added " + std::to_string(impl_->input->pairs.size()) +
                         ", numbered from 0.");
  impl_->input->pairs[std::size_t(pair)].gap = gap;
  impl_->changes.values = true;
}

// Rows where tangential or tied ones come or go; laws in any case.
void ContactSystem::setFriction(int interface, const FrictionSpec& friction) {
  if (interface < 0 || interface >= int(impl_->input->interfaces.size()))
    return impl_->refuse("Friction is given for interface " + std::to_string(interface) + "; there are " +
                         std::to_string(impl_->input->interfaces.size()) + ", numbered from 0.");
  FrictionSpec& own = impl_->input->interfaces[std::size_t(interface)].friction;
  const InterfaceRows before = interfaceRows("", own), after = interfaceRows("", friction);
  Impl::Changes& changes = impl_->changes;
  changes.rows = changes.rows || before.tied != after.tied || before.frictional != after.frictional;
  changes.values = changes.values || !areProportional(own.coefficients, friction.coefficients);
  changes.laws = true;  // read anew with rows, too
  own = friction;
}

void ContactSystem::updateStiffness() {
  if (!impl_->input->elements.empty())
    impl_->refuse("updateStiffness is for matrices that are shared; elements were copied: give theirs to setElement.");
  impl_->changes.stiffness = true;
}

void ContactSystem::setTolerance(double tolerance) {
  if (!(tolerance > 0 && std::isfinite(tolerance)))
    return impl_->refuse("The relative tolerance is " + std::to_string(tolerance) + "; it must be > 0.");
  impl_->options.solver.tolerance = tolerance;
  if (impl_->solver) impl_->solver->setTolerance(tolerance);
}

// Additions are local and cannot throw on one rank alone: what was wrong with them is told here, on all.
void ContactSystem::setUp() {
  const std::string refused = std::exchange(impl_->refused, "");
  runOnAllRanks(*impl_->comm, [&] {
    if (!refused.empty()) throw InputError(refused);
  });
  if (!impl_->solver) impl_->start();
  else impl_->update(impl_->changes.ofAll(*impl_->comm));
  impl_->changes = {};
}

// Of ids, not of numbers: a caller finds its own nodes in it.
RCP<const Map> ContactSystem::map() const { return impl_->input->map(); }

// Callers see one displacement a node, the solver copies of it: loads are shared among them, and their means come back.
ContactSystem::Outcome ContactSystem::solve(const Vector& f, Vector& u) {
  setUp();
  const bool fits = f.getMap()->isSameAs(*map()) && u.getMap()->isSameAs(*map());
  runOnAllRanks(*impl_->comm, [&] {
    if (!fits) throw InputError("Loads and displacements of a system must lie on its map().");
    for (double value : f.getData(0))
      if (!isUsable(value)) throw InputError("A load is not finite, or beyond 1e100.");
  });
  const auto& system = impl_->solver->system();
  const StepData step{impl_->input->spread(f, system.jump().getDomainMap()), impl_->c, impl_->input->prescribedHere()};
  const StepResult result = impl_->solver->solve(step);
  impl_->input->average(*result.u, u);
  impl_->lambda = result.dual.lambda;
  impl_->arePairsSolved = true;
  return {result.solved, result.reason, result.method, result.accuracy.errors.kkt(), result.multiplications};
}

RCP<const Vector> ContactSystem::multipliers() const { return impl_->lambda; }

// Rows lie where nodes lie; forces go back to the rank that added the pair, whose positions in an interface are one range.
std::vector<std::array<double, 3>> ContactSystem::contactForces() const {
  if (anyOfAll(*impl_->comm, !impl_->arePairsSolved))
    throw InputError("Contact forces are those of the last solve; nothing is solved yet, or pairs, supports or kinds of laws are others since: call solve first.");
  const SystemInput& input = *impl_->input;
  const Communicator& comm = *impl_->comm;
  struct Force {
    int interface, position;
    std::array<double, 3> value;
  };
  const auto& multipliers = *impl_->solver->system().model().multipliers;
  const auto& laws = impl_->solver->system().law().pairs();
  const auto lambda = impl_->lambda->getData(0);
  std::vector<Force> mine;
  for (std::size_t i = 0; i < laws.size(); ++i) {
    const LocalPair& pair = multipliers.pairs()[i];
    std::array<double, 3> force = ContactLaw::gather(laws[i], lambda.getRawPtr());
    if (const auto& turn = pair.geometry.turn) {
      const auto inAxes = turn->toAxes(force[1], force[2]);
      force = {force[0], inAxes[0], inAxes[1]};  // those of the caller
    }
    mine.push_back({pair.interface, pair.pair, force});
  }
  for (const TiedPair& pair : multipliers.tiedPairs()) {  // rows along x, y, z
    const LocalFrame& frame = pair.geometry.frame;
    std::array<double, 3> sum{0, 0, 0};
    for (std::size_t d = 0; d < 3; ++d)
      if (pair.rows[d] >= 0) sum[d] = lambda[pair.rows[d]];
    mine.push_back({pair.interface, pair.pair, {Vec3::dot(sum, frame.normal), Vec3::dot(sum, frame.t1), Vec3::dot(sum, frame.t2)}});
  }
  // The rank that added a pair, by the first positions of all ranks.
  const std::size_t interfaces = input.interfaces.size();
  const auto first = gatheredOnAll(comm, input.firstOfInterface());  // [ranks][interfaces]
  const auto rankOf = [&](const Force& force) {
    int rank = comm.getSize() - 1;
    // From the last: ranks without pairs share the first position of those above them.
    while (first[std::size_t(rank) * interfaces + std::size_t(force.interface)] > force.position) --rank;
    return rank;
  };
  std::map<std::pair<int, int>, std::array<double, 3>> forces;
  for (const Force& force : sendItems(comm, mine, rankOf)) forces[{force.interface, force.position}] = force.value;
  std::vector<std::array<double, 3>> result;
  // The same count as in `placePairs`, in the same order.
  std::vector<int> next = input.firstOfInterface();
  for (const auto& pair : input.pairs) result.push_back(forces[{pair.interface, next[std::size_t(pair.interface)]++}]);
  return result;
}

ContactSystem::Counters ContactSystem::counters() const {
  const long mine = impl_->solver ? impl_->solver->factorizations() : 0;
  return {sumOfAll(*impl_->comm, mine), impl_->solver ? impl_->solver->multiplications() : 0, impl_->rows};
}

StepSolver& ContactSystem::solver() { return *impl_->solver; }
const StepSolver& ContactSystem::solver() const { return *impl_->solver; }

}  // namespace Haptos
