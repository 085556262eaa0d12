// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NodeValues.hpp"

#include <Tpetra_Export.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <string>

#include "Haptos_Error.hpp"

namespace Haptos {
namespace {

constexpr int kComponents = 3;

RCP<const Map> mapOf(const RCP<const Map>& system, const std::vector<std::int64_t>& unique) {
  std::vector<GlobalOrdinal> unknowns;
  for (auto id : unique)
    for (int d = 0; d < kComponents; ++d) unknowns.push_back(kComponents * id + d);
  const Teuchos::ArrayView<const GlobalOrdinal> view(unknowns.data(), unknowns.size());
  std::vector<int> ranks(unknowns.size(), -1);
  system->getRemoteIndexList(view, Teuchos::ArrayView<int>(ranks.data(), ranks.size()));
  const auto lost = std::find(ranks.begin(), ranks.end(), -1);
  throwOnAllRanks(*system->getComm(), lost == ranks.end() ? "" : "Node " + std::to_string(unknowns[std::size_t(lost - ranks.begin())] / kComponents) +
                                                                    " is in no subdomain.");
  return Teuchos::rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), view, 0, system->getComm()));
}

}  // namespace

NodeValues::NodeValues(const RCP<const Map>& system, const std::vector<std::int64_t>& nodes) : system_(system) {
  std::vector<std::int64_t> unique = nodes;
  std::sort(unique.begin(), unique.end());
  unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
  here_ = mapOf(system, unique);
  for (auto id : nodes) first_.push_back(kComponents * int(std::lower_bound(unique.begin(), unique.end(), id) - unique.begin()));
}

void NodeValues::sumInto(Vector& vector, const std::vector<double>& values) const {
  Vector mine(here_);
  {
    const auto data = mine.getDataNonConst(0);
    for (std::size_t i = 0; i < first_.size(); ++i)
      for (int d = 0; d < kComponents; ++d) data[first_[i] + d] += values[kComponents * i + std::size_t(d)];
  }
  vector.putScalar(0.0);
  vector.doExport(mine, Tpetra::Export<>(here_, system_), Tpetra::ADD);
}

void NodeValues::read(const Vector& vector, double* values) const {
  Vector mine(here_);
  mine.doImport(vector, Tpetra::Import<>(system_, here_), Tpetra::INSERT);
  const auto data = mine.getData(0);
  for (std::size_t i = 0; i < first_.size(); ++i)
    for (int d = 0; d < kComponents; ++d) values[kComponents * i + std::size_t(d)] = data[first_[i] + d];
}

}  // namespace Haptos
