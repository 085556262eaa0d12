// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactBlock.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <set>

#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

template <class Predicate>
RCP<const Map> subsetMap(const Map& map, Predicate&& isKept) {
  std::vector<GlobalOrdinal> kept;
  for (int row = 0; row < int(localNumElements(map)); ++row)
    if (isKept(row)) kept.push_back(map.getGlobalElement(row));
  return Teuchos::rcp(new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(),
                              Teuchos::ArrayView<const GlobalOrdinal>(kept.data(), int(kept.size())), map.getIndexBase(), map.getComm()));
}

}  // namespace

ContactBlock::ContactBlock(RCP<const DualPreconditioner> preconditioner) : preconditioner_(std::move(preconditioner)) {
  findNearRows();
}

void ContactBlock::findNearRows() {
  const MultiplierMap& multipliers = preconditioner_->jump().multipliers();
  const auto& kinds = multipliers.kinds();
  const auto& inverse = preconditioner_->gram().inverse();
  Vector mine(multipliers.map()), remote(multipliers.remote().map());
  std::vector<int> position(kinds.size(), -1);
  {
    const auto marks = mine.getDataNonConst(0);
    for (std::size_t row = 0; row < kinds.size(); ++row) {
      if (isEquality(kinds[row])) continue;
      marks[row] = 1;
      for (RowMatrix::InnerIterator it(inverse, Eigen::Index(row)); it; ++it) marks[it.col()] = 1;
    }
    for (std::size_t row = 0; row < kinds.size(); ++row)
      if (marks[row] != 0) {
        position[row] = int(near_.size());
        near_.push_back(int(row));
        isContact_.push_back(!isEquality(kinds[row]));
      }
  }
  std::vector<Eigen::Triplet<double>> triplets;
  for (std::size_t i = 0; i < near_.size(); ++i)
    for (RowMatrix::InnerIterator it(inverse, near_[i]); it; ++it)
      if (position[it.col()] >= 0) triplets.emplace_back(int(i), position[it.col()], it.value());
  gram_.resize(Eigen::Index(near_.size()), Eigen::Index(near_.size()));
  gram_.setFromTriplets(triplets.begin(), triplets.end());

  multipliers.remote().fetch(mine, remote);
  std::vector<char> isNear;
  for (double mark : mine.getData(0)) isNear.push_back(mark != 0);
  for (double mark : remote.getData(0)) isNear.push_back(mark != 0);
  nearMap_ = subsetMap(*multipliers.map(), [&](int row) { return position[std::size_t(row)] >= 0; });
  remote_ = std::make_unique<RemoteRows>(nearMap_, subsetMap(*multipliers.overlapMap(), [&](int row) { return isNear[std::size_t(row)] != 0; }));
  findUnknowns(isNear);
}

// The unknowns of the nodes of near rows; the compact vector holds those of a class's active members one after another.
void ContactBlock::findUnknowns(const std::vector<char>& isNear) {
  const JumpOperator& jump = preconditioner_->jump();
  const auto& overlapEntries = jump.multipliers().overlapEntries();
  std::vector<std::set<int>> nodes(jump.primalOffsets().size() - 1);
  for (const auto& entry : overlapEntries)
    if (isNear[entry.row]) nodes[entry.subdomain - jump.firstSubdomain()].insert(entry.dof / 3);

  const auto& members = preconditioner_->systems().members();
  unknowns_.resize(members.size());
  dense_.resize(members.size());
  active_.resize(members.size());
  std::vector<Eigen::Index> offset(nodes.size(), -1);
  std::vector<std::vector<int>> positionOf(members.size());  // local dof -> position in the list
  for (std::size_t c = 0; c < members.size(); ++c) {
    std::set<int> all;
    for (int member : members[c]) all.insert(nodes[member].begin(), nodes[member].end());
    const auto& boundary = preconditioner_->boundary(int(c));
    const bool isDense = 3 * all.size() <= std::size_t(kLargestDense);
    for (std::size_t i = 0; i < boundary.size() && !all.empty(); ++i) {
      if (isDense && all.count(boundary[i] / 3) == 0) continue;
      positionOf[c].resize(std::max(positionOf[c].size(), std::size_t(boundary[i]) + 1), -1);
      positionOf[c][std::size_t(boundary[i])] = int(unknowns_[c].size());
      unknowns_[c].push_back(int(i));
    }
    if (isDense && !all.empty()) dense_[c] = denseBlock(int(c));
    first_.push_back(size_);
    for (int member : members[c]) {
      if (nodes[member].empty()) continue;
      offset[std::size_t(member)] = size_;
      size_ += Eigen::Index(unknowns_[c].size());
      active_[c].push_back(member);
    }
  }
  std::vector<int> rowOf(isNear.size(), -1);
  for (std::size_t row = 0, next = 0; row < isNear.size(); ++row)
    if (isNear[row]) rowOf[row] = int(next++);
  for (const auto& entry : overlapEntries) {
    if (!isNear[entry.row]) continue;
    const int member = entry.subdomain - jump.firstSubdomain();
    const auto& position = positionOf[std::size_t(preconditioner_->systems()[member].congruenceClass)];
    entries_.push_back({rowOf[entry.row], int(offset[std::size_t(member)]) + position[std::size_t(entry.dof)], entry.value / entry.weight});
  }
}

