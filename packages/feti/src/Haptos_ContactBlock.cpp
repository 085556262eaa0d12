// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContactBlock.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "Haptos_LocalSystems.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SurfaceOperators.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

// What some rank marks, all ranks that have the row see; [overlap rows].  Collective.
std::vector<char> shareMarks(const MultiplierMap& multipliers, const std::vector<char>& mine) {
  const RemoteRows& remoteRows = multipliers.remote();
  const Eigen::Index owned = Eigen::Index(remoteRows.numOwned());
  const Eigen::VectorXd marks = Eigen::Map<const Eigen::Matrix<char, Eigen::Dynamic, 1>>(mine.data(), Eigen::Index(mine.size())).cast<double>();
  Eigen::VectorXd own = marks.head(owned);
  remoteRows.addToOwners(marks.tail(marks.size() - owned), own);
  const Eigen::VectorXd others = remoteRows.fetch(own);
  std::vector<char> all;
  for (double mark : own) all.push_back(mark != 0);
  for (double mark : others) all.push_back(mark != 0);
  return all;
}

// Where `some` stand in `all`; both ascend.
std::vector<int> positionsIn(const std::vector<int>& all, const std::vector<int>& some) {
  std::vector<int> positions;
  for (int row : some) positions.push_back(int(std::lower_bound(all.begin(), all.end(), row) - all.begin()));
  return positions;
}

// Rows of X at some positions of longer columns, 0 elsewhere
Eigen::MatrixXd extended(const Eigen::MatrixXd& X, const std::vector<int>& positions, std::size_t size) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(Eigen::Index(size), X.cols());
  all(positions, Eigen::all) = X;
  return all;
}

Eigen::VectorXd restricted(const Eigen::VectorXd& all, const std::vector<int>& positions) { return all(positions); }

// A copy of this rank's entries, [rows x columns].
Eigen::MatrixXd matrixOf(const MultiVector& x) {
  Eigen::MatrixXd X(Eigen::Index(x.getLocalLength()), Eigen::Index(x.getNumVectors()));
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    const auto data = x.getData(v);
    std::copy(data.begin(), data.end(), X.col(Eigen::Index(v)).data());
  }
  return X;
}

// y := beta y + alpha x
void update(const Teuchos::ArrayRCP<double>& y, double beta, double alpha, const Eigen::VectorXd& x) {
  for (Eigen::Index i = 0; i < x.size(); ++i) y[i] = (beta == 0 ? 0.0 : beta * y[i]) + alpha * x[i];
}

}  // namespace

ContactBlock::ContactBlock(RCP<const DualPreconditioner> preconditioner) : preconditioner_(std::move(preconditioner)) {
  findUnknowns(findNearRows());
  contact_ = positionsIn(pairs().rows(), preconditioner_->jump().multipliers().contactRows());
  nearPairs_ = positionsIn(pairs().rows(), near_->rows());
}

// Rows of couplings that meet contact rows at a node: their Gram matrix couples those and no others.
std::vector<char> ContactBlock::findNearRows() {
  const MultiplierMap& multipliers = preconditioner_->jump().multipliers();
  std::vector<char> marks(localNumElements(*multipliers.overlapMap()), 0);
  for (const Coupling& coupling : multipliers.couplings())
    for (int row : coupling.rows)
      if (row >= 0 && coupling.meetsContact) marks[std::size_t(row)] = 1;
  return shareMarks(multipliers, marks);
}

