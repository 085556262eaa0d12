// SPDX-License-Identifier: BSD-3-Clause
#include <Kokkos_Core.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_ParameterList.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "Haptos_ContactSystem.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_GivenMatrix.hpp"
#include "Haptos_GivenPairs.hpp"
#include "Haptos_NodeValues.hpp"
#include "Haptos_ParameterXml.hpp"
#include "haptos.h"

namespace {

using namespace Haptos;

// Where there is no handle yet; of every thread, as two may create systems at a time.
thread_local std::string messageOfCreation;

}  // namespace

struct haptos_system {
  RCP<const Communicator> comm;  // of this system alone
  std::unique_ptr<ContactSystem> system;
  std::vector<GivenMatrix> matrices;  // of this rank's subdomains
  std::vector<int> nodesOfElement;
  std::vector<std::int64_t> loaded;
  std::vector<double> loads;
  std::int64_t pairs = 0;  // of this rank
  RCP<Vector> u;           // of the last solve
  std::string refused;  // by a local function, told by the next collective one
  std::string message;
};

namespace {

// The kinds of the driver's exit statuses, so that C callers and shell scripts read the same numbers.
int statusOf(const CaughtError& error) {
  switch (error.kind) {
    case 0: return HAPTOS_OK;
    case 1: return HAPTOS_INPUT_ERROR;
    case 2: return HAPTOS_NO_SOLUTION;
    default: return HAPTOS_INTERNAL_ERROR;
  }
}

// No exception passes through C.
template <class Work>
int guarded(std::string& message, Work&& work) {
  CaughtError error;
  try {
    work();
  } catch (...) {
    error = describeCurrentException();
  }
  message = error.message;
  return statusOf(error);
}

// What is wrong is told later, to all ranks: one alone would leave the others waiting.
template <class Work>
int local(haptos_system* system, Work&& work) {
  if (system == nullptr) return HAPTOS_INPUT_ERROR;
  return guarded(system->message, [&] {
    try {
      work(*system->system);
    } catch (const InputError& e) {
      if (system->refused.empty()) system->refused = e.what();
    }
  });
}

// Arguments may be wrong on one rank alone: `check` does not communicate, and all ranks hear of it before `work` does.
template <class Check, class Work>
int collective(haptos_system* system, Check&& check, Work&& work) {
  if (system == nullptr) return HAPTOS_INPUT_ERROR;
  return guarded(system->message, [&] {
    const std::string refused = std::exchange(system->refused, "");
    runOnAllRanks(*system->comm, [&] {
      require(refused.empty(), refused);
      check();
    });
    work(*system->system);
  });
}

template <class Work>
int collective(haptos_system* system, Work&& work) {
  return collective(system, [] {}, work);
}

template <class T>
Teuchos::ArrayView<const T> view(const T* data, std::int64_t size) {
  return {data, Teuchos::Ordinal(size)};
}

std::vector<GlobalOrdinal> idsOf(const std::int64_t* nodes, std::int64_t count) { return {nodes, nodes + count}; }

FrictionSpec frictionOf(const haptos_friction* given) {
  require(given != nullptr, "An interface comes without friction (NULL).");
  require(given->law >= HAPTOS_FRICTIONLESS && given->law <= HAPTOS_TIED,
          "The law of an interface is " + std::to_string(given->law) + "; laws are 0 (frictionless), 1 (Tresca), 2 (Coulomb) and 3 (tied).");
  FrictionSpec friction;
  friction.tied = given->law == HAPTOS_TIED;
  if (!friction.tied) friction.law = FrictionLaw(given->law);
  friction.coefficients = {given->coefficients[0], given->coefficients[1]};
  friction.slipBound = given->slip_bound;
  return friction;
}

// The numbers in haptos.h are part of the interface, those of the enum are not: they must not part unseen.
static_assert(int(FrictionLaw::Frictionless) == HAPTOS_FRICTIONLESS && int(FrictionLaw::Tresca) == HAPTOS_TRESCA &&
              int(FrictionLaw::Coulomb) == HAPTOS_COULOMB);

// Kokkos is the process's: whoever needs it first starts it, and it stays.
void startKokkos() {
  if (Kokkos::is_initialized()) return;
  Kokkos::initialize();
  std::atexit([] {
    if (Kokkos::is_initialized()) Kokkos::finalize();
  });
}

// For callers without MPI: what was started here ends with the process, what the caller started is the caller's to end.
void startMpi() {
  int flag = 0;
  MPI_Initialized(&flag);
  if (flag) return;
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  std::atexit([] {
    int done = 0;
    MPI_Finalized(&done);
    if (!done) MPI_Finalize();
  });
}

// Rank 0's text counts: what ranks were given must not differ, and a caller need not have read the file on all.
RCP<Teuchos::ParameterList> parametersOf(const Communicator& comm, const char* text) {
  int length = text == nullptr ? 0 : int(std::strlen(text));
  Teuchos::broadcast(comm, 0, Teuchos::outArg(length));
  std::string xml(std::size_t(length), ' ');
  if (comm.getRank() == 0 && length > 0) std::memcpy(xml.data(), text, xml.size());
  Teuchos::broadcast(comm, 0, length, xml.data());
  return Teuchos::parameterList(length > 0 ? parameterListFromXml(xml, "parameters") : Teuchos::ParameterList());
}

// Fields of a C struct have fixed lengths; what does not fit is cut, and the whole text is told by haptos_message.
void copyText(const std::string& text, char* to, std::size_t size) {
  const std::size_t length = std::min(text.size(), size - 1);
  std::memcpy(to, text.data(), length);
  to[length] = '\0';
}

haptos_outcome solve(haptos_system& own, ContactSystem& system) {
  // The map exists from here on, and with it the place of every load.
  system.setUp();
  Vector f(system.map());
  NodeValues(system.map(), own.loaded).sumInto(f, own.loads);
  const auto u = Teuchos::rcp(new Vector(system.map()));
  const auto found = system.solve(f, *u);
  own.u = u;
  haptos_outcome outcome{found.solved, found.multiplications, found.kkt, "", ""};
  copyText(found.method, outcome.method, sizeof outcome.method);
  copyText(found.reason, outcome.reason, sizeof outcome.reason);
  own.message = found.reason;
  return outcome;
}

void requireSolved(const haptos_system& system) { require(!system.u.is_null(), "Nothing is solved yet: call haptos_solve first."); }

}  // namespace

