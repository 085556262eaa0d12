// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SystemInput.hpp"

#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Export.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Util.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_LocalFrame.hpp"
#include "Haptos_PairLaws.hpp"
#include "Haptos_ParameterValue.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_RemoteRows.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SystemChecks.hpp"
#include "Haptos_ThinBodies.hpp"
#include "Haptos_TpetraCompat.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

constexpr int kComponents = 3;

// The elements of a subdomain merged, on this rank alone.
SystemInput::Subdomain merge(const ElementPart& part) {
  SystemInput::Subdomain sub{part.body, {}, {}};
  // Sorted by id, so that a subdomain numbers its nodes the same way however its elements come.
  std::map<std::int64_t, std::array<double, 3>> places;
  for (const auto& element : part.elements)
    for (std::size_t i = 0; i < element.nodes.size(); ++i) places[element.nodes[i]] = element.places[i];
  for (const auto& [id, x] : places) {
    sub.ids.push_back(id);
    sub.part.coordinates.push_back(x);
  }
  const auto comm = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
  const auto map = Teuchos::rcp(new Map(Tpetra::global_size_t(kComponents * sub.ids.size()), 0, comm));
  // the pattern first: sums then find their place, and nothing is sorted again
  std::vector<std::set<GlobalOrdinal>> columns(kComponents * sub.ids.size());
  const auto unknownsOf = [&](const ElementMatrix& element) {
    std::vector<GlobalOrdinal> unknowns;
    for (auto id : element.nodes) {
      const auto node = std::lower_bound(sub.ids.begin(), sub.ids.end(), id) - sub.ids.begin();
      for (int d = 0; d < kComponents; ++d) unknowns.push_back(kComponents * node + d);
    }
    return unknowns;
  };
  for (const auto& element : part.elements) {
    const auto unknowns = unknownsOf(element);
    for (auto row : unknowns) columns[std::size_t(row)].insert(unknowns.begin(), unknowns.end());
  }
  std::size_t widest = 0;
  for (const auto& row : columns) widest = std::max(widest, row.size());
  const auto K = Teuchos::rcp(new CrsMatrix(map, widest));
  for (std::size_t row = 0; row < columns.size(); ++row) {
    const std::vector<GlobalOrdinal> list(columns[row].begin(), columns[row].end());
    // Explicit zeros hold the place: K then has one pattern for all values that elements may bring later.
    const std::vector<double> zeros(list.size(), 0.0);
    K->insertGlobalValues(GlobalOrdinal(row), LocalOrdinal(list.size()), zeros.data(), list.data());
  }
  for (const auto& element : part.elements) {
    const auto unknowns = unknownsOf(element);
    for (std::size_t i = 0; i < unknowns.size(); ++i)
      K->sumIntoGlobalValues(unknowns[i], LocalOrdinal(unknowns.size()), element.K.data() + i * unknowns.size(), unknowns.data());
  }
  K->fillComplete();
  sub.part.K = K;
  return sub;
}

}  // namespace

void SystemInput::checkInterfaces() const {
  ByteWriter writer;
  writer.write(interfaces);
  // Bytes are compared, not values: what differs by round-off came from different sources, too.
  const auto all = gatherOnAll(*comm_, writer.take());
  if (!std::equal(all.begin() + 1, all.end(), all.begin()))
    throw InputError("The interfaces differ from rank to rank; every rank must add the same ones, in the same order, with the same friction.");
  for (const auto& [name, friction] : interfaces) checkFriction(name, friction);
}

void SystemInput::checkKind() const {
  const bool matrices = anyOfAll(*comm_, !subdomains.empty()), single = anyOfAll(*comm_, !elements.empty());
  if (matrices && single) throw InputError("A system takes subdomains or elements, not both.");
  if (!matrices && !single) throw InputError("The system is empty: add subdomains or elements.");
}