// The unknowns of the nodes of near rows; the compact vector holds those of a class's active members one after another.
void ContactBlock::findUnknowns(const std::vector<char>& isNear) {
  const JumpOperator& jump = preconditioner_->jump();
  std::vector<std::set<int>> nodes(jump.primalOffsets().size() - 1);
  for (const auto& entry : jump.multipliers().overlapEntries())
    if (isNear[std::size_t(entry.row)]) nodes[std::size_t(entry.subdomain - jump.firstSubdomain())].insert(entry.dof / 3);

  const auto& members = preconditioner_->systems().members();
  unknowns_.resize(members.size());
  dense_.resize(members.size());
  active_.resize(members.size());
  Eigen::Index size = 0;
  std::vector<Eigen::Index> offset(nodes.size(), -1);
  std::vector<std::vector<int>> positionOf(members.size());  // local dof -> position in the list
  for (std::size_t c = 0; c < members.size(); ++c) {
    std::set<int> all;
    for (int member : members[c]) all.insert(nodes[std::size_t(member)].begin(), nodes[std::size_t(member)].end());
    const auto& boundary = preconditioner_->surface().boundary(int(c));
    const bool isDense = 3 * all.size() <= std::size_t(kLargestDense);
    for (std::size_t i = 0; i < boundary.size() && !all.empty(); ++i) {
      if (isDense && all.count(boundary[i] / 3) == 0) continue;
      positionOf[c].resize(std::max(positionOf[c].size(), std::size_t(boundary[i]) + 1), -1);
      positionOf[c][std::size_t(boundary[i])] = int(unknowns_[c].size());
      unknowns_[c].push_back(int(i));
    }
    if (isDense && !all.empty()) dense_[c] = denseBlock(int(c));
    first_.push_back(size);
    for (int member : members[c]) {
      if (nodes[std::size_t(member)].empty()) continue;
      offset[std::size_t(member)] = size;
      size += Eigen::Index(unknowns_[c].size());
      active_[c].push_back(member);
    }
  }
  const auto place = [&](int subdomain, int dof) {
    const int member = subdomain - jump.firstSubdomain();
    return offset[std::size_t(member)] + positionOf[std::size_t(preconditioner_->systems()[member].congruenceClass)][std::size_t(dof)];
  };
  std::map<std::pair<int, int>, double> stiffness;  // mean over the copies: an entry is 1 / copies of what its row has at the node
  for (const auto& copy : jump.multipliers().coupledCopies()) stiffness[{copy.subdomain, copy.localNode}] = copy.meanStiffness;
  near_ = std::make_unique<CompactRows>(jump.multipliers(), isNear, size, place, [&](const MultiplierMap::OverlapEntry& entry) {
    return 1.0 / stiffness.at({entry.subdomain, entry.dof / 3});
  });
}

// Single precision wherever M itself has it: the block is read ten times an iteration.
// S_cc of all contact nodes of the class' members.
DenseSymmetric ContactBlock::denseBlock(int congruenceClass) const {
  constexpr std::size_t kSmall = 200;  // unknowns: a full product takes a third of the time of a packed one
  const auto& unknowns = unknowns_[std::size_t(congruenceClass)];
  const bool shared = preconditioner_->systems().members()[std::size_t(congruenceClass)].size() > 1;
  return {preconditioner_->surface().block(congruenceClass, unknowns),
          shared || unknowns.size() <= kSmall ? DenseSymmetric::Storage::Full : DenseSymmetric::Storage::Packed,
          preconditioner_->surface().isDouble(congruenceClass) ? DenseSymmetric::Precision::Double : DenseSymmetric::Precision::Single};
}

// T := S_cc T class by class, the members of a class and all columns side by side: one product for all of them that are not zero.
void ContactBlock::applyLocal(Eigen::MatrixXd& T) const {
  for (std::size_t c = 0; c < unknowns_.size(); ++c) {
    const Eigen::Index n = Eigen::Index(unknowns_[c].size());
    std::vector<double*> filled;
    for (Eigen::Index v = 0; v < T.cols(); ++v)
      for (std::size_t k = 0; k < active_[c].size(); ++k) {
        double* part = &T(first_[c] + Eigen::Index(k) * n, v);
        if (std::any_of(part, part + n, [](double value) { return value != 0; })) filled.push_back(part);
      }
    if (filled.empty()) continue;
    Eigen::MatrixXd x(n, Eigen::Index(filled.size())), y(n, Eigen::Index(filled.size()));
    for (std::size_t j = 0; j < filled.size(); ++j) std::copy_n(filled[j], n, x.col(Eigen::Index(j)).data());
    if (dense_[c].size() > 0) dense_[c].apply(x, y);
    else preconditioner_->surface().apply(int(c), x, y);
    for (std::size_t j = 0; j < filled.size(); ++j) std::copy_n(y.col(Eigen::Index(j)).data(), n, filled[j]);
  }
}

