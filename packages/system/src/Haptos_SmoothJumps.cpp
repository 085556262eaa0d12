// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SmoothJumps.hpp"

#include <Eigen/Geometry>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "Haptos_FetiSystem.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

constexpr int kPairsOfCentre = 32, kMostCentres = 64;  // with 32 or 48 centres 2025 pairs take as many seconds: more steps, each cheaper
constexpr int kCells = 64;        // along the longest side: centres are chosen among cells, not pairs, whose number has no bound
constexpr double kReach = 2;      // of a centre, in distances to the next: with 1.5 and 2.5 a fifth more steps are taken

struct Place {
  int interface;
  Eigen::Vector3d x;
};

// Middles of the cells of a grid that have pairs, the same on all ranks.
std::vector<Place> occupiedCells(const Communicator& comm, const std::vector<Place>& places) {
  const double none = std::numeric_limits<double>::infinity();
  Eigen::Vector3d lower = Eigen::Vector3d::Constant(none), upper = -lower;
  for (const Place& place : places) lower = lower.cwiseMin(place.x), upper = upper.cwiseMax(place.x);
  lower = leastOfAll(comm, lower);
  upper = largestOfAll(comm, upper);
  const double side = (upper - lower).maxCoeff() / kCells;
  using Cell = std::array<int, 4>;
  std::vector<Cell> cells;
  const auto sort = [&] { std::sort(cells.begin(), cells.end()), cells.erase(std::unique(cells.begin(), cells.end()), cells.end()); };
  for (const Place& place : places) {
    Cell cell{place.interface, 0, 0, 0};
    for (int d = 0; d < 3; ++d) cell[std::size_t(d + 1)] = side > 0 ? int((place.x[d] - lower[d]) / side) : 0;
    cells.push_back(cell);
  }
  sort();
  cells = gatheredOnAll(comm, cells);
  sort();
  std::vector<Place> middles;
  for (const Cell& cell : cells) middles.push_back({cell[0], lower + side * (Eigen::Vector3d(cell[1], cell[2], cell[3]).array() + 0.5).matrix()});
  return middles;
}

struct Centre {
  Place place;
  double reach;
};

// The farthest cell is the next one; the interfaces come first, as no centre of another one is near.
std::vector<Centre> chooseCentres(const std::vector<Place>& cells, std::size_t count) {
  constexpr double kFar = std::numeric_limits<double>::max();
  std::vector<double> distance(cells.size(), kFar);
  std::vector<Centre> centres;
  while (centres.size() < std::min(count, cells.size())) {
    const std::size_t next = std::size_t(std::max_element(distance.begin(), distance.end()) - distance.begin());
    if (distance[next] == 0) break;
    centres.push_back({cells[next], 0});
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (cells[i].interface == cells[next].interface) distance[i] = std::min(distance[i], (cells[i].x - cells[next].x).norm());
  }
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (Centre& centre : centres)
      if (centre.place.interface == cells[i].interface) centre.reach = std::max(centre.reach, kReach * distance[i]);
  return centres;
}

// (1 - d^2 / reach^2)^2, divided by their sum
Eigen::VectorXd weightsAt(const Place& place, const std::vector<Centre>& centres) {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(Eigen::Index(centres.size()));
  for (std::size_t c = 0; c < centres.size(); ++c) {
    if (centres[c].place.interface != place.interface) continue;
    const double r = centres[c].reach, left = r > 0 ? 1 - (place.x - centres[c].place.x).squaredNorm() / (r * r) : 1.0;
    if (left > 0) weights[Eigen::Index(c)] = left * left;
  }
  const double sum = weights.sum();
  return sum > 0 ? Eigen::VectorXd(weights / sum) : weights;
}

// Rows of a pair times the six motions about a centre, which are lengths.
Eigen::Matrix<double, 3, 6> motionsOf(const Eigen::Matrix3d& axes, const Eigen::Vector3d& arm) {
  Eigen::Matrix<double, 3, 6> motions;
  motions.leftCols<3>() = axes;
  for (int d = 0; d < 3; ++d) motions.col(3 + d) = axes * Eigen::Vector3d::Unit(d).cross(arm);
  return motions;
}

// Rows N, T1, T2, 0 where there is no row.
Eigen::Matrix3d axesOf(const MultiplierMap& multipliers, const LocalPair& pair) {
  const LocalFrame& frame = pair.geometry.frame;
  const std::array<int, 3> rows{pair.normal, pair.tangential[0], pair.tangential[1]};
  Eigen::Matrix3d axes;
  for (std::size_t d = 0; d < 3; ++d) axes.col(Eigen::Index(d)) << frame.normal[d], frame.t1[d], frame.t2[d];
  for (Eigen::Index a = 0; a < 3; ++a)
    if (rows[std::size_t(a)] < 0 || multipliers.pinned()[std::size_t(rows[std::size_t(a)])] != 0) axes.row(a).setZero();
  return axes;
}

}  // namespace

std::vector<Eigen::Vector3d> placesOfPairs(const FetiSystem& system) {
  Vector coordinates(system.jump().getDomainMap());
  {
    const auto data = coordinates.getDataNonConst(0);
    for (std::size_t i = 0; i + 1 < system.jump().primalOffsets().size(); ++i) {
      Teuchos_Ordinal at = Teuchos_Ordinal(system.jump().primalOffsets()[i]);
      for (const auto& x : system.systems().source().coordinates(int(i)))
        for (double value : x) data[at++] = value;
    }
  }
  std::vector<std::int64_t> nodes;
  for (const LocalPair& pair : system.model().multipliers->pairs()) nodes.push_back(pair.geometry.secondaryNode);
  const NodalGather& gather = *system.model().gather;
  const auto x = gather.fetch(gather.copies(coordinates).mean, nodes);
  std::vector<Eigen::Vector3d> places;
  for (std::size_t i = 0; i < nodes.size(); ++i) places.emplace_back(&x[3 * i]);
  return places;
}

Eigen::MatrixXd smoothJumps(const MultiplierMap& multipliers, const std::vector<Eigen::Vector3d>& x) {
  const auto& comm = *multipliers.map()->getComm();
  const auto& pairs = multipliers.pairs();
  std::vector<Place> places;
  for (std::size_t i = 0; i < x.size(); ++i) places.push_back({pairs[i].interface, x[i]});
  const auto wanted = std::size_t(std::min<GlobalOrdinal>(kMostCentres, multipliers.numPairs() / kPairsOfCentre));
  const std::vector<Centre> centres = chooseCentres(occupiedCells(comm, places), wanted);
  Eigen::MatrixXd jumps = Eigen::MatrixXd::Zero(3 * Eigen::Index(places.size()), 6 * Eigen::Index(centres.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Matrix3d axes = axesOf(multipliers, pairs[i]);
    const Eigen::VectorXd weights = weightsAt(places[i], centres);
    for (std::size_t c = 0; c < centres.size(); ++c) {
      const double reach = centres[c].reach > 0 ? centres[c].reach : 1.0;
      jumps.block<3, 6>(3 * Eigen::Index(i), 6 * Eigen::Index(c)) = weights[Eigen::Index(c)] * motionsOf(axes, (x[i] - centres[c].place.x) / reach);
    }
  }
  return jumps;
}

}  // namespace Haptos