// "0", "1", ...
std::vector<std::string> SystemInput::nameBodies() const {
  int mine = -1;
  for (const auto& sub : dealt_) mine = std::max(mine, sub.body);
  const int last = largestOfAll(*comm_, mine), all = sumOfAll(*comm_, int(dealt_.size()));
  // Before anything is as long as the largest number.
  if (last >= all)
    throw InputError("Body " + std::to_string(last) + " is given; there are " + std::to_string(all) +
                     " subdomains, and bodies are numbered from 0 without gaps.");
  std::vector<int> here(std::size_t(last) + 1, 0);
  for (const auto& sub : dealt_) here[std::size_t(sub.body)] = 1;
  // A body may lie on a few ranks only; all must know its name.
  const auto anywhere = largestOfAll(*comm_, here);
  std::vector<std::string> names;
  for (std::size_t body = 0; body < anywhere.size(); ++body) {
    if (!anywhere[body]) throw InputError("Body " + std::to_string(body) + " has no subdomain; bodies are numbered from 0 without gaps.");
    names.push_back(std::to_string(body));
  }
  return names;
}

// The matrices that were brought, or elements cut and merged: always in the same way, so that new values find their pattern.
void SystemInput::dealSubdomains() {
  dealt_ = subdomains;
  if (anyOfAll(*comm_, !elements.empty()))
    for (const auto& part : cutElements(*comm_, elements, PartitionOptions{options_, {}})) dealt_.push_back(merge(part));
  const int count = int(dealt_.size());
  first_ = sumOfLower(*comm_, count);
  for (int i = 0; i < count; ++i)
    dealt_[std::size_t(i)].part.name =
        "subdomain " + std::to_string(first_ + i) + " (body " + std::to_string(dealt_[std::size_t(i)].body) + ")";
}

// Matrices first, as their kernels decide what is solved; then numbers of nodes, and rows, which need both.
SystemModel SystemInput::deal(const DecompositionOptions& options) {
  checkKind();
  checkInterfaces();
  options_ = options;
  readStiffness();
  numberNodes();

  SystemModel model;
  model.comm = comm_;
  model.stiffness = stiffness_;
  model.isOwn = true;
  model.firstSubdomain = first_;
  for (const auto& sub : dealt_) model.bodies.push_back(sub.body);
  model.pieces = model.bodies;
  model.pieceNames = model.bodyNames = nameBodies();
  model.interfaceNames = names();
  model.friction = friction();
  model.gather = gather_;
  model.nameOfNode = [this](std::int64_t node) { return nameOfNode(node); };
  model.multipliers = makeRows();
  for (int i = 0; i < stiffness_->size(); ++i) model.aspects.push_back(stiffness_->aspect(i));
  return model;
}

// Again for every change of values: kernels and nodal stiffnesses belong to the values.
void SystemInput::readStiffness() {
  dealSubdomains();
  runOnAllRanks(*comm_, [&] {
    std::vector<OwnStiffness::Part> parts;
    for (const auto& sub : dealt_) parts.push_back(sub.part);
    stiffness_ = std::make_shared<const OwnStiffness>(std::move(parts));
  });
}

std::vector<FrictionSpec> SystemInput::friction() const {
  std::vector<FrictionSpec> result;
  for (const auto& interface : interfaces) result.push_back(interface.friction);
  return result;
}

std::vector<std::string> SystemInput::names() const {
  std::vector<std::string> result;
  for (const auto& interface : interfaces) result.push_back(interface.name);
  return result;
}

