// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoarseTree.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <numeric>
#include <set>
#include <stdexcept>

#include "Haptos_DenseSymmetric.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

template <class T>
void keepEachOnce(std::vector<T>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

void requireDefinite(const Communicator& comm, bool isDefinite, Eigen::Index unknowns) {
  TEUCHOS_TEST_FOR_EXCEPTION(leastOfAll(comm, int(isDefinite)) == 0, std::runtime_error, "the coarse matrix of " << unknowns << " unknowns is not positive definite");
}

std::vector<CoarseItem> itemsOf(const CoarseSchur::Parts& parts) {
  std::vector<CoarseItem> items;
  for (const CoarseBlocks* part : parts)
    for (const auto& [key, block] : part->blocks()) items.push_back({CoarseBlocks::row(key), CoarseBlocks::column(key), block});
  return items;
}

// S of a rank's own elimination in blocks; `subdomains` are those that it is in, by their place in `own`, and one more.
std::vector<CoarseItem> takeSchur(CoarseSchur& own, const std::vector<int>& subdomains) {
  Eigen::MatrixXd S(own.numLast(), own.numLast());
  Lapack::unpackLower(own.takeSchur(), S);
  S.triangularView<Eigen::StrictlyUpper>() = S.transpose();
  std::vector<int> names;  // of the blocks of S
  for (std::size_t i = own.order().size() - std::size_t(own.numLast()); i < own.order().size(); i += kCoarseModes) {
    const std::size_t place = std::size_t(own.order()[i] / kCoarseModes);
    names.push_back(place < subdomains.size() ? subdomains[place] : -1);
  }
  std::vector<CoarseItem> items;
  for (std::size_t s = 0; s < names.size(); ++s)
    for (std::size_t t = 0; t <= s; ++t) {
      if (names[s] < 0 || names[t] < 0) continue;
      CoarseItem item{names[s], names[t], {}};
      Eigen::Map<Eigen::Matrix<double, kCoarseModes, kCoarseModes, Eigen::RowMajor>>(item.block.data()) =
          S.block<kCoarseModes, kCoarseModes>(kCoarseModes * Eigen::Index(s), kCoarseModes * Eigen::Index(t));
      items.push_back(item);
    }
  return items;
}

}  // namespace

EliminationOrder::EliminationOrder(const CoarsePlacement& placement, int subdomains, const CoarseSchur::Parts& couplings, const std::vector<int>& last)
    : ranks_(placement.comm().getSize()), depth_(std::size_t(subdomains), kHome) {
  // Everything is eliminated at home but where a block couples subdomains of two ranks: those of one side must wait.
  for (int s : last) depth_[std::size_t(s)] = kLast;
  std::vector<std::vector<Pair>> byDepth;
  for (const Pair& pair : crossing(placement.comm(), couplings)) {
    const auto depth = std::size_t(parting(pair));
    if (byDepth.size() <= depth) byDepth.resize(depth + 1);
    byDepth[depth].push_back(pair);
  }
  for (std::size_t d = 0; d < byDepth.size(); ++d) cover(std::move(byDepth[d]), int(d));
}

// Couplings between ranks of subdomains that are not last, of all ranks.
std::vector<EliminationOrder::Pair> EliminationOrder::crossing(const Communicator& comm, const CoarseSchur::Parts& couplings) const {
  std::vector<Pair> pairs;
  for (const CoarseBlocks* part : couplings)
    for (const auto& [key, block] : part->blocks()) {
      const int s = CoarseBlocks::row(key), t = CoarseBlocks::column(key);
      if (homeOf(s) != homeOf(t) && depthOf(s) != kLast && depthOf(t) != kLast) pairs.push_back({s, t});
    }
  keepEachOnce(pairs);
  pairs = gatheredOnAll(comm, pairs);
  keepEachOnce(pairs);
  return pairs;
}

// Depth of the smallest group with both homes.
int EliminationOrder::parting(const Pair& pair) const {
  const int a = homeOf(pair[0]), b = homeOf(pair[1]);
  int depth = 0;
  for (RankRange range{0, ranks_}; range.half(a).begin == range.half(b).begin; range = range.half(a)) ++depth;
  return depth;
}

