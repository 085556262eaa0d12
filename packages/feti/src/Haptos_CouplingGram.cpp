// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CouplingGram.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <iterator>
#include <map>
#include <type_traits>

#include "Haptos_CouplingCoefficients.hpp"
#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_DisjointSets.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SparseBlocks.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

constexpr std::size_t kMostDense = 60;  // rows: beyond, a sparse factor costs less than an inverse

bool isFree(const PairNode& node) { return !(node.isPrescribed[0] && node.isPrescribed[1] && node.isPrescribed[2]); }

// The unknowns of a coupling: its rows, or for all three rows of a pair the same in global axes.
constexpr std::array<std::array<double, 3>, 3> kGlobal{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

template <class Rows, class Axes>
bool isTurned(const Rows& rows, const Axes& axes) {
  return std::all_of(rows.begin(), rows.end(), [](auto row) { return row >= 0; }) &&
         std::none_of(axes.begin(), axes.end(), [](const auto& axis) { return axis == Vec3::Array{}; });
}

// Scaled to unit diagonal, where eigenvalues below 1e-10 are rows that depend on others: these get nothing.
Eigen::MatrixXd pseudoInverse(Eigen::MatrixXd A) {
  constexpr double kDependent = 1e-10;
  Eigen::VectorXd d = A.diagonal();
  for (auto& value : d) value = value > 0 ? 1.0 / std::sqrt(value) : 0.0;
  A = d.asDiagonal() * A * d.asDiagonal();
  const SymmetricEigen eigen(A);
  Eigen::VectorXd inverse = eigen.values;
  for (auto& value : inverse) value = value > kDependent ? 1.0 / value : 0.0;
  return d.asDiagonal() * (eigen.vectors * inverse.asDiagonal() * eigen.vectors.transpose()) * d.asDiagonal();
}

// Column of C of a component of a node.
struct NodeColumn {
  const PairNode* node;
  double weight;                                // W
  std::vector<std::pair<int, double>> entries;  // row, coefficient
};
using NodeColumns = std::map<std::pair<std::int64_t, int>, NodeColumn>;

// C by columns, an unknown of a node each; rows are numbered as the couplings come.
template <class WeightOf>
NodeColumns columnsOf(const std::vector<const Coupling*>& couplings, const WeightOf& weightOf) {
  NodeColumns columns;
  int row = 0;
  for (const Coupling* coupling : couplings)
    for (std::size_t a = 0; a < 3; ++a) {
      if (coupling->rows[a] < 0) continue;
      forEachCoefficient(coupling->axes[a], coupling->nodes, [&](const PairNode& node, int d, double value) {
        columns.try_emplace({node.node, d}, NodeColumn{&node, weightOf(node), {}}).first->second.entries.emplace_back(row, value);
      });
      ++row;
    }
  return columns;
}

// S = C W C^T
Eigen::MatrixXd gramOf(const NodeColumns& columns, int rows) {
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(rows, rows);
  for (const auto& [unknown, column] : columns)
    for (const auto& [i, a] : column.entries)
      for (const auto& [j, b] : column.entries) S(i, j) += a * b * column.weight;
  return S;
}

}  // namespace

// Couplings that meet, all of this rank.
struct CouplingGram::Group {
  std::vector<const Coupling*> couplings;
  std::vector<int> rows;  // positions in rows_
};

struct CouplingGram::Held {
  struct Item {
    std::array<GlobalOrdinal, 3> rows;
    std::array<std::array<double, 3>, 3> axes;
    std::vector<PairNode> nodes;

    auto parts() { return std::tie(rows, axes, nodes); }
  };
  std::vector<Item> items;
  std::vector<GlobalOrdinal> rows;
  std::vector<std::int64_t> nodes;  // those with gluing rows, ascending
};

CouplingGram::CouplingGram(const MultiplierMap& multipliers, bool stiffnessScaling)
    : multipliers_(multipliers), stiffnessScaling_(stiffnessScaling), dependent_(findDependentGroups(multipliers)) {
  findRowsAndNodes();
  const auto groups = findLocalGroups();
  runOnAllRanks(*multipliers.map()->getComm(), [&] { invertGroups(groups); });
  const auto holders = findHolders(groups);
  isAnyHeld_ = anyOfAll(*multipliers.map()->getComm(), std::any_of(holders.begin(), holders.end(), [](int rank) { return rank >= 0; }));
  if (!isAnyHeld_) return;
  holdFactors(holders);
  setHeldDiagonals();
}

