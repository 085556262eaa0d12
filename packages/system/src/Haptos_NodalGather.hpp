// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "Haptos_EvenRanges.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief Brings vectors on all subdomains to the nodes of the mesh, each node to the rank in whose range it lies.
class NodalGather {
 public:
  /// \param nodesOfCopies nodes of this rank's subdomains, one after the other (`nodesOf`)
  /// \param numMeshNodes of the whole mesh, the same on all ranks.  Collective.
  NodalGather(RCP<const Communicator> comm, const std::vector<std::int64_t>& nodesOfCopies, std::int64_t numMeshNodes);

  const EvenRanges& nodes() const { return nodes_; }
  std::int64_t firstNode() const;  ///< of this rank's range, by mesh index
  std::size_t numNodes() const { return numNodes_; }  ///< of this rank's range

  /// Three values a node of this rank's range, over the copies of the node; 0 for one without elements.
  struct Copies {
    std::vector<double> mean, lowest, highest;  ///< [3 x numNodes()]
  };

  /// \param u on the primal map.  Collective.
  Copies copies(const MultiVector& u) const;

  /// \brief Sum over the copies, [3 x numNodes()].  Collective.
  std::vector<double> sum(const MultiVector& f) const;

  /// \brief Values of any nodes.  Collective.
  /// \param field [3 x numNodes()] on every rank, \param wanted mesh nodes, others on every rank
  /// \return [3 x wanted]
  std::vector<double> fetch(const std::vector<double>& field, const std::vector<std::int64_t>& wanted) const;

 private:
  using Triple = std::array<double, 3>;
  std::vector<Triple> receive(const MultiVector& v) const;

  RCP<const Communicator> comm_;
  EvenRanges nodes_;
  std::size_t numNodes_;
  std::vector<std::size_t> targets_;  // nodes of the range, one for each copy that is received, in that order
  std::vector<int> ranks_;            // [copies on this rank] where they go
};

/// \brief What all ranks hold, one after the other, on rank 0; empty elsewhere.  For tests: nothing of a mesh fits one rank.  Collective.
std::vector<double> wholeOnRoot(const Communicator& comm, const std::vector<double>& mine);

}  // namespace Haptos
