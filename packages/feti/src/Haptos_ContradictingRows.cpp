// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ContradictingRows.hpp"

#include <Eigen/SparseCore>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <map>

#include "Haptos_CouplingCoefficients.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_HeldCouplings.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SparseLdl.hpp"

namespace Haptos {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

// n . u <= c
struct NormalRow {
  std::int64_t node;
  double c;
  std::vector<std::pair<int, double>> entries;  // component of a node, coefficient
};

std::vector<NormalRow> normalRows(const std::vector<HeldCoupling>& couplings, int& numColumns) {
  constexpr double kNothing = 1e-12;
  std::map<std::pair<std::int64_t, int>, int> columns;
  std::vector<NormalRow> rows;
  for (const HeldCoupling& coupling : couplings) {
    NormalRow row{coupling.nodes.front().node, coupling.values[0], {}};
    if (!coupling.isContact || coupling.rows[0] < 0) continue;
    forEachCoefficient(coupling.axes[0], coupling.nodes, [&](const PairNode& node, int d, double value) {
      if (std::abs(value) > kNothing) row.entries.emplace_back(columns.emplace(std::pair(node.node, d), int(columns.size())).first->second, value);
    });
    if (!row.entries.empty()) rows.push_back(std::move(row));
  }
  numColumns = int(columns.size());
  return rows;
}

// A row that has a column to itself can be obeyed whatever the others ask for.
std::vector<NormalRow> withoutOwnColumns(std::vector<NormalRow> rows, int numColumns) {
  std::vector<int> counts(std::size_t(numColumns), 0);
  for (const NormalRow& row : rows)
    for (const auto& entry : row.entries) ++counts[std::size_t(entry.first)];
  const auto hasOwn = [&](const NormalRow& row) {
    return std::any_of(row.entries.begin(), row.entries.end(), [&](const auto& entry) { return counts[std::size_t(entry.first)] == 1; });
  };
  for (std::size_t before = rows.size() + 1; rows.size() < before;) {
    before = rows.size();
    std::vector<NormalRow> left;
    for (NormalRow& row : rows) {
      if (!hasOwn(row)) {
        left.push_back(std::move(row));
        continue;
      }
      for (const auto& entry : row.entries) --counts[std::size_t(entry.first)];
    }
    rows = std::move(left);
  }
  return rows;
}

// max(0, N u - c) of least length, by Newton's method: rows that are missed, of which the least squares; few change from step to step.
Eigen::VectorXd leastMisses(const Sparse& N, const Eigen::VectorXd& c) {
  constexpr int kSteps = 100;
  constexpr double kShortest = 1e-6, kArmijo = 1e-4;
  Eigen::VectorXd u = Eigen::VectorXd::Zero(N.cols());
  const auto missesAt = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd { return (N * at - c).cwiseMax(0); };
  Eigen::VectorXd z = missesAt(u);
  for (int step = 0; step < kSteps && z.squaredNorm() > 0; ++step) {
    const Eigen::VectorXd isMissed = (z.array() > 0).cast<double>(), gradient = N.transpose() * z;
    const Sparse H = Sparse(N.transpose()) * isMissed.asDiagonal() * N;
    const Eigen::VectorXd d = -SparseLdl(H).solve(gradient);
    double t = 1;
    Eigen::VectorXd next = missesAt(u + d);
    while (next.squaredNorm() > z.squaredNorm() + 2 * kArmijo * t * gradient.dot(d) && t > kShortest) next = missesAt(u + (t /= 2) * d);
    const double before = z.norm();
    u += t * d;
    z = std::move(next);
    if (z.norm() >= (1 - 1e-12) * before) break;
  }
  return z;
}

std::optional<Contradiction> contradictionOf(const std::vector<HeldCoupling>& couplings, double roundOff) {
  constexpr double kBalanced = 1e-6;
  int numColumns = 0;
  std::vector<NormalRow> rows = normalRows(couplings, numColumns);
  rows = withoutOwnColumns(std::move(rows), numColumns);
  if (std::none_of(rows.begin(), rows.end(), [&](const NormalRow& row) { return row.c < -roundOff; })) return {};  // u = 0 obeys them
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd c(Eigen::Index(rows.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    c[Eigen::Index(i)] = rows[i].c;
    for (const auto& [column, value] : rows[i].entries) entries.emplace_back(int(i), column, value);
  }
  Sparse N(c.size(), numColumns);
  N.setFromTriplets(entries.begin(), entries.end());
  const Eigen::VectorXd z = leastMisses(N, c);
  Eigen::Index worst = 0;
  if (z.maxCoeff(&worst) <= roundOff || (N.transpose() * z).norm() > kBalanced * z.norm()) return {};
  return Contradiction{rows[std::size_t(worst)].node, z[worst]};
}

}  // namespace

std::optional<Contradiction> findContradiction(const MultiplierMap& multipliers, const Vector& c, double roundOff) {
  const auto& comm = *multipliers.map()->getComm();
  const std::vector<HeldCoupling> couplings = heldCouplings(multipliers, c);
  std::vector<Contradiction> found;
  runOnAllRanks(comm, [&] {
    if (const auto mine = contradictionOf(couplings, roundOff)) found.push_back(*mine);
  });
  found = gatheredOnAll(comm, found);
  if (found.empty()) return {};
  return *std::max_element(found.begin(), found.end(), [](const Contradiction& a, const Contradiction& b) { return a.depth < b.depth; });
}

}  // namespace Haptos
