// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CoarseFront.hpp"

#include <Teuchos_BLAS.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <algorithm>
#include <cmath>
#include <limits>

#include "Haptos_DenseSymmetric.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

using BlockView = Eigen::Map<const Eigen::Matrix<double, kCoarseModes, kCoarseModes, Eigen::RowMajor>>;

// On one rank without MPI: many groups at the bottom of the tree are single ranks.
Eigen::MatrixXd sumOver(const Communicator& comm, const Eigen::MatrixXd& mine) {
  return comm.getSize() == 1 ? mine : sumOfAll(comm, mine);
}

Eigen::MatrixXd gathered(const Eigen::MatrixXd& x, const std::vector<int>& subdomains) {
  Eigen::MatrixXd part(kCoarseModes * Eigen::Index(subdomains.size()), x.cols());
  for (std::size_t i = 0; i < subdomains.size(); ++i)
    part.middleRows<kCoarseModes>(kCoarseModes * Eigen::Index(i)) = x.middleRows<kCoarseModes>(kCoarseModes * subdomains[i]);
  return part;
}

// C := C - A B^T, by BLAS
void subtractProduct(const Eigen::Ref<const Eigen::MatrixXd>& A, const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> C) {
  if (C.size() == 0) return;
  Teuchos::BLAS<int, double>().GEMM(Teuchos::NO_TRANS, Teuchos::TRANS, int(C.rows()), int(C.cols()), int(A.cols()), -1.0, A.data(),
                                    int(A.outerStride()), B.data(), int(B.outerStride()), 1.0, C.data(), int(C.outerStride()));
}

}  // namespace

CoarseFront::CoarseFront(RCP<const Communicator> group, std::vector<int> pivots, std::vector<int> rest)
    : group_(std::move(group)), pivots_(std::move(pivots)), rest_(std::move(rest)) {
  for (int i = 0; i < size(); ++i) place_.emplace(subdomain(i), i);
  makePanels();
}

// Three blocks a rank or more, so that all have work until near the end; up to 48 columns each, for the sake of the products.
void CoarseFront::makePanels() {
  constexpr int kBlocksOfRank = 3, kWidest = 8;
  const int width = std::clamp(size() / (kBlocksOfRank * group_->getSize()), 1, kWidest), pivots = int(pivots_.size());
  for (int i = 0; i < size(); i = std::min(i + width, i < pivots ? pivots : size())) starts_.push_back(i);
  starts_.push_back(size());
  for (std::size_t k = 0; k + 1 < starts_.size(); ++k) {
    const int first = starts_[k], count = starts_[k + 1] - first;
    if (ownerOf(first) == group_->getRank()) panels_.push_back({first, count, Eigen::MatrixXd::Zero(kCoarseModes * (size() - first), kCoarseModes * count), {}});
  }
}

int CoarseFront::ownerOf(int place) const {
  const auto block = std::upper_bound(starts_.begin(), starts_.end(), place) - starts_.begin() - 1;
  return int(block % group_->getSize());
}

CoarseFront::Panel& CoarseFront::panelOf(int place) {
  const auto after = std::upper_bound(panels_.begin(), panels_.end(), place, [](int p, const Panel& panel) { return p < panel.first; });
  return *std::prev(after);
}

// To the owner of the earlier column, turned over where that makes it a block of the lower triangle.
void CoarseFront::add(const std::vector<CoarseItem>& mine) {
  const auto column = [&](const CoarseItem& item) { return std::min(place_.at(item.s), place_.at(item.t)); };
  for (const auto& item : sendItems(*group_, mine, [&](const CoarseItem& item) { return ownerOf(column(item)); })) {
    const int s = place_.at(item.s), t = place_.at(item.t);
    Panel& panel = panelOf(std::min(s, t));
    auto to = panel.columns.block<kCoarseModes, kCoarseModes>(kCoarseModes * (std::max(s, t) - panel.first), kCoarseModes * (std::min(s, t) - panel.first));
    if (s >= t) to += BlockView(item.block.data());
    else to += BlockView(item.block.data()).transpose();
  }
}

// By blocks k of columns: their owner makes L_kk, what is below it, L_ik = A_ik L_kk^-T, and row k of W, L_kk^-1 (I_k - sum of L_kj W_j);
// all ranks take both off their own later columns and rows.  A message has the columns of W_k^T above those of L_ik.
bool CoarseFront::eliminate() {
  std::size_t next = 0;  // own panel
  for (std::size_t k = 0; k + 1 < starts_.size() && starts_[k] < int(pivots_.size()); ++k) {
    const int first = starts_[k], end = starts_[k + 1], owner = ownerOf(first);
    Eigen::MatrixXd message(kCoarseModes * size(), kCoarseModes * (end - first));
    // A failed factor is told by the message that all ranks wait for anyway.
    if (owner == group_->getRank() && !factorPanel(panels_[next++], message)) message(0, 0) = std::numeric_limits<double>::quiet_NaN();
    if (group_->getSize() > 1) Teuchos::broadcast(*group_, owner, int(message.size()), message.data());
    if (std::isnan(message(0, 0))) return false;
    for (std::size_t p = next; p < panels_.size(); ++p) update(panels_[p], message, first, end);
  }
  return true;
}