// Single precision wherever M itself has it: the block is read several times an iteration.
DenseSymmetric ContactBlock::denseBlock(int congruenceClass) const {
  const bool shared = preconditioner_->systems().members()[std::size_t(congruenceClass)].size() > 1;
  return {preconditioner_->schurBlock(congruenceClass, unknowns_[std::size_t(congruenceClass)]),
          shared ? DenseSymmetric::Storage::Full : DenseSymmetric::Storage::Packed,
          preconditioner_->isDouble(congruenceClass) ? DenseSymmetric::Precision::Double : DenseSymmetric::Precision::Single};
}

void ContactBlock::applyLocal(Eigen::VectorXd& t) const {
  for (std::size_t c = 0; c < unknowns_.size(); ++c) {
    if (active_[c].empty()) continue;
    Eigen::Map<Eigen::MatrixXd> part(t.data() + first_[c], Eigen::Index(unknowns_[c].size()), Eigen::Index(active_[c].size()));
    const Eigen::MatrixXd x = part;
    Eigen::MatrixXd y(x.rows(), x.cols());
    if (dense_[c].size() > 0) dense_[c].apply(x, y);
    else preconditioner_->applySchur(int(c), x, y);
    part = y;
  }
}

// part := B_D S B_D^T part between near rows, B_D without its gram factor
void ContactBlock::applyBetween(Eigen::VectorXd& part) const {
  const Eigen::Index owned = part.size();
  Eigen::VectorXd remote = remote_->fetch(part), t = Eigen::VectorXd::Zero(size_);
  const auto at = [&](Eigen::Index row) -> double& { return row < owned ? part[row] : remote[row - owned]; };
  for (const Entry& e : entries_) t[e.position] += e.value * at(e.row);
  applyLocal(t);
  part.setZero();
  remote.setZero();
  for (const Entry& e : entries_) at(e.row) += e.value * t[e.position];
  remote_->addToOwners(remote, part);
}

void ContactBlock::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  Eigen::VectorXd part(Eigen::Index(near_.size()));
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    {
      const auto in = x.getData(v);
      for (std::size_t i = 0; i < near_.size(); ++i) part[Eigen::Index(i)] = isContact_[i] ? in[near_[i]] : 0.0;
    }
    part = (gram_ * part).eval();
    applyBetween(part);
    part = (gram_ * part).eval();
    const auto out = y.getDataNonConst(v);
    for (auto& value : out) value = beta == 0 ? 0.0 : beta * value;
    for (std::size_t i = 0; i < near_.size(); ++i)
      if (isContact_[i]) out[near_[i]] += alpha * part[Eigen::Index(i)];
  }
}

void ContactRows::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    Vector z(getRangeMap());
    preconditioner_->applyOn(block_->activeMembers(), *x.getVector(v), z);
    y.getVectorNonConst(v)->update(alpha, z, beta);
  }
}

}  // namespace Haptos