// Symmetric ones, packed.  Where S is applied by its factor that is taken for as much as S_cc would be.
double ContactBlock::entriesRead() const {
  double sum = 0;
  for (std::size_t c = 0; c < unknowns_.size(); ++c) sum += 0.5 * double(active_[c].size()) * double(unknowns_[c].size()) * double(unknowns_[c].size());
  return sum + 2 * pairs().entriesRead();
}

// B_D^T X at the unknowns of contact nodes
Eigen::MatrixXd ContactBlock::spread(const Eigen::MatrixXd& X) const {
  return near_->spread(pairs().solve(extended(X, contact_, pairs().rows().size()))(nearPairs_, Eigen::all));
}

// M_cc x = B_D S B_D^T x, both ends on contact rows: the inverse of their Gram matrix, B^T to the unknowns of contact nodes, S
// between those, and back.
void ContactBlock::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  Eigen::MatrixXd T = spread(matrixOf(x));
  applyLocal(T);
  const Eigen::MatrixXd result = pairs().solve(extended(near_->collect(T), nearPairs_, pairs().rows().size()));
  for (Eigen::Index v = 0; v < T.cols(); ++v) update(y.getDataNonConst(std::size_t(v)), beta, alpha, restricted(result.col(v), contact_));
}

// B V S V B^T of near rows: every row reaches few unknowns
Eigen::MatrixXd ContactBlock::energiesOfNearRows() const {
  const auto& comm = *getDomainMap()->getComm();
  const int mine = int(near_->rows().size()), before = sumOfLower(comm, mine), all = sumOfAll(comm, mine);
  std::vector<int> columns(static_cast<std::size_t>(all));
  std::iota(columns.begin(), columns.end(), 0);
  Eigen::MatrixXd E = Eigen::MatrixXd::Zero(all, all);
  addEnergies(near_->spreads(Eigen::VectorXd::LinSpaced(mine, before, before + mine - 1), all), columns, E);
  return sumOfAll(comm, E);
}

// Contact rows of G^-1 X, of all ranks, X of near rows of all; some columns at a time, which stay in the cache.
Eigen::MatrixXd ContactBlock::betweenContactRows(const Eigen::MatrixXd& X) const {
  constexpr Eigen::Index kAtATime = 32;
  const Eigen::Index mine = Eigen::Index(nearPairs_.size()), first = sumOfLower(*getDomainMap()->getComm(), int(mine));
  Eigen::MatrixXd own(Eigen::Index(contact_.size()), X.cols());
  for (Eigen::Index j = 0; j < X.cols(); j += kAtATime) {
    const Eigen::Index width = std::min(kAtATime, X.cols() - j);
    own.middleCols(j, width) = pairs().solve(extended(X.block(first, j, mine, width), nearPairs_, pairs().rows().size()))(contact_, Eigen::all);
  }
  return onAllRanks(own);
}

Eigen::MatrixXd ContactBlock::onAllRanks(const Eigen::MatrixXd& mine) const {
  const auto& comm = *getDomainMap()->getComm();
  if (comm.getSize() == 1) return mine;
  const int rows = int(mine.rows());
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(sumOfAll(comm, rows), mine.cols());
  all.middleRows(sumOfLower(comm, rows), rows) = mine;
  return sumOfAll(comm, all);
}

Eigen::MatrixXd ContactBlock::matrix() const { return betweenContactRows(betweenContactRows(energiesOfNearRows()).transpose()); }

