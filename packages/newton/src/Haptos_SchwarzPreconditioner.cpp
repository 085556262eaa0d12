// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SchwarzPreconditioner.hpp"

#include <Eigen/LU>
#include <utility>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

struct Member {
  std::size_t group;
  Eigen::Index pair;  // among those of all ranks
  bool isOwn;
};

std::vector<Member> membersOf(const std::vector<PairGroup>& groups, Eigen::Index firstPair) {
  std::vector<Member> members;
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t k = 0; k < groups[g].pairs.size(); ++k) members.push_back({g, firstPair + groups[g].pairs[k], groups[g].isOwn[k] != 0});
  return members;
}

// A M + B.  Motions of a whole group that nothing resists are left to others: a little stiffness keeps them finite.  Rows of which M has nothing
// are those of no multiplier.
Eigen::MatrixXd matrixOf(double scaling, const Eigen::MatrixXd& M, const Eigen::MatrixXd& blocks) {
  constexpr double kLittle = 1e-8;
  Eigen::MatrixXd scaled = scaling * M, G(M.rows(), M.cols());
  for (double& value : scaled.diagonal()) value = value > 0 ? (1 + kLittle) * value : 1.0;
  for (Eigen::Index at = 0; at < G.rows(); at += 3) {
    G.middleRows<3>(at).noalias() = blocks.block<3, 3>(at, 0) * scaled.middleRows<3>(at);
    G.block<3, 3>(at, at) += blocks.block<3, 3>(at, 3);
  }
  return G;
}

// Rows `own` of G^-1, by a factor of the rows that pairs do not solve by themselves: d_r = G_rr^-1 (r_r - G_rk B_k^-1 r_k).
Eigen::MatrixXd rowsOfInverse(const Eigen::MatrixXd& G, const Eigen::MatrixXd& blocks, const std::vector<Eigen::Index>& own) {
  std::vector<Eigen::Index> known, rest, ownRest, ownAt;  // ownRest: positions in rest, ownAt: in own
  std::vector<Eigen::Index> place(std::size_t(G.rows()), -1);
  for (Eigen::Index row = 0; row < G.rows(); ++row) {
    if (isKnown(blocks, row)) known.push_back(row);
    else place[std::size_t(row)] = Eigen::Index(rest.size()), rest.push_back(row);
  }
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(Eigen::Index(own.size()), G.cols());
  for (std::size_t k = 0; k < own.size(); ++k) {
    const Eigen::Index row = own[k];
    if (place[std::size_t(row)] < 0) rows(Eigen::Index(k), row) = 1 / blocks(row, 3 + row % 3);
    else ownRest.push_back(place[std::size_t(row)]), ownAt.push_back(Eigen::Index(k));
  }
  if (ownRest.empty()) return rows;
  Eigen::MatrixXd units = Eigen::MatrixXd::Zero(Eigen::Index(rest.size()), Eigen::Index(ownRest.size()));
  for (std::size_t k = 0; k < ownRest.size(); ++k) units(ownRest[k], Eigen::Index(k)) = 1;
  const Eigen::MatrixXd ofRest = DenseFactor(G(rest, rest), DenseFactor::Kind::Lu).solveTransposed(std::move(units)).transpose();
  rows(ownAt, rest) = ofRest;
  if (known.empty()) return rows;
  Eigen::MatrixXd ofKnown = -(ofRest * G(rest, known));
  for (std::size_t k = 0; k < known.size(); ++k) ofKnown.col(Eigen::Index(k)) /= blocks(known[k], 3 + known[k] % 3);
  rows(ownAt, known) = ofKnown;
  return rows;
}

// G^-1, or where round-off leaves G not positive that of each pair by itself.
Eigen::MatrixXd symmetricInverse(const Eigen::MatrixXd& G) {
  Eigen::MatrixXd inverse = inverseByCholesky(G);
  if (inverse.size() > 0) return inverse;
  inverse = Eigen::MatrixXd::Zero(G.rows(), G.cols());
  for (Eigen::Index at = 0; at < G.rows(); at += 3) inverse.block<3, 3>(at, at) = G.block<3, 3>(at, at).inverse();
  return inverse;
}

}  // namespace

