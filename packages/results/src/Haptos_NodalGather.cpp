// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NodalGather.hpp"

#include <Teuchos_Comm.hpp>
#include <Tpetra_MultiVector.hpp>
#include <limits>

#include "Haptos_Exchange.hpp"

namespace Haptos {

NodalGather::NodalGather(RCP<const Communicator> comm, const std::vector<Subdomain>& subdomains, std::size_t numMeshNodes)
    : comm_(std::move(comm)), numMeshNodes_(numMeshNodes) {
  std::vector<std::int64_t> mine;
  for (const auto& sub : subdomains) mine.insert(mine.end(), sub.nodes.begin(), sub.nodes.end());
  ByteWriter writer;
  writer.write(mine);
  for (const auto& message : gatherOnRoot(*comm_, writer.take()))
    nodes_.push_back(ByteReader(message).readVector<std::int64_t>());
}

std::vector<std::vector<double>> NodalGather::gatherValues(const MultiVector& v) const {
  const auto data = v.getData(0);
  ByteWriter writer;
  writer.write(std::vector<double>(data.begin(), data.end()));
  std::vector<std::vector<double>> values;
  for (const auto& message : gatherOnRoot(*comm_, writer.take())) values.push_back(ByteReader(message).readVector<double>());
  return values;
}

NodalGather::Copies NodalGather::copies(const MultiVector& u) const {
  const auto values = gatherValues(u);
  Copies result;
  if (comm_->getRank() != 0) return result;
  const double infinity = std::numeric_limits<double>::infinity();
  result.mean.assign(3 * numMeshNodes_, 0.0);
  result.lowest.assign(3 * numMeshNodes_, infinity);
  result.highest.assign(3 * numMeshNodes_, -infinity);
  std::vector<int> count(numMeshNodes_, 0);
  for (std::size_t rank = 0; rank < values.size(); ++rank)
    for (std::size_t i = 0; i < nodes_[rank].size(); ++i) {
      ++count[nodes_[rank][i]];
      for (int d = 0; d < 3; ++d) {
        const std::size_t at = 3 * std::size_t(nodes_[rank][i]) + d;
        const double value = values[rank][3 * i + d];
        result.mean[at] += value;
        result.lowest[at] = std::min(result.lowest[at], value);
        result.highest[at] = std::max(result.highest[at], value);
      }
    }
  for (std::size_t node = 0; node < numMeshNodes_; ++node)
    for (int d = 0; d < 3; ++d) {
      double& mean = result.mean[3 * node + d];
      if (count[node] > 0) mean /= count[node];
      else result.lowest[3 * node + d] = result.highest[3 * node + d] = 0.0;  // a node without elements
    }
  return result;
}

std::vector<double> NodalGather::sum(const MultiVector& f) const {
  const auto values = gatherValues(f);
  std::vector<double> result;
  if (comm_->getRank() != 0) return result;
  result.assign(3 * numMeshNodes_, 0.0);
  for (std::size_t rank = 0; rank < values.size(); ++rank)
    for (std::size_t i = 0; i < nodes_[rank].size(); ++i)
      for (int d = 0; d < 3; ++d) result[3 * std::size_t(nodes_[rank][i]) + d] += values[rank][3 * i + d];
  return result;
}

}  // namespace Haptos
