// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_MortarSides.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <numeric>
#include <vector>

#include "Haptos_DualMortar.hpp"
#include "Haptos_MultiplierRules.hpp"
#include "Haptos_SurfaceOverlap.hpp"
#include "Haptos_Vec3.hpp"

namespace Haptos {
namespace {

// Largest Young's modulus of the elements at a surface.
double stiffnessAt(const Mesh& mesh, const ContactSurroundings& around, const std::string& sideSet) {
  double stiffness = 0;
  const auto offsets = blockOffsets(mesh);
  for (const auto& side : mesh.sideSets[std::size_t(findSideSet(mesh, sideSet))].sides)
    stiffness = std::max(stiffness, around.youngsModulus[std::size_t(locateElement(offsets, side.element).block)]);
  return stiffness;
}

double meanArea(const ContactSurface& surface) {
  return std::accumulate(surface.areas.begin(), surface.areas.end(), 0.0) / double(surface.faces.size());
}

// [nodes] of those that supports take their multiplier
std::vector<Bar> barsOfHeld(const ContactSpec& spec, const ContactSurroundings& around, const ContactSurface& surface) {
  std::vector<Bar> bars(surface.numNodes(), Bar::None);
  for (std::size_t i = 0; i < surface.numNodes() && !around.isPrescribed.empty(); ++i)
    if (isHeldFor(spec, around.isPrescribed[std::size_t(surface.nodes[i])], surface.normals[i])) bars[i] = Bar::Held;
  return bars;
}

// How many motions multipliers resist that this side would carry: none where all is held, 1 if they are at a point, 2 on a line, about which bodies may
// tilt, 3 on a surface.
int rankOfMultipliers(const ContactSpec& spec, const ContactSurroundings& around, const ContactSurface& surface, const ContactSurface& opposite) {
  constexpr double kThin = 1e-6;  // of the longest extent
  const std::vector<Bar> bars = barsOfHeld(spec, around, surface);
  if (std::count(bars.begin(), bars.end(), Bar::Held) == std::ptrdiff_t(bars.size())) return 0;
  const auto isKept = chooseMultipliers(surface, roughOverlap(surface, opposite), bars, spec.multiplierSpace == MultiplierSpace::Linear).isKept;
  std::vector<std::size_t> carriers;
  for (std::size_t i = 0; i < isKept.size(); ++i)
    if (isKept[i]) carriers.push_back(i);
  if (carriers.empty()) return 0;
  Eigen::Matrix3Xd offsets(3, Eigen::Index(carriers.size()));
  for (std::size_t k = 0; k < carriers.size(); ++k) {
    const auto offset = Vec3::subtract(surface.coordinates[carriers[k]], surface.coordinates[carriers.front()]);
    offsets.col(Eigen::Index(k)) = Eigen::Vector3d(offset.data());
  }
  Eigen::ColPivHouseholderQR<Eigen::Matrix3Xd> qr;
  qr.setThreshold(kThin);
  qr.compute(offsets);
  return 1 + std::min(2, int(qr.rank()));
}

// Why the given primary side is the better one to carry multipliers, by material and mesh; empty: it is not.
std::string reasonOfBodies(const Mesh& mesh, const ContactSpec& spec, const ContactSurroundings& around, const ContactSurface& secondary,
                           const ContactSurface& primary) {
  constexpr double kStiffer = 1.5, kFiner = 0.8;  // ratios that differ by more than chance
  if (!around.youngsModulus.empty()) {
    const double E1 = stiffnessAt(mesh, around, spec.secondarySideSet), E2 = stiffnessAt(mesh, around, spec.primarySideSet);
    if (E1 > kStiffer * E2) return "the softer of the two";
    if (E2 > kStiffer * E1) return "";
  }
  return meanArea(primary) < kFiner * meanArea(secondary) ? "the finer of the two" : "";
}

}  // namespace

// The better side by material and mesh, unless it would have too few multipliers to resist a tilt, and the other one more of them.
std::string reasonToExchange(const Mesh& mesh, const ContactSpec& spec, const ContactSurroundings& around, const ContactSurface& secondary,
                             const ContactSurface& primary) {
  if (spec.sides == ContactSides::AsGiven || spec.isToldAtNodes) return "";
  const std::string reason = reasonOfBodies(mesh, spec, around, secondary, primary);
  const ContactSurface &better = reason.empty() ? secondary : primary, &other = reason.empty() ? primary : secondary;
  const int rank = rankOfMultipliers(spec, around, better, other);
  if (rank == 3 || rankOfMultipliers(spec, around, other, better) <= rank) return reason;
  if (!reason.empty()) return "";
  return rank == 0 ? "which is not held" : "which has more nodes to carry them";
}

}  // namespace Haptos