int CouplingGram::positionOfRow(int row) const { return int(std::lower_bound(rows_.begin(), rows_.end(), row) - rows_.begin()); }

int CouplingGram::positionOfNode(std::int64_t node) const {
  const auto& all = multipliers_.nodeRows();
  return int(std::lower_bound(nodes_.begin(), nodes_.end(), node, [&](int i, std::int64_t n) { return all[std::size_t(i)].node < n; }) -
             nodes_.begin());
}

// Nodes with gluing rows that pairs act on: their gluing rows are eliminated, and q C^T y is put back to them.
void CouplingGram::findRowsAndNodes() {
  std::vector<std::int64_t> acted;  // on by this rank's couplings
  for (const Coupling& coupling : multipliers_.couplings()) {
    for (int row : coupling.rows)
      if (row >= 0) rows_.push_back(row);
    for (const PairNode& node : coupling.nodes)
      if (isFree(node)) acted.push_back(node.node);
  }
  std::sort(rows_.begin(), rows_.end());
  std::sort(acted.begin(), acted.end());
  const auto& all = multipliers_.nodeRows();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].gluing >= 0 && (all[i].holder >= 0 || std::binary_search(acted.begin(), acted.end(), all[i].node))) nodes_.push_back(int(i));
}

// Couplings that have a node in common, joined node by node; those that reach other ranks are left to their holder.
std::vector<CouplingGram::Group> CouplingGram::findLocalGroups() const {
  const auto& couplings = multipliers_.couplings();
  DisjointSets sets(couplings.size());
  std::vector<std::pair<std::int64_t, int>> meetings;
  for (std::size_t i = 0; i < couplings.size(); ++i)
    for (const PairNode& node : couplings[i].nodes)
      if (couplings[i].holder < 0 && isFree(node)) meetings.emplace_back(node.node, int(i));
  std::sort(meetings.begin(), meetings.end());
  for (std::size_t k = 1; k < meetings.size(); ++k)
    if (meetings[k].first == meetings[k - 1].first) sets.join(meetings[k].second, meetings[k - 1].second);
  std::map<int, Group> groups;
  for (std::size_t i = 0; i < couplings.size(); ++i) {
    if (couplings[i].holder >= 0) continue;
    Group& group = groups[sets.lowest(int(i))];
    group.couplings.push_back(&couplings[i]);
    for (int row : couplings[i].rows)
      if (row >= 0) group.rows.push_back(positionOfRow(row));
  }
  std::vector<Group> result;
  for (auto& [root, group] : groups) result.push_back(std::move(group));
  return result;
}

std::vector<GlobalOrdinal> CouplingGram::globalRows(const Group& group) const {
  std::vector<GlobalOrdinal> rows;
  for (const int position : group.rows) rows.push_back(multipliers_.map()->getGlobalElement(rows_[std::size_t(position)]));
  return rows;
}

// Dense S of a group, and what of C its nodes with gluing rows have.
void CouplingGram::invertGroups(const std::vector<Group>& groups) {
  const Eigen::Index n = Eigen::Index(rows_.size());
  rowDiagonal_ = Eigen::VectorXd::Zero(n);
  nodeDiagonal_ = Eigen::VectorXd::Zero(3 * Eigen::Index(nodes_.size()));
  std::vector<Eigen::Triplet<double>> gram, inverse, coefficients;
  for (const Group& group : groups) {
    if (group.rows.empty() || group.rows.size() > kMostDense) continue;
    const auto columns = columnsOf(group.couplings, [&](const PairNode& node) { return weightOf(node); });
    const int rows = int(group.rows.size());
    const Eigen::MatrixXd S = gramOf(columns, rows), dense = pseudoInverse(S + meanOnDependentRows(dependent_, globalRows(group), S.diagonal()));
    for (const auto& [unknown, column] : columns) {
      if (column.node->owner < 0) continue;
      const int place = 3 * positionOfNode(unknown.first) + unknown.second;
      for (const auto& [i, a] : column.entries) coefficients.emplace_back(group.rows[std::size_t(i)], place, a);
    }
    for (const Coupling* coupling : group.couplings) addDiagonals(*coupling);
    const double negligible = 1e-15 * dense.cwiseAbs().maxCoeff();
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < rows; ++j) {
        const int row = group.rows[std::size_t(i)], column = group.rows[std::size_t(j)];
        if (S(i, j) != 0) gram.emplace_back(row, column, S(i, j));
        if (std::abs(dense(i, j)) > negligible) inverse.emplace_back(row, column, dense(i, j));
      }
  }
  gram_.resize(n, n);
  gram_.setFromTriplets(gram.begin(), gram.end());
  inverse_.resize(n, n);
  inverse_.setFromTriplets(inverse.begin(), inverse.end());
  C_.resize(n, nodeDiagonal_.size());
  C_.setFromTriplets(coefficients.begin(), coefficients.end());
}

