// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NeighbourStiffness.hpp"

#include <Tpetra_Map.hpp>
#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "Haptos_DualPreconditioner.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SurfaceOperators.hpp"

namespace Haptos {
namespace {

// A copy of an unknown.  Of the rows that glue an unknown's copies the last one meets them all: its number tells them that they are one.
struct Copy {
  GlobalOrdinal lastRow;
  int subdomain, place;  // global, among the subdomain's boundary unknowns
};

struct Holder {
  int subdomain, rank;
};

const std::vector<int>& boundaryOf(const DualPreconditioner& M, int local) { return M.surface().boundary(M.systems()[local].congruenceClass); }

// [overlap rows]; of rows of others their owners know the kind.  Collective.
std::vector<char> gluingRows(const MultiplierMap& multipliers) {
  Eigen::VectorXd own(Eigen::Index(multipliers.kinds().size()));
  for (Eigen::Index row = 0; row < own.size(); ++row) own[row] = multipliers.kinds()[std::size_t(row)] == RowKind::Gluing;
  const Eigen::VectorXd others = multipliers.remote().fetch(own);
  std::vector<char> marks(std::size_t(own.size() + others.size()));
  for (std::size_t row = 0; row < marks.size(); ++row)
    marks[row] = (Eigen::Index(row) < own.size() ? own[Eigen::Index(row)] : others[Eigen::Index(row) - own.size()]) != 0;
  return marks;
}

std::vector<Copy> copiesOf(const DualPreconditioner& M) {
  const MultiplierMap& multipliers = M.jump().multipliers();
  const std::vector<char> isGluing = gluingRows(multipliers);
  std::map<std::pair<int, int>, GlobalOrdinal> lastRows;  // by subdomain and unknown
  for (const auto& entry : multipliers.overlapEntries()) {
    if (!isGluing[std::size_t(entry.row)]) continue;
    const GlobalOrdinal row = multipliers.overlapMap()->getGlobalElement(entry.row);
    const auto [at, isNew] = lastRows.insert({{entry.subdomain, entry.dof}, row});
    if (!isNew) at->second = std::max(at->second, row);
  }
  std::vector<Copy> copies;
  for (const auto& [unknown, row] : lastRows) {
    const auto& boundary = boundaryOf(M, unknown.first - M.jump().firstSubdomain());
    const auto place = std::lower_bound(boundary.begin(), boundary.end(), unknown.second) - boundary.begin();
    copies.push_back({row, unknown.first, int(place)});
  }
  return copies;
}

// [copies] the subdomains of all copies of the same unknown, itself among them; each row is asked of one rank.  Collective.
std::vector<std::vector<Holder>> holdersOf(const Communicator& comm, const std::vector<Copy>& copies) {
  const auto rankOf = [&](const Copy& copy) { return int(copy.lastRow % comm.getSize()); };
  std::vector<std::size_t> countFrom;
  const std::vector<Copy> asked = sendItems(comm, copies, rankOf, &countFrom);
  std::map<GlobalOrdinal, std::vector<Holder>> holders;
  std::size_t at = 0;
  for (std::size_t rank = 0; rank < countFrom.size(); ++rank)
    for (std::size_t k = 0; k < countFrom[rank]; ++k, ++at) holders[asked[at].lastRow].push_back({asked[at].subdomain, int(rank)});
  std::vector<std::vector<Holder>> answers;
  for (const Copy& copy : asked) answers.push_back(holders[copy.lastRow]);
  const auto returned = sendAnswers(comm, answers, countFrom);
  std::vector<std::size_t> next(returned.size(), 0);
  std::vector<std::vector<Holder>> result;
  for (const Copy& copy : copies) result.push_back(returned[std::size_t(rankOf(copy))][next[std::size_t(rankOf(copy))]++]);
  return result;
}

// What a neighbour sends: of the unknowns that both have.
struct Message {
  int from = 0, to = 0;  // global subdomains
  std::vector<double> shares, lower;
  auto parts() { return std::tie(from, to, shares, lower); }
};

// v_i: what a subdomain's copies count for in the means; where they are held it is 0 but for round-off
Eigen::VectorXd ownShares(const CopyWeights& weights) { return (1 - Eigen::VectorXd(weights.col(0)).array()).cwiseMax(0.0).matrix(); }

std::vector<double> lowerTriangle(const Eigen::MatrixXd& S, const std::vector<int>& rows) {
  std::vector<double> lower;
  lower.reserve(rows.size() * (rows.size() + 1) / 2);
  for (std::size_t j = 0; j < rows.size(); ++j)
    for (std::size_t i = j; i < rows.size(); ++i) lower.push_back(S(rows[i], rows[j]));
  return lower;
}

}  // namespace

std::vector<std::vector<SharedBoundary>> sharedBoundaries(const DualPreconditioner& M) {
  const std::vector<Copy> copies = copiesOf(M);
  const auto holders = holdersOf(*M.getRangeMap()->getComm(), copies);
  std::vector<std::size_t> order(copies.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return copies[a].lastRow < copies[b].lastRow; });
  std::vector<std::map<int, SharedBoundary>> found(std::size_t(M.systems().size()));
  for (std::size_t k : order)
    for (const Holder& holder : holders[k]) {
      if (holder.subdomain == copies[k].subdomain) continue;
      SharedBoundary& shared = found[std::size_t(copies[k].subdomain - M.jump().firstSubdomain())][holder.subdomain];
      shared.neighbour = holder.subdomain;
      shared.rank = holder.rank;
      shared.unknowns.push_back(copies[k].place);
    }
  std::vector<std::vector<SharedBoundary>> all;
  for (auto& neighbours : found) {
    auto& list = all.emplace_back();
    for (auto& [neighbour, shared] : neighbours) list.push_back(std::move(shared));
  }
  return all;
}