// What is joined is told by ids alone: a node of two bodies would be a tie, or a mistake in numbering bodies one by one.
void SystemInput::checkBodiesOfNodes(const std::vector<std::int64_t>& numbers) const {
  struct Place {
    std::int64_t number, id;
    int body;
  };
  std::vector<Place> mine;
  std::size_t at = 0;
  for (const auto& sub : dealt_)
    for (auto id : sub.ids) mine.push_back({numbers[at++], id, sub.body});
  std::map<std::int64_t, int> bodies;
  std::string shared;
  for (const Place& place : sendItems(*comm_, mine, [&](const Place& p) { return gather_->nodes().owner(p.number); })) {
    const auto [first, isNew] = bodies.emplace(place.number, place.body);
    if (!isNew && first->second != place.body)
      shared = "Node " + std::to_string(place.id) + " is in bodies " + std::to_string(std::min(first->second, place.body)) + " and " +
               std::to_string(std::max(first->second, place.body)) + "; ids must be of one body each.";
  }
  throwOnAllRanks(*comm_, shared);
}

// Consecutive numbers in the order of the ids; the callers' map; copies of every node.
void SystemInput::numberNodes() {
  std::vector<std::int64_t> ids;
  for (const auto& sub : dealt_) ids.insert(ids.end(), sub.ids.begin(), sub.ids.end());
  numbering_ = NodeNumbering(comm_, ids);
  // By rendezvous: no rank knows all ids.
  const auto numbers = numbering_.find(ids);
  nodes_.clear();
  std::size_t at = 0;
  for (const auto& sub : dealt_) {
    nodes_.emplace_back(numbers.begin() + std::ptrdiff_t(at), numbers.begin() + std::ptrdiff_t(at + sub.ids.size()));
    at += sub.ids.size();
  }
  gather_ = std::make_shared<NodalGather>(comm_, numbers, numbering_.size());
  checkBodiesOfNodes(numbers);
  mapNodes(ids);
}

// A one adds up over ranks to the number of copies: here + Export gives sums where a node is owned, Import takes them back.
void SystemInput::mapNodes(const std::vector<std::int64_t>& ids) {
  std::vector<std::int64_t> unique = ids;
  std::sort(unique.begin(), unique.end());
  unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
  std::vector<GlobalOrdinal> unknowns;
  for (auto id : unique)
    for (int d = 0; d < kComponents; ++d) unknowns.push_back(kComponents * id + d);
  // Every rank's unknowns once, copies of a rank merged: the callers' view, from which `map_` takes each unknown for one rank.
  overlap_ = mapOf(unknowns, comm_);
  map_ = Tpetra::createOneToOne<LocalOrdinal, GlobalOrdinal, Map::node_type>(overlap_);
  overlapOfCopy_.clear();
  Vector here(overlap_), sum(map_);
  {
    const auto data = here.getDataNonConst(0);
    for (auto id : ids) {
      overlapOfCopy_.push_back(kComponents * int(std::lower_bound(unique.begin(), unique.end(), id) - unique.begin()));
      for (int d = 0; d < kComponents; ++d) data[overlapOfCopy_.back() + d] += 1;
    }
  }
  sum.doExport(here, Tpetra::Export<>(overlap_, map_), Tpetra::ADD);
  here.doImport(sum, Tpetra::Import<>(map_, overlap_), Tpetra::INSERT);
  const auto data = here.getData(0);
  copies_.assign(data.begin(), data.end());
}

