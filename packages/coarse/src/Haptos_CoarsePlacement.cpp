// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoarsePlacement.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <memory>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_CoarseSchur.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_Reductions.hpp"

namespace Haptos {
namespace {

// Ranks with the same number share a factor.
int groupOf(const Communicator& comm, int ranksPerFactor) {
  return ranksPerFactor > 0 ? comm.getRank() / ranksPerFactor : lowestRankOfNode(comm);
}

}  // namespace

// Small matrices, and groups of one rank: every rank holds a factor.
CoarsePlacement::CoarsePlacement(RCP<const Communicator> comm, Eigen::Index unknowns, const CoarseOptions& options)
    : comm_(std::move(comm)), numHolders_(comm_->getSize()) {
  if (unknowns <= options.replicatedUpTo || numHolders_ == 1 || options.ranksPerFactor == 1) return;
  if (options.ranksPerFactor == 0 && CoarseSchur::isPossible()) {
    halve();
    return;
  }
  placeFactors(*comm_->split(groupOf(*comm_, options.ranksPerFactor), comm_->getRank()), 0);
}

// Ranks whose group is one rank already take part in a split, and get none.
void CoarsePlacement::halve() {
  numHolders_ = 1;
  const int rank = comm_->getRank();
  RankRange mine{0, comm_->getSize()};
  groups_.push_back(comm_);
  for (int largest = (comm_->getSize() + 1) / 2; largest > 1; largest = (largest + 1) / 2) {
    mine = mine.size() > 1 ? mine.half(rank) : mine;
    const auto group = comm_->split(mine.size() > 1 ? mine.begin : -1, rank);
    if (mine.size() > 1) groups_.push_back(group);
  }
}

// The rank of the group at this place becomes the first of it, and holds the factor.
void CoarsePlacement::placeFactors(const Communicator& group, int place) {
  const int size = group.getSize();
  group_ = group.split(0, (group.getRank() + size - place % size) % size);
  const int holder = group_->getRank() == 0, mine = holder ? comm_->getRank() : comm_->getSize();
  holders_ = comm_->split(holder ? 0 : -1, comm_->getRank());  // a negative colour gives no communicator
  numHolders_ = sumOfAll(*comm_, holder);
  firstHolder_ = leastOfAll(*comm_, mine);
}

std::shared_ptr<const CoarsePlacement> CoarsePlacement::onNextRanks() const {
  auto next = std::make_shared<CoarsePlacement>(*this);
  if (!group_.is_null()) next->placeFactors(*group_, 1);
  return next;
}

// One reduction of all ranks, or one in each group and one among the first of each: the second is short where ranks share memory.
Eigen::MatrixXd CoarsePlacement::sum(const Eigen::MatrixXd& mine) const {
  if (comm_->getSize() == 1 || mine.size() == 0) return mine;
  if (group_.is_null()) return sumOfAll(*comm_, mine);
  Eigen::MatrixXd total(mine.rows(), mine.cols());
  const int size = int(mine.size());
  Teuchos::reduce(mine.data(), total.data(), size, Teuchos::REDUCE_SUM, 0, *group_);
  if (!holds()) return {};
  if (holders_->getSize() == 1) return total;
  return sumOfAll(*holders_, total);
}

void CoarsePlacement::broadcast(Eigen::MatrixXd& x) const {
  if (!group_.is_null() && x.size() > 0) Teuchos::broadcast(*group_, 0, int(x.size()), x.data());
}

// Group by group, in each by rank: the order is the same on all holders, which is all that it is for.
std::vector<Bytes> CoarsePlacement::gather(const Bytes& message) const {
  if (group_.is_null()) return gatherOnAll(*comm_, message);
  ByteWriter ofGroup;
  const auto messages = gatherOnRoot(*group_, message);
  if (!holds()) return {};
  ofGroup.write(messages.size());
  for (const auto& part : messages) ofGroup.write(part);
  std::vector<Bytes> all;
  for (const auto& part : gatherOnAll(*holders_, ofGroup.take())) {
    ByteReader reader(part);
    const auto ranks = reader.read<std::size_t>();
    for (std::size_t r = 0; r < ranks; ++r) all.push_back(reader.readVector<char>());
  }
  return all;
}

}  // namespace Haptos
