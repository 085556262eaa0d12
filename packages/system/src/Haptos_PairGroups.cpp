// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_PairGroups.hpp"

#include <Tpetra_Map.hpp>
#include <algorithm>
#include <limits>
#include <set>

#include "Haptos_MultiplierMap.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_SurfaceCentres.hpp"

namespace Haptos {
namespace {

constexpr int kPairsOfGroup = 12;   // before they overlap
constexpr double kOverlap = 0.6;    // of the radius of what is a group's own
constexpr double kRoundOff = 1e-9;  // of a distance: pairs in the middle between two centres are the first one's, in any units

// Those that have places, on any rank.  Collective.
std::size_t countInterfaces(const Communicator& comm, const std::vector<SurfacePlace>& places) {
  std::set<int> mine;
  for (const SurfacePlace& place : places) mine.insert(place.interface);
  const std::vector<int> all = gatheredOnAll(comm, std::vector<int>(mine.begin(), mine.end()));
  return std::set<int>(all.begin(), all.end()).size();
}

// [centres] infinite where the interface is another one.  Of one place at a time: of all they would be the largest array there is.
Eigen::VectorXd distancesTo(const std::vector<SurfaceCentre>& centres, const SurfacePlace& place) {
  Eigen::VectorXd result(Eigen::Index(centres.size()));
  for (std::size_t c = 0; c < centres.size(); ++c)
    result[Eigen::Index(c)] = place.interface == centres[c].place.interface ? (place.x - centres[c].place.x).norm() : std::numeric_limits<double>::infinity();
  return result;
}

}  // namespace

std::vector<PairGroup> groupsOfPairs(const MultiplierMap& multipliers, const std::vector<Eigen::Vector3d>& x) {
  const auto& comm = *multipliers.map()->getComm();
  std::vector<SurfacePlace> places;
  for (std::size_t i = 0; i < x.size(); ++i) places.push_back({multipliers.pairs()[i].interface, x[i]});
  // One for each interface at least, and these come first: pairs of one without a centre would be near none.
  const std::size_t wanted = std::max({std::size_t(1), std::size_t(multipliers.numPairs() / kPairsOfGroup), countInterfaces(comm, places)});
  const std::vector<SurfaceCentre> centres = chooseCentres(comm, places, wanted);

  std::vector<Eigen::Index> own(places.size());
  Eigen::VectorXd radius = Eigen::VectorXd::Zero(Eigen::Index(centres.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::VectorXd row = distancesTo(centres, places[i]);
    const double nearest = row.minCoeff() * (1 + kRoundOff);
    while (row[own[i]] > nearest) ++own[i];
    radius[own[i]] = std::max(radius[own[i]], row[own[i]]);
  }
  radius = largestOfAll(comm, radius);

  std::vector<PairGroup> groups(centres.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::VectorXd row = distancesTo(centres, places[i]);
    for (std::size_t c = 0; c < centres.size(); ++c) {
      const bool isOwn = own[i] == Eigen::Index(c);
      if (!isOwn && row[Eigen::Index(c)] > (1 + kOverlap) * (1 + kRoundOff) * radius[Eigen::Index(c)]) continue;
      groups[c].pairs.push_back(int(i));
      groups[c].isOwn.push_back(isOwn);
    }
  }
  return groups;
}

}  // namespace Haptos
