// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SurfaceCentres.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"

namespace Haptos {
namespace {

constexpr int kCells = 64;          // along the longest side: centres are chosen among cells, not pairs, whose number has no bound
constexpr double kRoundOff = 1e-9;  // of a cell, of a distance: nodes of a grid are on edges of cells and as far from each other, in any units

// Middles of the cells of a grid that have pairs, the same on all ranks.
std::vector<SurfacePlace> occupiedCells(const Communicator& comm, const std::vector<SurfacePlace>& places) {
  const double none = std::numeric_limits<double>::infinity();
  Eigen::Vector3d lower = Eigen::Vector3d::Constant(none), upper = -lower;
  for (const SurfacePlace& place : places) lower = lower.cwiseMin(place.x), upper = upper.cwiseMax(place.x);
  lower = leastOfAll(comm, lower);
  upper = largestOfAll(comm, upper);
  const double side = (upper - lower).maxCoeff() / kCells;
  using Cell = std::array<int, 4>;
  std::vector<Cell> cells;
  const auto sort = [&] { std::sort(cells.begin(), cells.end()), cells.erase(std::unique(cells.begin(), cells.end()), cells.end()); };
  for (const SurfacePlace& place : places) {
    Cell cell{place.interface, 0, 0, 0};
    for (int d = 0; d < 3; ++d) cell[std::size_t(d + 1)] = side > 0 ? int((place.x[d] - lower[d]) / side + kRoundOff) : 0;
    cells.push_back(cell);
  }
  sort();
  cells = gatheredOnAll(comm, cells);
  sort();
  std::vector<SurfacePlace> middles;
  for (const Cell& cell : cells) middles.push_back({cell[0], lower + side * (Eigen::Vector3d(cell[1], cell[2], cell[3]).array() + 0.5).matrix()});
  return middles;
}

}  // namespace

// The farthest cell is the next one, the first of those that are as far; the interfaces come first, as no centre of another one is near.
std::vector<SurfaceCentre> chooseCentres(const Communicator& comm, const std::vector<SurfacePlace>& places, std::size_t count) {
  constexpr double kFar = std::numeric_limits<double>::max();
  const std::vector<SurfacePlace> cells = occupiedCells(comm, places);
  std::vector<double> distance(cells.size(), kFar);
  std::vector<SurfaceCentre> centres;
  while (centres.size() < std::min(count, cells.size())) {
    const double farthest = (1 - kRoundOff) * *std::max_element(distance.begin(), distance.end());
    if (farthest == 0) break;
    const auto next = std::size_t(std::find_if(distance.begin(), distance.end(), [&](double d) { return d >= farthest; }) - distance.begin());
    centres.push_back({cells[next], 0});
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (cells[i].interface == cells[next].interface) distance[i] = std::min(distance[i], (cells[i].x - cells[next].x).norm());
  }
  for (std::size_t i = 0; i < cells.size(); ++i)
    for (SurfaceCentre& centre : centres)
      if (centre.place.interface == cells[i].interface) centre.spacing = std::max(centre.spacing, distance[i]);
  return centres;
}

}  // namespace Haptos
