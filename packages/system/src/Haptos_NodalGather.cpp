// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NodalGather.hpp"

#include <Teuchos_Comm.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <limits>

#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

using Triple = std::array<double, 3>;

}  // namespace

// Where copies go is settled once; later only values travel, in the same order.
NodalGather::NodalGather(RCP<const Communicator> comm, const std::vector<std::int64_t>& nodesOfCopies, std::int64_t numMeshNodes)
    : comm_(std::move(comm)), nodes_{numMeshNodes, comm_->getSize()}, numNodes_(std::size_t(nodes_.count(comm_->getRank()))) {
  for (const auto node : nodesOfCopies) ranks_.push_back(nodes_.owner(node));
  for (const auto node : sendItems(*comm_, nodesOfCopies, [&](std::int64_t n) { return nodes_.owner(n); }))
    targets_.push_back(std::size_t(node - firstNode()));
}

std::int64_t NodalGather::firstNode() const { return nodes_.begin(comm_->getRank()); }

// By rank and in its order of copies: sums do not depend on who holds the nodes.
std::vector<Triple> NodalGather::receive(const MultiVector& v) const {
  const auto data = v.getData(0);
  std::vector<std::vector<Triple>> outgoing(std::size_t(comm_->getSize()));
  for (std::size_t i = 0; i < ranks_.size(); ++i) outgoing[std::size_t(ranks_[i])].push_back({data[3 * i], data[3 * i + 1], data[3 * i + 2]});
  return joined(exchangeValues(*comm_, outgoing));
}

// Mean for the answer, lowest and highest for the error of continuity.
NodalGather::Copies NodalGather::copies(const MultiVector& u) const {
  const auto values = receive(u);
  const double infinity = std::numeric_limits<double>::infinity();
  Copies result;
  result.mean.assign(3 * numNodes_, 0.0);
  result.lowest.assign(3 * numNodes_, infinity);
  result.highest.assign(3 * numNodes_, -infinity);
  std::vector<int> count(numNodes_, 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    ++count[targets_[i]];
    for (std::size_t d = 0; d < 3; ++d) {
      const std::size_t at = 3 * targets_[i] + d;
      result.mean[at] += values[i][d];
      result.lowest[at] = std::min(result.lowest[at], values[i][d]);
      result.highest[at] = std::max(result.highest[at], values[i][d]);
    }
  }
  for (std::size_t at = 0; at < result.mean.size(); ++at) {
    if (count[at / 3] > 0) result.mean[at] /= count[at / 3];
    else result.lowest[at] = result.highest[at] = 0.0;  // a node without elements
  }
  return result;
}

std::vector<double> NodalGather::sum(const MultiVector& f) const {
  const auto values = receive(f);
  std::vector<double> result(3 * numNodes_, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i)
    for (std::size_t d = 0; d < 3; ++d) result[3 * targets_[i] + d] += values[i][d];
  return result;
}

std::vector<double> NodalGather::fetch(const std::vector<double>& field, const std::vector<std::int64_t>& wanted) const {
  std::vector<double> values;
  for (const Triple& x : RemoteValues(*comm_, nodes_, wanted).fetch([&](std::int64_t place) {
         const double* at = &field[3 * std::size_t(place)];
         return Triple{at[0], at[1], at[2]};
       }))
    values.insert(values.end(), x.begin(), x.end());
  return values;
}

std::vector<double> wholeOnRoot(const Communicator& comm, const std::vector<double>& mine) {
  return gatheredOnRoot(comm, mine);
}

}  // namespace Haptos
