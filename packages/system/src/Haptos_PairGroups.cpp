// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PairGroups.hpp"

#include <Tpetra_Map.hpp>
#include <algorithm>
#include <limits>

#include "Haptos_MultiplierMap.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_SurfaceCentres.hpp"

namespace Haptos {
namespace {

constexpr int kPairsOfGroup = 12;   // before they overlap
constexpr double kOverlap = 0.6;    // of the radius of what is a group's own
constexpr double kRoundOff = 1e-9;  // of a distance: pairs in the middle between two centres are the first one's, in any units

// [places x centres], infinite where the interface is another one
Eigen::MatrixXd distances(const std::vector<SurfacePlace>& places, const std::vector<SurfaceCentre>& centres) {
  Eigen::MatrixXd result(Eigen::Index(places.size()), Eigen::Index(centres.size()));
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t c = 0; c < centres.size(); ++c)
      result(Eigen::Index(i), Eigen::Index(c)) =
          places[i].interface == centres[c].place.interface ? (places[i].x - centres[c].place.x).norm() : std::numeric_limits<double>::infinity();
  return result;
}

}  // namespace

std::vector<PairGroup> groupsOfPairs(const MultiplierMap& multipliers, const std::vector<Eigen::Vector3d>& x) {
  const auto& comm = *multipliers.map()->getComm();
  std::vector<SurfacePlace> places;
  for (std::size_t i = 0; i < x.size(); ++i) places.push_back({multipliers.pairs()[i].interface, x[i]});
  const auto wanted = std::size_t(std::max<GlobalOrdinal>(1, multipliers.numPairs() / kPairsOfGroup));
  const std::vector<SurfaceCentre> centres = chooseCentres(comm, places, wanted);
  const Eigen::MatrixXd distance = distances(places, centres);

  std::vector<Eigen::Index> own(places.size());
  Eigen::VectorXd radius = Eigen::VectorXd::Zero(Eigen::Index(centres.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto row = distance.row(Eigen::Index(i));
    const double nearest = row.minCoeff() * (1 + kRoundOff);
    while (row[own[i]] > nearest) ++own[i];
    radius[own[i]] = std::max(radius[own[i]], row[own[i]]);
  }
  radius = largestOfAll(comm, radius);

  std::vector<PairGroup> groups(centres.size());
  for (std::size_t i = 0; i < places.size(); ++i)
    for (std::size_t c = 0; c < centres.size(); ++c) {
      const bool isOwn = own[i] == Eigen::Index(c);
      if (!isOwn && distance(Eigen::Index(i), Eigen::Index(c)) > (1 + kOverlap) * (1 + kRoundOff) * radius[Eigen::Index(c)]) continue;
      groups[c].pairs.push_back(int(i));
      groups[c].isOwn.push_back(isOwn);
    }
  return groups;
}

}  // namespace Haptos
