// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief Global indices of every rank, each on one or, in an overlapping map, on several.  Collective.
RCP<const Map> mapOf(const std::vector<GlobalOrdinal>& indices, const RCP<const Communicator>& comm);

/// \brief Some rows of a map, local in it, in the order given.  Collective.
RCP<const Map> mapOfRows(const Map& map, const std::vector<int>& rows);

/// \brief Rows that this rank touches and others own: values fetched from their owners, or added to them.
///
/// Only these rows are moved; the rank's own ones stay where they are.
class RemoteRows {
 public:
  /// \param map one-to-one; \param overlapMap on every rank all rows of `map`, in its order, then rows of others.  Collective.
  RemoteRows(RCP<const Map> map, const RCP<const Map>& overlapMap);

  std::size_t numOwned() const { return numOwned_; }       ///< overlap rows before are the rank's own
  const RCP<const Map>& map() const { return remoteMap_; }  ///< of the remote rows
  const Tpetra::Import<>& importer() const { return *importer_; }

  /// \brief remote := x at the remote rows.  Collective.
  void fetch(const MultiVector& x, MultiVector& remote) const;
  /// \brief y += what the ranks hold at each other's rows.  Collective.
  void addToOwners(const MultiVector& remote, MultiVector& y) const;

  /// \name The same for arrays of the owned and of the remote rows, one vector.
  /// @{
  Eigen::VectorXd fetch(const Eigen::VectorXd& owned) const;
  void addToOwners(const Eigen::VectorXd& remote, Eigen::VectorXd& owned) const;
  /// @}

 private:
  void makeVectors() const;

  RCP<const Map> map_, remoteMap_;
  RCP<const Tpetra::Import<>> importer_;
  std::size_t numOwned_;
  bool isAlone_;
  mutable RCP<Vector> ownValues_, remoteValues_;  // of arrays; made where they are needed first
};

}  // namespace Haptos
