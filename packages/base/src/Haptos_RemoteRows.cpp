// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RemoteRows.hpp"

#include <Teuchos_Assert.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>

#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

void copyTo(Vector& v, const Eigen::VectorXd& values) {
  const auto data = v.getDataNonConst(0);
  std::copy(values.data(), values.data() + values.size(), data.begin());
}

Eigen::VectorXd valuesOf(const Vector& v) {
  const auto data = v.getData(0);
  return Eigen::Map<const Eigen::VectorXd>(data.getRawPtr(), data.size());
}

}  // namespace

// Sizes are counted by Tpetra; the index base is ours.
RCP<const Map> mapOf(const std::vector<GlobalOrdinal>& indices, const RCP<const Communicator>& comm) {
  return Teuchos::rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(),
                              Teuchos::ArrayView<const GlobalOrdinal>(indices.data(), Teuchos_Ordinal(indices.size())), 0, comm));
}

// Some of the rows that this rank owns, in this order, under their own global indices.
RCP<const Map> mapOfRows(const Map& map, const std::vector<int>& rows) {
  std::vector<GlobalOrdinal> global;
  for (int row : rows) global.push_back(map.getGlobalElement(row));
  return mapOf(global, map.getComm());
}

RemoteRows::RemoteRows(RCP<const Map> map, const RCP<const Map>& overlapMap)
    : map_(std::move(map)), numOwned_(localNumElements(*map_)), isAlone_(map_->getComm()->getSize() == 1) {
  const auto rows = localElementList(*overlapMap);
  const auto own = localElementList(*map_);
  TEUCHOS_ASSERT(rows.size() >= own.size() && std::equal(own.begin(), own.end(), rows.begin()));
  remoteMap_ = Teuchos::rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(),
                                    rows(int(numOwned_), int(std::size_t(rows.size()) - numOwned_)), map_->getIndexBase(), map_->getComm()));
  importer_ = Teuchos::rcp(new Tpetra::Import<>(map_, remoteMap_));
}

// Own rows are left where they lie, see decisions/003.
void RemoteRows::fetch(const MultiVector& x, MultiVector& remote) const {
  if (!isAlone_) remote.doImport(x, *importer_, Tpetra::INSERT);
}

void RemoteRows::addToOwners(const MultiVector& remote, MultiVector& y) const {
  if (!isAlone_) y.doExport(remote, *importer_, Tpetra::ADD);
}

// Tpetra transfers vectors of its own only; they are made at the first use and kept.
void RemoteRows::makeVectors() const {
  if (!ownValues_.is_null()) return;
  ownValues_ = Teuchos::rcp(new Vector(map_));
  remoteValues_ = Teuchos::rcp(new Vector(remoteMap_));
}

// Values of the other ranks' rows that this rank touches.
Eigen::VectorXd RemoteRows::fetch(const Eigen::VectorXd& owned) const {
  if (isAlone_) return {};
  makeVectors();
  copyTo(*ownValues_, owned);
  fetch(*ownValues_, *remoteValues_);
  return valuesOf(*remoteValues_);
}

// owned += what all other ranks have for these rows.
void RemoteRows::addToOwners(const Eigen::VectorXd& remote, Eigen::VectorXd& owned) const {
  if (isAlone_) return;
  makeVectors();
  copyTo(*ownValues_, owned);
  copyTo(*remoteValues_, remote);
  addToOwners(*remoteValues_, *ownValues_);
  owned = valuesOf(*ownValues_);
}

}  // namespace Haptos