SchwarzPreconditioner::SchwarzPreconditioner(const ContactNumbering& numbering, Groups groups, Form form) : numbering_(numbering), form_(form) {
  findValues(groups.members);
  for (std::size_t g = 0; g < groups_.size(); ++g)
    if (isHeld(g)) groups_[g].M = std::move(groups.M[g]);
}

SchwarzPreconditioner::SchwarzPreconditioner(const ContactNumbering& numbering, const std::vector<PairGroup>& members, const Eigen::MatrixXd& M)
    : numbering_(numbering), form_(Form::Restricted) {
  findValues(members);
  for (std::size_t g = 0; g < groups_.size(); ++g)
    if (isHeld(g)) groups_[g].M = M(groups_[g].values, groups_[g].values);
}

void SchwarzPreconditioner::findValues(const std::vector<PairGroup>& members) {
  groups_.resize(members.size());
  shares_ = Eigen::VectorXd::Zero(numbering_.size());
  for (const Member& member : gatheredOnAll(numbering_.vectors().comm(), membersOf(members, numbering_.first() / 3))) {
    Group& group = groups_[member.group];
    for (Eigen::Index value = 3 * member.pair; value < 3 * member.pair + 3; ++value) {
      if (member.isOwn) group.own.push_back(Eigen::Index(group.values.size())), group.ownValues.push_back(value);
      group.values.push_back(value);
      shares_[value] += 1;
    }
  }
  shares_ = shares_.cwiseSqrt().cwiseInverse();
}

SchwarzPreconditioner SchwarzPreconditioner::withForm(Form form) const {
  SchwarzPreconditioner other = *this;
  other.form_ = form;
  for (Group& group : other.groups_) group.blocks.resize(0, 0);
  return other;
}

Eigen::MatrixXd SchwarzPreconditioner::inverseOf(const Group& group, const Eigen::MatrixXd& blocks) const {
  const Eigen::MatrixXd G = matrixOf(scaling_, group.M, blocks);
  if (form_ == Form::Restricted) return rowsOfInverse(G, blocks, group.own);
  const Eigen::VectorXd D = shares_(group.values);
  return D.asDiagonal() * symmetricInverse(G) * D.asDiagonal();
}

bool SchwarzPreconditioner::isHeld(std::size_t group) const {
  const Communicator& comm = numbering_.vectors().comm();
  return group % std::size_t(comm.getSize()) == std::size_t(comm.getRank());
}

bool SchwarzPreconditioner::renew(double scaling, const Eigen::MatrixXd& blocks) {
  const bool isScaled = std::exchange(scaling_, scaling) != scaling;
  bool isAny = false;
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    Group& group = groups_[g];
    Eigen::MatrixXd now = blocks(group.values, Eigen::all);
    bool isSame = !isScaled && group.blocks.rows() == now.rows();
    for (Eigen::Index at = 0; at < now.rows() && isSame; at += 3) isSame = !hasChanged(group.blocks.middleRows<3>(at), now.middleRows<3>(at));
    if (isSame) continue;
    isAny = true;
    if (isHeld(g)) group.inverse = inverseOf(group, now);
    group.blocks = std::move(now);
  }
  return isAny;
}

double SchwarzPreconditioner::entriesRead() const {
  double sum = 0;
  for (const Group& group : groups_) sum += double(form_ == Form::Restricted ? group.own.size() : group.values.size()) * double(group.values.size());
  return sum;
}

Eigen::MatrixXd SchwarzPreconditioner::apply(const Eigen::MatrixXd& r) const {
  const Eigen::MatrixXd all = numbering_.onAllRanks(r);
  Eigen::MatrixXd z = Eigen::MatrixXd::Zero(all.rows(), all.cols());
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    if (!isHeld(g)) continue;
    const Group& group = groups_[g];
    const Eigen::MatrixXd part = all(group.values, Eigen::all);
    z(form_ == Form::Restricted ? group.ownValues : group.values, Eigen::all) += product(group.inverse, part);
  }
  numbering_.vectors().sum(z);
  return z.middleRows(numbering_.first(), numbering_.mine());
}

}  // namespace Haptos
