// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_Subdomain.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief Brings vectors on all subdomains to the nodes of the mesh, on rank 0.
class NodalGather {
 public:
  /// \param numMeshNodes used on rank 0 only.  Collective.
  NodalGather(RCP<const Communicator> comm, const std::vector<Subdomain>& subdomains, std::size_t numMeshNodes);

  /// On rank 0: three values a mesh node; empty elsewhere.
  struct Copies {
    std::vector<double> mean, lowest, highest;  ///< [3 x numMeshNodes] over the copies of a node
  };

  /// \param u on the primal map.  Collective.
  Copies copies(const MultiVector& u) const;

  /// \brief Sum over the copies, [3 x numMeshNodes] on rank 0, empty elsewhere.  Collective.
  std::vector<double> sum(const MultiVector& f) const;

 private:
  std::vector<std::vector<double>> gatherValues(const MultiVector& v) const;

  RCP<const Communicator> comm_;
  std::size_t numMeshNodes_;
  std::vector<std::vector<std::int64_t>> nodes_;  // [ranks] on rank 0: mesh nodes of all subdomains in order
};

}  // namespace Haptos