bool CoarseFront::factorPanel(Panel& panel, Eigen::MatrixXd& message) {
  const Eigen::Index w = kCoarseModes * panel.count, before = kCoarseModes * panel.first, below = panel.columns.rows() - w;
  Eigen::MatrixXd diagonal = panel.columns.topRows(w);
  if (!Lapack::choleskyInPlace(diagonal)) return false;
  const auto L = diagonal.triangularView<Eigen::Lower>();
  if (panel.W.size() == 0) panel.W = Eigen::MatrixXd::Zero(w, before + w);
  panel.W.rightCols(w).setIdentity();
  L.solveInPlace(panel.W);
  Eigen::MatrixXd lower = panel.columns.bottomRows(below);
  if (below > 0) diagonal.transpose().triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(lower);
  message.topRows(before + w) = panel.W.transpose();
  message.bottomRows(below) = lower;
  panel.columns = lower.bottomRows(kCoarseModes * Eigen::Index(rest_.size()));
  flops_ += double(w * w) * (double(w) / 6 + double(panel.W.cols()) / 2 + double(below) / 2);
  return true;
}

// A_ij -= L_ik L_jk^T, W_j -= L_jk W_k, for this panel j; rows of a message are places in the front.
void CoarseFront::update(Panel& panel, const Eigen::MatrixXd& message, int first, int end) {
  const Eigen::Index w = kCoarseModes * panel.count, rows = panel.columns.rows(), done = kCoarseModes * end;
  const auto Lj = message.middleRows(kCoarseModes * panel.first, w);
  subtractProduct(message.bottomRows(rows), Lj, panel.columns);
  flops_ += double(rows) * double(w) * double(message.cols());
  if (!isPivot(panel)) return;
  if (panel.W.size() == 0) panel.W = Eigen::MatrixXd::Zero(w, kCoarseModes * panel.first + w);
  subtractProduct(Lj, message.topRows(done), panel.W.leftCols(done));
  flops_ += double(done) * double(w) * double(kCoarseModes * (end - first));
}

std::vector<CoarseItem> CoarseFront::schur() const {
  std::vector<CoarseItem> items;
  for (const Panel& panel : panels_) {
    if (isPivot(panel)) continue;
    for (int t = 0; t < panel.count; ++t)
      for (int s = t; panel.first + s < size(); ++s) {
        CoarseItem item{subdomain(panel.first + s), subdomain(panel.first + t), {}};
        for (int a = 0; a < kCoarseModes; ++a)
          for (int b = 0; b < kCoarseModes; ++b)  // of a block on the diagonal the lower triangle is what there is
            item.block[std::size_t(a * kCoarseModes + b)] =
                panel.columns(kCoarseModes * s + (s == t ? std::max(a, b) : a), kCoarseModes * t + (s == t ? std::min(a, b) : b));
        items.push_back(item);
      }
  }
  return items;
}

Eigen::MatrixXd CoarseFront::sumPivots(const Eigen::MatrixXd& b) const { return sumOver(*group_, gathered(b, pivots_)); }

// W b_p, rows of this rank; 0 in others
Eigen::MatrixXd CoarseFront::applyW(const Eigen::MatrixXd& bp) const {
  Eigen::MatrixXd y = Eigen::MatrixXd::Zero(bp.rows(), bp.cols());
  for (const Panel& panel : panels_)
    if (isPivot(panel)) y.middleRows(kCoarseModes * panel.first, kCoarseModes * panel.count).noalias() = panel.W * bp.topRows(panel.W.cols());
  return y;
}

// W^T z, z's rows of this rank, summed over the group
Eigen::MatrixXd CoarseFront::applyWTransposed(const Eigen::MatrixXd& z) const {
  Eigen::MatrixXd mine = Eigen::MatrixXd::Zero(z.rows(), z.cols());
  for (const Panel& panel : panels_)
    if (isPivot(panel)) mine.topRows(panel.W.cols()).noalias() += panel.W.transpose() * z.middleRows(kCoarseModes * panel.first, kCoarseModes * panel.count);
  return sumOver(*group_, mine);
}

Eigen::MatrixXd CoarseFront::solve(const Eigen::MatrixXd& bp) const { return applyWTransposed(applyW(bp)); }

Eigen::MatrixXd CoarseFront::forward(const Eigen::MatrixXd& bp, Eigen::MatrixXd& b) const {
  const Eigen::MatrixXd y = applyW(bp);
  Eigen::MatrixXd taken = Eigen::MatrixXd::Zero(kCoarseModes * Eigen::Index(rest_.size()), bp.cols());
  for (const Panel& panel : panels_)
    if (isPivot(panel)) taken.noalias() += panel.columns * y.middleRows(kCoarseModes * panel.first, kCoarseModes * panel.count);
  for (std::size_t i = 0; i < rest_.size(); ++i) b.middleRows<kCoarseModes>(kCoarseModes * rest_[i]) -= taken.middleRows<kCoarseModes>(kCoarseModes * Eigen::Index(i));
  return y;
}

void CoarseFront::backward(const Eigen::MatrixXd& y, Eigen::MatrixXd& x) const {
  const Eigen::MatrixXd xu = gathered(x, rest_);
  Eigen::MatrixXd z = y;
  for (const Panel& panel : panels_)
    if (isPivot(panel)) z.middleRows(kCoarseModes * panel.first, kCoarseModes * panel.count).noalias() -= panel.columns.transpose() * xu;
  const Eigen::MatrixXd xp = applyWTransposed(z);
  for (std::size_t i = 0; i < pivots_.size(); ++i) x.middleRows<kCoarseModes>(kCoarseModes * pivots_[i]) = xp.middleRows<kCoarseModes>(kCoarseModes * Eigen::Index(i));
}

// Of W and L_rp: what a solve reads.
std::size_t CoarseFront::entries() const {
  Eigen::Index count = 0;
  for (const Panel& panel : panels_)
    if (isPivot(panel)) count += panel.W.size() + panel.columns.size();
  return std::size_t(count);
}

}  // namespace Haptos