// Pairs that larger groups keep apart already are left out.
void EliminationOrder::cover(std::vector<Pair> pairs, int depth) {
  pairs.erase(std::remove_if(pairs.begin(), pairs.end(), [&](const Pair& p) { return !staysHome(p[0]) || !staysHome(p[1]); }), pairs.end());
  std::unordered_map<int, std::vector<int>> others;
  for (const auto& [s, t] : pairs) {
    others[s].push_back(t);
    others[t].push_back(s);
  }
  // A small cover of the pairs by greed: who has most of them waits, until none is left.
  // What waits is eliminated by the group as a dense front.
  std::set<Pair> open;  // (- pairs left, subdomain)
  std::unordered_map<int, int> left;
  for (const auto& [s, list] : others) {
    left[s] = int(list.size());
    open.insert({-left[s], s});
  }
  while (!open.empty() && (*open.begin())[0] < 0) {
    const int s = (*open.begin())[1];
    open.erase(open.begin());
    depth_[std::size_t(s)] = depth;
    for (int t : others[s]) {
      if (open.erase({-left[t], t}) > 0) open.insert({-(--left[t]), t});
    }
  }
}

CoarseTree::CoarseTree(const CoarsePlacement& placement, Eigen::Index unknowns, const CoarseSchur::Parts& A, std::vector<int> last)
    : comm_(placement.comm()), size_(unknowns), last_(Teuchos::rcpFromRef(comm_), std::move(last), {}) {
  const EliminationOrder order(placement, int(size_) / kCoarseModes, A, last_.pivots());
  eliminateShared(placement, order, eliminateOwn(comm_, order, A));
}

// Inner subdomains come first, then the outer ones: all others in the blocks that are sent here.
std::vector<CoarseItem> CoarseTree::eliminateOwn(const Communicator& comm, const EliminationOrder& order, const CoarseSchur::Parts& A) {
  // A_ii, A_io and A_oo of the rank that eliminates i; blocks between outer subdomains go to one of their homes.
  const auto blocks = sendItems(comm, itemsOf(A), [&](const CoarseItem& item) { return order.rankOfBlock(item.s, item.t); });
  for (int s = 0; s < int(size_) / kCoarseModes; ++s) {
    if (order.homeOf(s) != comm.getRank()) continue;
    home_.push_back(s);
    if (order.staysHome(s)) inner_.push_back(s);
  }
  for (const auto& item : blocks)
    for (int s : {item.s, item.t})
      if (!order.staysHome(s)) outer_.push_back(s);
  keepEachOnce(outer_);
  std::vector<int> subdomains = inner_;
  subdomains.insert(subdomains.end(), outer_.begin(), outer_.end());
  std::unordered_map<int, int> place;
  for (std::size_t i = 0; i < subdomains.size(); ++i) place.emplace(subdomains[i], int(i));
  CoarseBlocks own;
  for (const auto& item : blocks) own.add(place.at(item.s), place.at(item.t), item.block);
  CoarseBlocks::Block one{};
  for (std::size_t i = 0; i < one.size(); i += kCoarseModes + 1) one[i] = 1;
  const int extra = int(subdomains.size());  // CoarseSchur wants at least one that stays
  own.add(extra, extra, one);
  std::vector<int> last(outer_.size() + 1);
  std::iota(last.begin(), last.end(), int(inner_.size()));
  runOnAllRanks(comm, [&] { own_ = std::make_unique<CoarseSchur>(kCoarseModes * (extra + 1), CoarseSchur::Parts{&own}, last); });
  return takeSchur(*own_, subdomains);
}

// From the smallest group up; what is left of a group's matrix is spread over the next larger one.
void CoarseTree::eliminateShared(const CoarsePlacement& placement, const EliminationOrder& order, std::vector<CoarseItem> left) {
  bool isDefinite = true;
  std::vector<int> rest = outer_;
  for (int depth = int(placement.groups().size()) - 1; depth >= 0; --depth) {
    const auto& group = placement.groups()[std::size_t(depth)];
    std::vector<int> all = gatheredOnAll(*group, rest), pivots;
    keepEachOnce(all);
    rest.clear();
    for (int s : all) (order.depthOf(s) == depth ? pivots : rest).push_back(s);
    CoarseFront front(group, pivots, rest);
    front.add(left);
    isDefinite = front.eliminate() && isDefinite;
    // S = A_rr - L_rp L_rp^T, in blocks on the ranks of the group, is what the next larger group adds up.
    left = front.schur();
    fronts_.push_back(std::move(front));
  }
  std::reverse(fronts_.begin(), fronts_.end());
  requireDefinite(comm_, isDefinite, size_);
  last_.add(left);
}