// Each once, on the rank that has the node in `map`.
std::vector<PrescribedDisplacement> SystemInput::collectPrescribed() const {
  struct Sent {
    std::int64_t id;
    int component;
    double value;
    int rank;
  };
  std::vector<GlobalOrdinal> unknowns;
  for (const auto& [key, value] : prescribed) unknowns.push_back(kComponents * key.first + key.second);
  // who has a node in `map` compares what is prescribed at it, from whichever rank it comes
  std::vector<int> ranks(unknowns.size(), -1);
  map_->getRemoteIndexList(Teuchos::ArrayView<const GlobalOrdinal>(unknowns.data(), unknowns.size()),
                           Teuchos::ArrayView<int>(ranks.data(), ranks.size()));
  std::vector<Sent> mine;
  std::string missing;
  std::size_t i = 0;
  for (const auto& [key, value] : prescribed) {
    if (ranks[i] < 0) missing = "A displacement is prescribed at node " + std::to_string(key.first) + ", which is in no subdomain.";
    mine.push_back({key.first, key.second, value, ranks[i++]});
  }
  runOnAllRanks(*comm_, [&] {
    if (!missing.empty()) throw InputError(missing);
  });
  std::map<std::pair<std::int64_t, int>, double> all;
  std::string differing;
  for (const auto& sent : sendItems(*comm_, mine, [](const Sent& s) { return s.rank; })) {
    const auto [at, isNew] = all.emplace(std::make_pair(sent.id, sent.component), sent.value);
    if (!isNew && at->second != sent.value)
      differing = "Displacements " + std::to_string(at->second) + " and " + std::to_string(sent.value) + " are prescribed at node " +
                  std::to_string(sent.id) + ", component " + std::to_string(sent.component) + ".";
  }
  runOnAllRanks(*comm_, [&] {
    if (!differing.empty()) throw InputError(differing);
  });
  std::vector<std::int64_t> ids;
  for (const auto& [key, value] : all) ids.push_back(key.first);
  const auto numbers = numbering_.find(ids);
  std::vector<PrescribedDisplacement> result;
  std::size_t k = 0;
  for (const auto& [key, value] : all) result.push_back({numbers[k++], key.second, value});
  return result;
}

// Every rank looks at its own; all hear of the first that is wrong.
void SystemInput::checkPairs() const {
  runOnAllRanks(*comm_, [&] {
    for (const auto& pair : pairs) checkPair(pair, int(interfaces.size()));
  });
}

// Numbered interface by interface, rank after rank, in the order in which they were added.
// Gaps of pairs that cannot meet are often given as some huge number, which would take the digits of all others.
std::vector<PlacedPair> SystemInput::placePairs(double size) {
  constexpr double kOutOfReach = 1e6;
  checkPairs();
  std::vector<std::int64_t> ids;
  for (const auto& pair : pairs) {
    ids.push_back(pair.secondary);
    for (const auto& [node, weight] : pair.primary) ids.push_back(node);
  }
  const auto numbers = numbering_.find(ids);
  std::vector<int> count(interfaces.size(), 0);
  for (const auto& pair : pairs) ++count[std::size_t(pair.interface)];
  // A pair's number follows from ranks and order of addition alone, so that results find their way back without a table.
  auto next = firstOfInterface_ = sumOfLower(*comm_, count);
  std::vector<PlacedPair> placed;
  std::size_t at = 0;
  runOnAllRanks(*comm_, [&] {
    const auto nodeOf = [&](const PairInput& pair, std::int64_t id) {
      if (numbers[at] < 0) throw InputError(describe(pair) + " needs node " + std::to_string(id) + ", which is in no subdomain.");
      return numbers[at++];
    };
    for (const auto& pair : pairs) {
      ContactPair geometry;
      geometry.secondaryNode = nodeOf(pair, pair.secondary);
      // Callers pair a node; lists on the secondary side come from mortar rows only.
      geometry.secondary = {{geometry.secondaryNode, 1.0}};
      for (const auto& [node, weight] : pair.primary) geometry.primary.push_back({nodeOf(pair, node), weight});
      geometry.frame = makeFrame(pair.normal, pair.axis);
      geometry.gap = std::min(pair.gap, kOutOfReach * size);
      geometry.area = pair.area;
      placed.push_back({pair.interface, next[std::size_t(pair.interface)]++, std::move(geometry)});
    }
  });
  return placed;
}