ContactBlock::Columns ContactBlock::spreads() const {
  const auto& comm = *getDomainMap()->getComm();
  const int mine = int(contact_.size()), before = sumOfLower(comm, mine);
  Eigen::VectorXd columns = Eigen::VectorXd::Constant(Eigen::Index(near_->rows().size()), -1);
  const std::vector<int> places = positionsIn(near_->rows(), preconditioner_->jump().multipliers().contactRows());
  for (int i = 0; i < mine; ++i) columns[places[std::size_t(i)]] = before + i;
  return near_->spreads(columns, sumOfAll(comm, mine));
}

ContactBlock::Columns ContactBlock::gram() const {
  const auto& comm = *getDomainMap()->getComm();
  const int mine = int(contact_.size()), before = sumOfLower(comm, mine), all = sumOfAll(comm, mine);
  Eigen::VectorXd numbers = Eigen::VectorXd::Constant(Eigen::Index(pairs().rows().size()), -1);
  for (int i = 0; i < mine; ++i) numbers[contact_[std::size_t(i)]] = before + i;
  std::vector<Eigen::Triplet<double>> triplets;
  for (const auto& entry : gatheredOnAll(comm, pairs().entries(numbers))) triplets.emplace_back(entry.row, entry.column, entry.value);
  Columns G(all, all);
  G.setFromTriplets(triplets.begin(), triplets.end());
  return G;
}

// S of a class between some of its `unknowns`
Eigen::MatrixXd ContactBlock::stiffnessBetween(std::size_t c, const std::vector<int>& positions) const {
  if (dense_[c].size() > 0) return dense_[c].block(positions);
  std::vector<int> inBoundary;
  for (int i : positions) inBoundary.push_back(unknowns_[c][std::size_t(i)]);
  return preconditioner_->surface().block(int(c), inBoundary);
}

// One subdomain, whose unknowns begin at `first`: between those that are met, and columns that have some.
void ContactBlock::addEnergiesOf(std::size_t congruenceClass, Eigen::Index first, const Columns& T, Eigen::MatrixXd& M) const {
  const Eigen::Index n = Eigen::Index(unknowns_[congruenceClass].size());
  std::vector<int> place(std::size_t(n), -1), met;
  std::vector<Eigen::Index> filled;
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index j = 0; j < T.cols(); ++j) {
    const std::size_t before = entries.size();
    for (Columns::InnerIterator it(T, j); it; ++it) {
      const Eigen::Index i = it.row() - first;
      if (i < 0 || i >= n) continue;
      int& at = place[std::size_t(i)];
      if (at < 0) at = int(met.size()), met.push_back(int(i));
      entries.emplace_back(at, int(filled.size()), it.value());
    }
    if (entries.size() > before) filled.push_back(j);
  }
  if (filled.empty()) return;
  Columns X(Eigen::Index(met.size()), Eigen::Index(filled.size()));
  X.setFromTriplets(entries.begin(), entries.end());
  const Eigen::MatrixXd SX = stiffnessBetween(congruenceClass, met) * X, E = X.transpose() * SX;
  for (std::size_t j = 0; j < filled.size(); ++j)
    for (std::size_t i = 0; i < filled.size(); ++i) M(filled[i], filled[j]) += E(Eigen::Index(i), Eigen::Index(j));
}

void ContactBlock::addEnergies(const Columns& spreads, const std::vector<int>& columns, Eigen::MatrixXd& M) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t j = 0; j < columns.size(); ++j)
    for (Columns::InnerIterator it(spreads, columns[j]); it; ++it) entries.emplace_back(int(it.row()), int(j), it.value());
  Columns T(spreads.rows(), Eigen::Index(columns.size()));
  T.setFromTriplets(entries.begin(), entries.end());
  for (std::size_t c = 0; c < unknowns_.size(); ++c)
    for (std::size_t k = 0; k < active_[c].size(); ++k) addEnergiesOf(c, first_[c] + Eigen::Index(k) * Eigen::Index(unknowns_[c].size()), T, M);
}