// Of one over the diagonal of S, as a factor has it: which rows are inverted depends on the ranks and on how many meet, and r of the law comes
// from here.
void CouplingGram::addDiagonals(const Coupling& coupling) {
  const bool turned = isTurned(coupling.rows, coupling.axes);
  const auto& axes = turned ? kGlobal : coupling.axes;
  for (std::size_t u = 0; u < 3; ++u) {
    double sum = 0;
    forEachCoefficient(axes[u], coupling.nodes, [&](const PairNode& node, int, double value) { sum += value * value * weightOf(node); });
    if (!turned && coupling.rows[u] < 0) continue;
    const double inverse = sum > 0 ? 1 / sum : 0.0;
    for (std::size_t a = 0; a < 3; ++a)
      if (turned || a == u) rowDiagonal_[positionOfRow(coupling.rows[a])] += inverse * (turned ? coupling.axes[a][u] * coupling.axes[a][u] : 1.0);
    forEachCoefficient(axes[u], coupling.nodes, [&](const PairNode& node, int d, double value) {
      if (node.owner >= 0) nodeDiagonal_[3 * positionOfNode(node.node) + d] += value * value * inverse;
    });
  }
}

// [couplings] rank that has the factor; -1: inverted
std::vector<int> CouplingGram::findHolders(const std::vector<Group>& groups) const {
  const auto& couplings = multipliers_.couplings();
  std::vector<int> holders;
  for (const Coupling& coupling : couplings) holders.push_back(coupling.holder);
  for (const Group& group : groups)
    for (const Coupling* coupling : group.couplings)
      if (group.rows.size() > kMostDense) holders[std::size_t(coupling - couplings.data())] = multipliers_.map()->getComm()->getRank();
  return holders;
}

// All couplings of a group come to one rank, which factors S of it; values go there and back in every application.
void CouplingGram::holdFactors(const std::vector<int>& holders) {
  const auto& comm = *multipliers_.map()->getComm();
  std::vector<std::vector<Held::Item>> outgoing(std::size_t(comm.getSize()));
  for (std::size_t i = 0; i < holders.size(); ++i) {
    if (holders[i] < 0) continue;
    const Coupling& coupling = multipliers_.couplings()[i];
    Held::Item item{{-1, -1, -1}, coupling.axes, coupling.nodes};
    for (std::size_t a = 0; a < 3; ++a)
      if (coupling.rows[a] >= 0) item.rows[a] = multipliers_.map()->getGlobalElement(coupling.rows[a]);
    outgoing[std::size_t(holders[i])].push_back(std::move(item));
  }
  Held held{joined(exchangeValues(comm, outgoing)), {}, {}};
  for (const auto& item : held.items) {
    std::copy_if(item.rows.begin(), item.rows.end(), std::back_inserter(held.rows), [](GlobalOrdinal row) { return row >= 0; });
    for (const PairNode& node : item.nodes)
      if (node.owner >= 0 && isFree(node)) held.nodes.push_back(node.node);
  }
  std::sort(held.nodes.begin(), held.nodes.end());
  held.nodes.erase(std::unique(held.nodes.begin(), held.nodes.end()), held.nodes.end());
  runOnAllRanks(comm, [&] { factorHeld(held); });
  HolderTransfer::Ends ends = endsOfRows(holders, held);
  rowTransfer_ = HolderTransfer(ends, multipliers_.map()->getComm());
  addNodes(holders, held, ends);
  transfer_ = HolderTransfer(ends, multipliers_.map()->getComm());
}