// Each rank starts with b of the subdomains at home there; b_u of the fronts is added up as it is needed.
CoarseTree::Eliminated CoarseTree::eliminate(const Eigen::MatrixXd& b) const {
  Eliminated result;
  Eigen::MatrixXd mine = Eigen::MatrixXd::Zero(b.rows(), b.cols());
  for (int s : home_) mine.middleRows<kCoarseModes>(kCoarseModes * s) = b.middleRows<kCoarseModes>(kCoarseModes * s);
  Eigen::MatrixXd own = Eigen::MatrixXd::Zero(Eigen::Index(own_->order().size()), b.cols());
  for (std::size_t i = 0; i < inner_.size(); ++i) own.middleRows<kCoarseModes>(kCoarseModes * Eigen::Index(i)) = b.middleRows<kCoarseModes>(kCoarseModes * inner_[i]);
  // y_i = L_ii^-1 b_i, and b_o - L_oi y_i is what this rank says of outer unknowns.
  result.own = own_->eliminate(own);
  for (Eigen::Index i = own.rows() - own_->numLast(); i < own.rows(); ++i) {
    const int unknown = own_->order()[std::size_t(i)], place = unknown / kCoarseModes - int(inner_.size());
    if (place < int(outer_.size())) mine.row(kCoarseModes * outer_[std::size_t(place)] + unknown % kCoarseModes) += result.own.row(i);
  }
  result.fronts.resize(fronts_.size());
  for (std::size_t d = fronts_.size(); d-- > 0;) result.fronts[d] = fronts_[d].forward(fronts_[d].sumPivots(mine), mine);
  result.last = last_.sumPivots(mine);
  return result;
}

Eigen::MatrixXd CoarseTree::substituteBack(const Eliminated& b, const Eigen::MatrixXd& last) const {
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(size_, last.cols());
  const auto put = [&](const std::vector<int>& subdomains, const Eigen::MatrixXd& from, Eigen::MatrixXd& to) {
    for (std::size_t i = 0; i < subdomains.size(); ++i)
      to.middleRows<kCoarseModes>(kCoarseModes * subdomains[i]) = from.middleRows<kCoarseModes>(kCoarseModes * Eigen::Index(i));
  };
  put(last_.pivots(), last, x);
  // x_p = L_pp^-T (y_p - L_rp^T x_r), largest group first, as its unknowns are in the r of all smaller ones.
  for (std::size_t d = 0; d < fronts_.size(); ++d) fronts_[d].backward(b.fronts[d], x);
  Eigen::MatrixXd own = b.own;
  for (Eigen::Index i = own.rows() - own_->numLast(); i < own.rows(); ++i) {
    const int unknown = own_->order()[std::size_t(i)], place = unknown / kCoarseModes - int(inner_.size());
    if (place < int(outer_.size())) own.row(i) = x.row(kCoarseModes * outer_[std::size_t(place)] + unknown % kCoarseModes);
    else own.row(i).setZero();
  }
  put(inner_, own_->substituteBack(own), x);
  Eigen::MatrixXd mine = Eigen::MatrixXd::Zero(size_, last.cols());  // every subdomain from its home
  for (int s : home_) mine.middleRows<kCoarseModes>(kCoarseModes * s) = x.middleRows<kCoarseModes>(kCoarseModes * s);
  return sumOfAll(comm_, mine);
}

std::size_t CoarseTree::entries() const {
  std::size_t sum = own_->entries();
  for (const auto& front : fronts_) sum += front.entries();
  return sum;
}

long CoarseTree::between() const {
  long sum = 0;
  for (const auto& front : fronts_) sum += kCoarseModes * long(front.pivots().size());
  return sum;
}

double CoarseTree::flops() const {
  double sum = own_->flops();
  for (const auto& front : fronts_) sum += front.flops();
  return sum;
}

void CoarseTreeFactor::renew(const CoarseBlocks& E) {
  last_ = tree_->last();
  // Only the last front changes: whatever is eliminated before it stays from renewal to renewal.
  last_.add(itemsOf({&E}));
  const bool isDefinite = last_.eliminate();  // the same on all ranks
  TEUCHOS_TEST_FOR_EXCEPTION(!isDefinite, std::runtime_error,
                             "the coarse matrix is not positive definite in the " << kCoarseModes * last_.pivots().size() << " unknowns that change");
}

Eigen::MatrixXd CoarseTreeFactor::solve(const Eigen::MatrixXd& b) const {
  const CoarseTree::Eliminated eliminated = tree_->eliminate(b);
  return tree_->substituteBack(eliminated, solveLast(eliminated.last));
}

// x = W^T W b
Eigen::MatrixXd CoarseTreeFactor::solveLast(const Eigen::MatrixXd& b) const { return last_.solve(b); }

}  // namespace Haptos