Eigen::VectorXd ContactBlock::collect(const Eigen::VectorXd& t) const {
  return restricted(pairs().solve(extended(near_->collect(t), nearPairs_, pairs().rows().size())).col(0), contact_);
}

ContactRows::ContactRows(RCP<const DualPreconditioner> preconditioner, RCP<const ContactBlock> block)
    : preconditioner_(std::move(preconditioner)), block_(std::move(block)) {
  findTouchingRows();
}

// The compact vector holds the boundaries of a class's active members one after another.
void ContactRows::findTouchingRows() {
  const JumpOperator& jump = preconditioner_->jump();
  const auto& active = block_->activeMembers();
  Eigen::Index size = 0;
  std::vector<Eigen::Index> offset(jump.primalOffsets().size() - 1, -1);
  std::vector<std::vector<int>> positionOf(active.size());  // local dof -> position in the boundary list
  for (std::size_t c = 0; c < active.size(); ++c) {
    if (active[c].empty()) continue;
    const auto& boundary = preconditioner_->surface().boundary(int(c));
    positionOf[c].assign(std::size_t(preconditioner_->systems()[active[c].front()].R().rows()), -1);
    for (std::size_t i = 0; i < boundary.size(); ++i) positionOf[c][std::size_t(boundary[i])] = int(i);
    for (int member : active[c]) {
      offset[std::size_t(member)] = size;
      size += Eigen::Index(boundary.size());
    }
  }
  const auto place = [&](int subdomain, int dof) {
    const int member = subdomain - jump.firstSubdomain();
    const Eigen::Index first = offset[std::size_t(member)];
    const int position = first < 0 ? -1 : positionOf[std::size_t(preconditioner_->systems()[member].congruenceClass)][std::size_t(dof)];
    return position < 0 ? Eigen::Index(-1) : first + position;
  };
  const MultiplierMap& multipliers = jump.multipliers();
  std::vector<char> marks(localNumElements(*multipliers.overlapMap()), 0);
  for (const auto& entry : multipliers.overlapEntries())
    if (place(entry.subdomain, entry.dof) >= 0) marks[std::size_t(entry.row)] = 1;
  touching_ = std::make_unique<CompactRows>(multipliers, shareMarks(multipliers, marks), size, place,
                                            [](const MultiplierMap::OverlapEntry& entry) { return 1.0 / entry.weight; });
}

// The left end is that of M_cc; the right one takes all rows that touch an active subdomain, on all of its boundary.
void ContactRows::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp, double alpha, double beta) const {
  const Eigen::MatrixXd X = matrixOf(x);
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    const Eigen::VectorXd weighted = preconditioner_->gram().multiply(X.col(Eigen::Index(v)));
    update(y.getDataNonConst(v), beta, alpha, block_->collect(multiplyActive(touching_->spread(restricted(weighted, touching_->rows())))));
  }
}

// S t of the active members, at the unknowns that contact rows meet.
Eigen::VectorXd ContactRows::multiplyActive(const Eigen::VectorXd& t) const {
  const auto& active = block_->activeMembers();
  std::vector<double> picked;
  const double* from = t.data();
  for (std::size_t c = 0; c < active.size(); ++c) {
    if (active[c].empty()) continue;
    const Eigen::Map<const Eigen::MatrixXd> X(from, Eigen::Index(preconditioner_->surface().boundary(int(c)).size()), Eigen::Index(active[c].size()));
    from += X.size();
    Eigen::MatrixXd Y(X.rows(), X.cols());
    preconditioner_->surface().apply(int(c), X, Y);
    for (Eigen::Index j = 0; j < Y.cols(); ++j)
      for (int i : block_->unknowns()[c]) picked.push_back(Y(i, j));
  }
  return Eigen::Map<const Eigen::VectorXd>(picked.data(), Eigen::Index(picked.size()));
}

}  // namespace Haptos