// Where a pair is turned, x_d = sum over rows axes[a][d] x_a.
void CouplingGram::factorHeld(const Held& held) {
  std::vector<Eigen::Triplet<double>> turn, coefficients, ofNodes;
  std::map<std::pair<std::int64_t, int>, int> columns;
  std::vector<double> weights;
  int row = 0, unknowns = 0;
  const auto addUnknown = [&](const std::array<double, 3>& axis, const std::vector<PairNode>& nodes) {
    forEachCoefficient(axis, nodes, [&](const PairNode& node, int d, double value) {
      const auto [at, isNew] = columns.emplace(std::make_pair(node.node, d), int(columns.size()));
      if (isNew) weights.push_back(weightOf(node));
      coefficients.emplace_back(unknowns, at->second, value);
      if (node.owner < 0) return;
      const auto place = std::lower_bound(held.nodes.begin(), held.nodes.end(), node.node) - held.nodes.begin();
      ofNodes.emplace_back(unknowns, 3 * int(place) + d, value);
    });
    ++unknowns;
  };
  for (const auto& item : held.items) {
    const bool turned = isTurned(item.rows, item.axes);
    for (std::size_t a = 0; a < 3; ++a) {
      if (item.rows[a] < 0) continue;
      if (!turned) turn.emplace_back(unknowns, row, 1.0);
      for (int d = 0; d < 3 && turned; ++d) turn.emplace_back(unknowns - int(a) + d, row, item.axes[a][std::size_t(d)]);
      addUnknown(turned ? kGlobal[a] : item.axes[a], item.nodes);
      ++row;
    }
  }
  turn_.resize(unknowns, row);
  turn_.setFromTriplets(turn.begin(), turn.end());
  heldC_.resize(unknowns, 3 * Eigen::Index(held.nodes.size()));
  heldC_.setFromTriplets(ofNodes.begin(), ofNodes.end());
  Matrix C(unknowns, Eigen::Index(columns.size()));
  C.setFromTriplets(coefficients.begin(), coefficients.end());
  heldGram_ = C * Eigen::Map<const Eigen::VectorXd>(weights.data(), Eigen::Index(weights.size())).asDiagonal() * Matrix(C.transpose());
  factor_ = ComponentLdl(dependent_.empty() ? heldGram_ : Matrix(heldGram_ + onHeldDependentRows(held)));
}

// In global axes; what supports hold has nothing there, not the round-off of turning.
CouplingGram::Matrix CouplingGram::onHeldDependentRows(const Held& held) const {
  const Matrix S = turn_.transpose() * heldGram_ * turn_;
  const Eigen::VectorXd isMet = (heldGram_.diagonal().array() > 0).cast<double>();
  const Matrix turned = turn_ * meanOnDependentRows(dependent_, held.rows, S.diagonal()) * Matrix(turn_.transpose());
  return Matrix(isMet.asDiagonal() * turned * isMet.asDiagonal()).pruned();
}

// Rows of held couplings here, and where their factors are.
HolderTransfer::Ends CouplingGram::endsOfRows(const std::vector<int>& holders, const Held& held) const {
  HolderTransfer::Ends ends{{}, {}, held.rows};
  for (std::size_t i = 0; i < holders.size(); ++i)
    for (int row : multipliers_.couplings()[i].rows) {
      if (holders[i] < 0 || row < 0) continue;
      ends.mine.push_back(positionOfRow(row));
      ends.from.push_back(multipliers_.map()->getGlobalElement(row));
    }
  return ends;
}

