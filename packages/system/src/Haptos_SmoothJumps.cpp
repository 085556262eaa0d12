// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_SmoothJumps.hpp"

#include <Eigen/Geometry>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <array>

#include "Haptos_FetiSystem.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_SurfaceCentres.hpp"

namespace Haptos {
namespace {

constexpr int kPairsOfCentre = 32, kMostCentres = 64;  // with 32 or 48 centres 2025 pairs take as many seconds: more steps, each cheaper
constexpr double kReach = 2;      // of a centre, in distances to the next: with 1.5 and 2.5 a fifth more steps are taken

// (1 - d^2 / reach^2)^2, divided by their sum
Eigen::VectorXd weightsAt(const SurfacePlace& place, const std::vector<SurfaceCentre>& centres) {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(Eigen::Index(centres.size()));
  for (std::size_t c = 0; c < centres.size(); ++c) {
    if (centres[c].place.interface != place.interface) continue;
    const double r = kReach * centres[c].spacing, left = r > 0 ? 1 - (place.x - centres[c].place.x).squaredNorm() / (r * r) : 1.0;
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
  std::vector<SurfacePlace> places;
  for (std::size_t i = 0; i < x.size(); ++i) places.push_back({pairs[i].interface, x[i]});
  const auto wanted = std::size_t(std::min<GlobalOrdinal>(kMostCentres, multipliers.numPairs() / kPairsOfCentre));
  const std::vector<SurfaceCentre> centres = chooseCentres(comm, places, wanted);
  Eigen::MatrixXd jumps = Eigen::MatrixXd::Zero(3 * Eigen::Index(places.size()), 6 * Eigen::Index(centres.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::Matrix3d axes = axesOf(multipliers, pairs[i]);
    const Eigen::VectorXd weights = weightsAt(places[i], centres);
    for (std::size_t c = 0; c < centres.size(); ++c) {
      const double reach = centres[c].spacing > 0 ? kReach * centres[c].spacing : 1.0;
      jumps.block<3, 6>(3 * Eigen::Index(i), 6 * Eigen::Index(c)) = weights[Eigen::Index(c)] * motionsOf(axes, (x[i] - centres[c].place.x) / reach);
    }
  }
  return jumps;
}

}  // namespace Haptos