extern "C" {

int haptos_create(MPI_Comm comm, const char* parameters, haptos_system** system) {
  if (system == nullptr) return HAPTOS_INPUT_ERROR;
  *system = nullptr;
  return guarded(messageOfCreation, [&] {
    int flag = 0;
    MPI_Initialized(&flag);
    require(flag && comm != MPI_COMM_NULL, "MPI is not initialised, or the communicator is MPI_COMM_NULL.");
    startKokkos();
    auto fresh = std::make_unique<haptos_system>();
    // A communicator of its own: messages of two systems, or of the caller, never meet.
    fresh->comm = Teuchos::MpiComm<int>(comm).duplicate();
    fresh->system = std::make_unique<ContactSystem>(fresh->comm, parametersOf(*fresh->comm, parameters));
    *system = fresh.release();
  });
}

int haptos_create_fortran(MPI_Fint comm, const char* parameters, haptos_system** system) {
  int flag = 0;
  MPI_Initialized(&flag);
  // A Fortran handle may be read only between MPI_Init and MPI_Finalize.
  return haptos_create(flag ? MPI_Comm_f2c(comm) : MPI_COMM_NULL, parameters, system);
}

int haptos_create_serial(const char* parameters, haptos_system** system) {
  startMpi();
  return haptos_create(MPI_COMM_SELF, parameters, system);
}

int haptos_destroy(haptos_system** system) {
  if (system == nullptr) return HAPTOS_INPUT_ERROR;
  delete std::exchange(*system, nullptr);
  return HAPTOS_OK;
}

const char* haptos_message(const haptos_system* system) { return system == nullptr ? messageOfCreation.c_str() : system->message.c_str(); }

int haptos_add_interface(haptos_system* system, const char* name, const haptos_friction* friction, int* interface) {
  if (interface != nullptr) *interface = -1;
  return local(system, [&](ContactSystem& s) {
    const int number = s.addInterface(name == nullptr ? "" : name, frictionOf(friction));
    if (interface != nullptr) *interface = number;
  });
}

int haptos_add_subdomain(haptos_system* system, const haptos_subdomain* given, int* number) {
  if (number != nullptr) *number = -1;
  return local(system, [&](ContactSystem& s) {
    require(given != nullptr, "A subdomain is NULL.");
    requireArrays(given->kernel_columns, given->kernel != nullptr, "Columns of a subdomain's kernel", "values");
    GivenMatrix matrix = givenMatrix(*given);
    const auto ids = idsOf(given->nodes, given->num_nodes);
    const auto unknowns = 3 * std::int64_t(given->num_nodes);
    // One that was refused has no number: those of later ones are counted as the system counts them.
    if (!s.addSubdomain({given->body, Teuchos::arrayViewFromVector(ids), view(given->coordinates, unknowns), matrix.K,
                         view(given->kernel, unknowns * given->kernel_columns)}))
      return;
    system->matrices.push_back(std::move(matrix));
    if (number != nullptr) *number = int(system->matrices.size()) - 1;
  });
}

int haptos_add_nodes(haptos_system* system, int64_t count, const int64_t* nodes, const double* coordinates) {
  return local(system, [&](ContactSystem& s) {
    requireArrays(count, nodes && coordinates, "Nodes", "ids or coordinates");
    const auto ids = idsOf(nodes, count);
    s.addNodes(Teuchos::arrayViewFromVector(ids), view(coordinates, 3 * count));
  });
}

int haptos_add_elements(haptos_system* system, int body, int64_t count, int nodesPerElement, const int64_t* nodes, const double* Ke) {
  return local(system, [&](ContactSystem& s) {
    requireArrays(count, nodes && Ke, "Elements", "nodes or matrices");
    require(count == 0 || nodesPerElement > 0, "Elements come with " + std::to_string(nodesPerElement) + " nodes each; it must be > 0.");
    const std::int64_t size = 9 * std::int64_t(nodesPerElement) * nodesPerElement;
    for (std::int64_t e = 0; e < count; ++e, nodes += nodesPerElement, Ke += size) {
      const auto ids = idsOf(nodes, nodesPerElement);
      const int number = s.addElement(body, Teuchos::arrayViewFromVector(ids), view(Ke, size));
      // One that was refused has no number, and later ones close the gap.
      if (number >= 0) system->nodesOfElement.push_back(nodesPerElement);
    }
  });
}

int haptos_prescribe(haptos_system* system, int64_t count, const int64_t* nodes, const int* components, const double* values) {
  return local(system, [&](ContactSystem& s) {
    requireArrays(count, nodes && components && values, "Prescribed displacements", "nodes, components or values");
    for (std::int64_t i = 0; i < count; ++i) s.prescribe(nodes[i], components[i], values[i]);
  });
}

int haptos_clear_prescribed(haptos_system* system) {
  return local(system, [](ContactSystem& s) { s.clearPrescribed(); });
}

int haptos_add_pairs(haptos_system* system, const haptos_pairs* pairs) {
  return local(system, [&](ContactSystem& s) {
    require(pairs != nullptr, "Pairs are NULL.");
    requireArrays(pairs->count, pairs->secondary && pairs->normals, "Pairs", "secondary nodes or normals");
    requirePrimaryNodes(*pairs);
    for (int i = 0; i < pairs->count; ++i) system->pairs = s.addPair(pairOf(*pairs, i)) + 1;
  });
}

int haptos_clear_pairs(haptos_system* system) {
  return local(system, [&](ContactSystem& s) {
    s.clearPairs();
    system->pairs = 0;
  });
}

int haptos_set_loads(haptos_system* system, int64_t count, const int64_t* nodes, const double* forces) {
  return local(system, [&](ContactSystem&) {
    requireArrays(count, nodes && forces, "Loads", "nodes or forces");
    system->loaded.assign(nodes, nodes + count);
    system->loads.assign(forces, forces + 3 * count);
  });
}

int haptos_set_gaps(haptos_system* system, int count, const int* pairs, const double* gaps) {
  return local(system, [&](ContactSystem& s) {
    requireArrays(count, pairs && gaps, "Gaps", "pairs or values");
    for (int i = 0; i < count; ++i) s.setGap(pairs[i], gaps[i]);
  });
}

int haptos_set_friction(haptos_system* system, int interface, const haptos_friction* friction) {
  return local(system, [&](ContactSystem& s) { s.setFriction(interface, frictionOf(friction)); });
}

int haptos_set_stiffness(haptos_system* system, int subdomain, const double* values) {
  return local(system, [&](ContactSystem& s) {
    const int added = int(system->matrices.size());
    require(subdomain >= 0 && subdomain < added, "A stiffness is given for subdomain " + std::to_string(subdomain) + "; this rank added " +
                                                     std::to_string(added) + ", numbered from 0.");
    require(values != nullptr, "A stiffness comes without values (NULL).");
    system->matrices[std::size_t(subdomain)].take(values);
    s.updateStiffness();
  });
}

int haptos_set_elements(haptos_system* system, int64_t first, int64_t count, const double* Ke) {
  return local(system, [&](ContactSystem& s) {
    const auto added = std::int64_t(system->nodesOfElement.size());
    requireArrays(count, Ke != nullptr, "Elements", "matrices");
    require(first >= 0 && first <= added - count,
            "Matrices are given for " + std::to_string(count) + " elements from number " + std::to_string(first) + " on; this rank added " +
                std::to_string(added) + ", numbered from 0.");
    for (std::int64_t e = first; e < first + count; ++e) {
      const auto nodes = std::int64_t(system->nodesOfElement[std::size_t(e)]);
      s.setElement(int(e), view(Ke, 9 * nodes * nodes));
      Ke += 9 * nodes * nodes;
    }
  });
}

int haptos_set_up(haptos_system* system) {
  return collective(system, [](ContactSystem& s) { s.setUp(); });
}

int haptos_solve(haptos_system* system, haptos_outcome* outcome) {
  haptos_outcome found{};
  std::string reason;
  const int status = collective(system, [&](ContactSystem& s) {
    found = solve(*system, s);
    // `guarded` clears the message of what went well; why a solve did not converge is kept across it.
    reason = system->message;
  });
  if (outcome != nullptr) *outcome = found;
  if (status != HAPTOS_OK) return status;
  system->message = reason;
  return found.solved ? HAPTOS_OK : HAPTOS_NOT_CONVERGED;
}

int haptos_displacements(haptos_system* system, int64_t count, const int64_t* nodes, double* u) {
  const auto check = [&] {
    requireArrays(count, nodes && u, "Nodes whose displacements are asked for", "ids or a place for the values");
    requireSolved(*system);
  };
  return collective(system, check, [&](ContactSystem& s) { NodeValues(s.map(), {nodes, nodes + count}).read(*system->u, u); });
}

int haptos_contact_forces(haptos_system* system, double* forces) {
  const auto check = [&] {
    requireSolved(*system);
    require(forces != nullptr || system->pairs == 0,
            "Contact forces of " + std::to_string(system->pairs) + " pairs are asked for without a place for them (NULL).");
  };
  return collective(system, check, [&](ContactSystem& s) {
    // In the order in which this rank added its pairs, whoever holds their rows.
    for (const auto& force : s.contactForces()) forces = std::copy(force.begin(), force.end(), forces);
  });
}

int haptos_multipliers(haptos_system* system, int64_t* count, double* values) {
  if (system == nullptr) return HAPTOS_INPUT_ERROR;
  return guarded(system->message, [&] {
    require(count != nullptr, "Multipliers are asked for without a place for their count (NULL).");
    const auto found = system->system->multipliers();
    require(!found.is_null(), "Nothing is solved yet: call haptos_solve first.");
    const auto lambda = found->getData(0);
    *count = std::int64_t(lambda.size());
    if (values != nullptr) std::copy(lambda.begin(), lambda.end(), values);
  });
}

int haptos_count(haptos_system* system, haptos_counters* counters) {
  return collective(system, [&](ContactSystem& s) {
    const auto found = s.counters();
    if (counters != nullptr) *counters = {found.factorizations, found.multiplications, found.rows};
  });
}

}  // extern "C"