// From what is there now: rows are made anew after any change of pairs or of what is prescribed where.
RCP<const MultiplierMap> SystemInput::makeRows() {
  RowSources sources;
  std::vector<PartOfBody> parts;
  for (std::size_t i = 0; i < dealt_.size(); ++i) {
    // Nodal stiffnesses weigh the copies of a node in contact rows, which therefore change with K.
    sources.subdomains.push_back({first_ + int(i), nodes_[i], stiffness_->nodalStiffness(int(i))});
    parts.push_back({dealt_[i].body, stiffness_->aspect(int(i)), stiffness_->coordinates(int(i)), [this, i] { return stiffness_->neighbours(int(i)); }});
  }
  const double size = this->size();
  sources.pairs = placePairs(size);
  weighThinBodies(*comm_, gather_->nodes(), parts, sources.pairs, sources.subdomains);
  sources.prescribed = collectPrescribed();
  // The check of the answer looks at nodes where the mean of their copies is made.
  prescribedHere_ = sendItems(*comm_, sources.prescribed, [&](const auto& p) { return gather_->nodes().owner(p.node); });
  for (const auto& [name, friction] : interfaces) sources.interfaces.push_back(interfaceRows(name, friction));
  const auto rows = Teuchos::rcp(new MultiplierMap(comm_, sources));
  if (const auto overlap = firstPinnedOverlap(*comm_, *rows, size))
    throw InsufficientModel("The model has no solution: at node " + nameOfNode(overlap->node) + " of interface '" +
                            interfaces[std::size_t(overlap->interface)].name + "' the prescribed displacements make the surfaces overlap by " +
                            numberText(overlap->depth) + ".");
  return rows;
}

// Of a box around all nodes and what is prescribed.
double SystemInput::size() const {
  std::array<double, 7> largest{};  // -x, x of three directions; |displacement|
  std::fill_n(largest.begin(), 6, -std::numeric_limits<double>::infinity());
  for (const auto& sub : dealt_)
    for (const auto& x : sub.part.coordinates)
      for (std::size_t d = 0; d < 3; ++d) largest[2 * d] = std::max(largest[2 * d], -x[d]), largest[2 * d + 1] = std::max(largest[2 * d + 1], x[d]);
  for (const auto& [unknown, value] : prescribed) largest[6] = std::max(largest[6], std::abs(value));
  largest = largestOfAll(*comm_, largest);
  return std::max({largest[0] + largest[1], largest[2] + largest[3], largest[4] + largest[5], largest[6]});
}

// Found by the rank that has a copy with this number.
std::string SystemInput::nameOfNode(std::int64_t number) const {
  std::int64_t mine = -1;
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    for (std::size_t k = 0; k < nodes_[i].size(); ++k)
      if (nodes_[i][k] == number) mine = dealt_[i].ids[k];
  return std::to_string(largestOfAll(*comm_, mine));
}

// f_i = f / copies in every copy i of a node: their sum is f, and contact forces alone part the copies.
RCP<Vector> SystemInput::spread(const Vector& f, const RCP<const Map>& primal) const {
  Vector here(overlap_);
  here.doImport(f, Tpetra::Import<>(map_, overlap_), Tpetra::INSERT);
  const auto result = Teuchos::rcp(new Vector(primal));
  const auto from = here.getData(0);
  const auto to = result->getDataNonConst(0);
  for (std::size_t copy = 0; copy < overlapOfCopy_.size(); ++copy)
    for (int d = 0; d < kComponents; ++d) {
      const int at = overlapOfCopy_[copy] + d;
      to[Teuchos::Ordinal(kComponents * copy) + d] = from[at] / copies_[std::size_t(at)];
    }
  return result;
}

// u = sum of u_i / copies: the copies agree up to the tolerance, and all count alike.
void SystemInput::average(const Vector& copies, Vector& u) const {
  Vector here(overlap_);
  {
    const auto from = copies.getData(0);
    const auto to = here.getDataNonConst(0);
    for (std::size_t copy = 0; copy < overlapOfCopy_.size(); ++copy)
      for (int d = 0; d < kComponents; ++d) {
        const int at = overlapOfCopy_[copy] + d;
        to[at] += from[Teuchos::Ordinal(kComponents * copy) + d] / copies_[std::size_t(at)];
      }
  }
  u.putScalar(0.0);
  u.doExport(here, Tpetra::Export<>(overlap_, map_), Tpetra::ADD);
}

}  // namespace Haptos