// Three numbers a node, behind those of all rows.
void CouplingGram::addNodes(const std::vector<int>& holders, const Held& held, HolderTransfer::Ends& ends) const {
  const auto numRows = GlobalOrdinal(multipliers_.map()->getGlobalNumElements());
  std::vector<std::int64_t> wanted;  // nodes of this rank's large groups
  for (std::size_t i = 0; i < holders.size(); ++i) {
    const Coupling& coupling = multipliers_.couplings()[i];
    if (holders[i] < 0 || coupling.holder >= 0) continue;
    for (const PairNode& node : coupling.nodes)
      if (node.owner >= 0 && isFree(node)) wanted.push_back(node.node);
  }
  std::sort(wanted.begin(), wanted.end());
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const NodeRows& node = multipliers_.nodeRows()[std::size_t(nodes_[k])];
    if (node.holder < 0 && !std::binary_search(wanted.begin(), wanted.end(), node.node)) continue;
    for (int d = 0; d < 3; ++d) {
      ends.mine.push_back(int(rows_.size() + 3 * k) + d);
      ends.from.push_back(numRows + 3 * node.node + d);
    }
  }
  for (const auto node : held.nodes)
    for (int d = 0; d < 3; ++d) ends.to.push_back(numRows + 3 * node + d);
}

// As `addDiagonals`.
void CouplingGram::setHeldDiagonals() {
  Eigen::VectorXd inverse = heldGram_.diagonal();
  for (auto& value : inverse) value = value > 0 ? 1 / value : 0.0;
  Eigen::VectorXd held(turn_.cols() + heldC_.cols());
  held << turn_.cwiseAbs2().transpose() * inverse, heldC_.cwiseAbs2().transpose() * inverse;
  Eigen::MatrixXd own(rowDiagonal_.size() + nodeDiagonal_.size(), 1);
  own << rowDiagonal_, nodeDiagonal_;
  transfer_.scatter(held, own);
  rowDiagonal_ = own.col(0).head(rowDiagonal_.size());
  nodeDiagonal_ = own.col(0).tail(nodeDiagonal_.size());
}

std::vector<CouplingGram::Entry> CouplingGram::entries(const Eigen::VectorXd& numbers) const {
  std::vector<Entry> entries;
  const auto append = [&entries](const auto& S, const Eigen::VectorXd& numberOf) {
    using Sparse = std::decay_t<decltype(S)>;
    for (Eigen::Index outer = 0; outer < S.outerSize(); ++outer)
      for (typename Sparse::InnerIterator it(S, outer); it; ++it)
        if (numberOf[it.row()] >= 0 && numberOf[it.col()] >= 0) entries.push_back({int(numberOf[it.row()]), int(numberOf[it.col()]), it.value()});
  };
  append(gram_, numbers);
  if (isAnyHeld_) append(Matrix(turn_.transpose() * heldGram_ * turn_), rowTransfer_.gather(numbers).col(0));
  return entries;
}

// Y = S^-1 X: small groups by their inverses, held ones as T^T S^-1 T X, T the turn to global axes.
Eigen::MatrixXd CouplingGram::solve(const Eigen::MatrixXd& X) const {
  Eigen::MatrixXd Y = timesColumns(inverse_, X);
  if (!isAnyHeld_) return Y;
  const Eigen::MatrixXd held = rowTransfer_.gather(X);
  rowTransfer_.scatter(turn_.transpose() * factor_.solve(turn_ * held), Y);
  return Y;
}

// One gather for x and z: y = S^-1 (x + C z), and C^T y goes back with it.
void CouplingGram::solve(Eigen::MatrixXd& x, Eigen::MatrixXd& z) const {
  Eigen::MatrixXd own(x.rows() + z.rows(), x.cols());
  own << x, z;
  x = timesColumns(inverse_, x + timesColumns(C_, z));
  z = timesColumns(C_.transpose(), x);
  if (!isAnyHeld_) return;
  const Eigen::MatrixXd values = transfer_.gather(own);
  const Eigen::MatrixXd y = factor_.solve(turn_ * values.topRows(turn_.cols()) + heldC_ * values.bottomRows(heldC_.cols()));
  Eigen::MatrixXd held(values.rows(), values.cols());
  held << turn_.transpose() * y, heldC_.transpose() * y;
  own << x, z;
  transfer_.scatter(held, own);
  x = own.topRows(x.rows());
  z = own.bottomRows(z.rows());
}

bool CouplingGram::isWhereSolved(bool mine) const { return isAnyHeld_ ? anyOfAll(*multipliers_.map()->getComm(), mine) : mine; }

}  // namespace Haptos
