// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SubdomainMatrix.hpp"

#include <Teuchos_Comm.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Export.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Util.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>

#include "Haptos_Error.hpp"
#include "Haptos_OwnStiffness.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

constexpr int kComponents = 3;

std::vector<GlobalOrdinal> sortedOnce(std::vector<GlobalOrdinal> numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  return numbers;
}

// Of all subdomains of this rank, in the order of the ids.
std::vector<GlobalOrdinal> unknownsOf(const std::vector<SubdomainInput>& subdomains) {
  std::vector<GlobalOrdinal> ids, unknowns;
  for (const auto& sub : subdomains) ids.insert(ids.end(), sub.nodes.begin(), sub.nodes.end());
  for (auto id : sortedOnce(std::move(ids)))
    for (int d = 0; d < kComponents; ++d) unknowns.push_back(kComponents * id + d);
  return unknowns;
}

// The first of this rank's; the rest is looked at where a system takes the subdomains.
std::string problemOf(const std::vector<SubdomainInput>& subdomains) {
  for (const auto& sub : subdomains) {
    const std::string who = " a subdomain of body " + std::to_string(sub.body) + " ", problem = problemOfMatrix(sub.K, std::size_t(sub.nodes.size()));
    if (!problem.empty()) return "The stiffness of" + who + problem;
    if (sub.coordinates.size() != 3 * sub.nodes.size())
      return "The places of" + who + "have " + std::to_string(sub.coordinates.size()) + " coordinates; its " + std::to_string(sub.nodes.size()) +
             " nodes have three each.";
  }
  return "";
}

std::string nameOf(GlobalOrdinal unknown) {
  return "Component " + std::to_string(unknown % kComponents) + " of node " + std::to_string(unknown / kComponents);
}

// \param unknowns each once: Tpetra's directory loses what is asked for twice
void requireIn(const Map& map, const std::vector<GlobalOrdinal>& unknowns, const std::string& otherwise) {
  std::vector<int> ranks(unknowns.size(), -1);
  map.getRemoteIndexList(Teuchos::ArrayView<const GlobalOrdinal>(unknowns.data(), unknowns.size()), Teuchos::ArrayView<int>(ranks.data(), ranks.size()));
  const auto lost = std::find(ranks.begin(), ranks.end(), -1);
  throwOnAllRanks(*map.getComm(), lost == ranks.end() ? "" : nameOf(unknowns[std::size_t(lost - ranks.begin())]) + otherwise);
}

RCP<const Map> mapOf(const RCP<const Communicator>& comm, const std::vector<GlobalOrdinal>& unknowns) {
  return Teuchos::rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(),
                              Teuchos::ArrayView<const GlobalOrdinal>(unknowns.data(), unknowns.size()), 0, comm));
}

}  // namespace

SubdomainMatrix::SubdomainMatrix(const RCP<const Communicator>& comm, const std::vector<SubdomainInput>& subdomains,
                                 const std::vector<GlobalOrdinal>& held, const RCP<const Map>& map) {
  throwOnAllRanks(*comm, problemOf(subdomains));
  const auto unknowns = unknownsOf(subdomains);
  const auto here = mapOf(comm, unknowns);
  // Without a map of the caller's each unknown goes to one of the ranks that have it.
  map_ = map.is_null() ? Tpetra::createOneToOne<LocalOrdinal, GlobalOrdinal, Map::node_type>(here) : map;
  requireIn(*map_, unknowns, " is not in the map of the matrix; it must have 3 x id + component for every node.");
  overlap_ = Teuchos::rcp(new Tpetra::Import<>(map_, here));
  for (const auto& sub : subdomains) {
    Part part{sub.body, {sub.nodes.begin(), sub.nodes.end()}, {sub.coordinates.begin(), sub.coordinates.end()},
              {sub.kernel.begin(), sub.kernel.end()}, sub.K, {}};
    for (auto id : part.nodes)
      for (int d = 0; d < kComponents; ++d) part.rows.push_back(here->getLocalElement(kComponents * id + d));
    parts_.push_back(std::move(part));
  }
  const auto named = sortedOnce(held);
  requireIn(*map_, named, " is held and in no subdomain.");
  findHeld(named);
}

// Whoever names an unknown, all ranks that have it know.
void SubdomainMatrix::findHeld(const std::vector<GlobalOrdinal>& named) {
  const auto those = mapOf(map_->getComm(), named);
  Vector marks(those), owned(map_), here(overlap_->getTargetMap());
  marks.putScalar(1.0);
  owned.doExport(marks, Tpetra::Export<>(those, map_), Tpetra::ADD);
  here.doImport(owned, *overlap_, Tpetra::INSERT);
  const auto collect = [](const Vector& v, std::vector<LocalOrdinal>& rows) {
    const auto data = v.getData(0);
    for (LocalOrdinal i = 0; i < LocalOrdinal(data.size()); ++i)
      if (data[i] > 0) rows.push_back(i);
  };
  collect(owned, held_);
  collect(here, heldHere_);
}

// Rows and columns of K are local numbers, which its column map may have in another order.
void SubdomainMatrix::multiply(const Part& part, const double* x, double* y) const {
  const Map &rows = *part.K->getRowMap(), &columns = *part.K->getColMap();
  std::vector<double> own(localNumElements(columns));
  for (std::size_t j = 0; j < own.size(); ++j) own[j] = x[part.rows[std::size_t(rows.getLocalElement(columns.getGlobalElement(LocalOrdinal(j))))]];
  const auto K = part.K->getLocalMatrixHost();
  for (std::size_t i = 0; i < part.rows.size(); ++i) {
    double sum = 0;
    for (auto k = K.graph.row_map(i); k < K.graph.row_map(i + 1); ++k) sum += K.values(k) * own[std::size_t(K.graph.entries(k))];
    y[part.rows[i]] += sum;
  }
}

void SubdomainMatrix::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  MultiVector in(overlap_->getTargetMap(), x.getNumVectors()), out(in.getMap(), x.getNumVectors()), sum(map_, x.getNumVectors());
  in.doImport(x, *overlap_, Tpetra::INSERT);
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    const auto from = in.getDataNonConst(v), to = out.getDataNonConst(v);
    // A with rows and columns of held unknowns taken out, and 1 on their diagonal below: symmetric, as K is.
    for (auto row : heldHere_) from[row] = 0;
    for (const auto& part : parts_) multiply(part, from.getRawPtr(), to.getRawPtr());
  }
  // What subdomains on several ranks say of one unknown adds up where it is owned.
  sum.doExport(out, *overlap_, Tpetra::ADD);
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    const auto from = x.getData(v);
    const auto to = sum.getDataNonConst(v);
    for (auto row : held_) to[row] = from[row];
  }
  y.update(alpha, sum, beta);
}

void SubdomainMatrix::addTo(ContactSystem& system) const {
  for (const auto& part : parts_)
    system.addSubdomain({part.body, Teuchos::arrayViewFromVector(part.nodes), Teuchos::arrayViewFromVector(part.coordinates), part.K,
                         Teuchos::arrayViewFromVector(part.kernel)});
  for (auto row : held_) {
    const GlobalOrdinal unknown = map_->getGlobalElement(row);
    system.prescribe(unknown / kComponents, int(unknown % kComponents), 0.0);
  }
}

}  // namespace Haptos