// Subdomains of this rank look at each other's S, which is kept anyway; those of others get what both have.
NeighbourStiffness::NeighbourStiffness(const DualPreconditioner& M, const std::vector<Eigen::MatrixXd>& S)
    : M_(M), S_(S), weights_(copyWeights(M)), glued_(std::size_t(M.systems().size())) {
  const auto& comm = *M.getRangeMap()->getComm();
  const auto shared = sharedBoundaries(M);
  const int first = M.jump().firstSubdomain();
  const auto unknownsOf = [&](int subdomain, int neighbour) -> const std::vector<int>& {
    const auto& all = shared[std::size_t(subdomain - first)];
    return std::lower_bound(all.begin(), all.end(), neighbour, [](const SharedBoundary& b, int other) { return b.neighbour < other; })->unknowns;
  };
  std::vector<std::vector<Message>> messages(std::size_t(comm.getSize()));
  for (std::size_t i = 0; i < shared.size(); ++i) {
    const int mine = first + int(i);
    const Eigen::MatrixXd& Si = stiffnessOf(int(i));
    if (Si.size() == 0) continue;
    const Eigen::VectorXd v = ownShares(weights_[i]);
    for (const SharedBoundary& boundary : shared[i]) {
      std::vector<double> shares;
      for (int k : boundary.unknowns) shares.push_back(v[k]);
      if (boundary.rank == comm.getRank())
        glued_[std::size_t(boundary.neighbour - first)].push_back({mine, unknownsOf(boundary.neighbour, mine), std::move(shares), {}, boundary.unknowns});
      else messages[std::size_t(boundary.rank)].push_back({mine, boundary.neighbour, std::move(shares), lowerTriangle(Si, boundary.unknowns)});
    }
  }
  for (auto& received : exchangeValues(comm, messages))
    for (Message& message : received)
      glued_[std::size_t(message.to - first)].push_back(
          {message.from, unknownsOf(message.to, message.from), std::move(message.shares), std::move(message.lower), {}});
  for (auto& neighbours : glued_)  // sums in one order on any number of ranks
    std::sort(neighbours.begin(), neighbours.end(), [](const Neighbour& a, const Neighbour& b) { return a.subdomain < b.subdomain; });
}

const Eigen::MatrixXd& NeighbourStiffness::stiffnessOf(int local) const { return S_[std::size_t(M_.systems()[local].congruenceClass)]; }

// add(i, j, value) of the lower triangle of a neighbour's S between what it shares, column by column.
template <class Add>
void NeighbourStiffness::forEntries(const Neighbour& neighbour, Add&& add) const {
  const std::size_t n = neighbour.unknowns.size();
  const double* value = neighbour.lower.data();
  const bool isHere = !neighbour.places.empty();
  for (std::size_t j = 0; j < n; ++j) {
    const double* column = isHere ? stiffnessOf(neighbour.subdomain - M_.jump().firstSubdomain()).col(neighbour.places[j]).data() : nullptr;
    for (std::size_t i = j; i < n; ++i) add(i, j, isHere ? column[neighbour.places[i]] : *value++);
  }
}

// Columns of the copy weights without those whose S is known.
Eigen::MatrixXd NeighbourStiffness::weightsOfOthers(int subdomain, const Eigen::VectorXd& v) const {
  constexpr double kRoundOff = 1e-10;  // of a share
  Eigen::MatrixXd D = weights_[std::size_t(subdomain)], shares = D.cwiseAbs2();
  for (Eigen::Index k = 0; k < v.size(); ++k) shares.row(k) *= v[k] > 0 ? 1 / v[k] : 0.0;
  Eigen::MatrixXd left = shares;
  for (const Neighbour& neighbour : glued_[std::size_t(subdomain)])
    for (std::size_t k = 0; k < neighbour.unknowns.size(); ++k) left(neighbour.unknowns[k], columnOfCopies(neighbour.subdomain)) -= neighbour.shares[k];
  for (Eigen::Index k = 0; k < v.size(); ++k)
    for (Eigen::Index g = 1; g < D.cols(); ++g) D(k, g) = left(k, g) > kRoundOff * shares(k, g) ? std::sqrt(left(k, g) * v[k]) : 0.0;
  return D;
}

// (1 - v)_i S_i (1 - v)_i + sum over what it is glued to  v_i S_j v_i + S_i o (D D^T) of the others
Eigen::MatrixXd NeighbourStiffness::energy(int subdomain) const {
  const Eigen::MatrixXd& S = stiffnessOf(subdomain);
  const Eigen::VectorXd v = ownShares(weights_[std::size_t(subdomain)]);
  const Eigen::MatrixXd D = weightsOfOthers(subdomain, v);
  Eigen::MatrixXd A = S.cwiseProduct(D * D.transpose());
  for (const Neighbour& neighbour : glued_[std::size_t(subdomain)])
    forEntries(neighbour, [&](std::size_t i, std::size_t j, double value) {
      const int row = neighbour.unknowns[i], column = neighbour.unknowns[j];
      const double energy = v[row] * v[column] * value;
      A(row, column) += energy;
      if (i != j) A(column, row) += energy;
    });
  return A;
}

}  // namespace Haptos
