// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "Haptos_ContactChoices.hpp"
#include "Haptos_ContactPair.hpp"

namespace Haptos {

struct ContactSurface;

/// \brief Secondary nodes of an interface that nothing lies opposite at the start, and the faces that they may be carried to.  Serial.
///
/// Rows belong to what lies opposite at the start, so that such a node has none, and may be carried sideways into the other body.  Under
/// displacements u, with y = x + u on both sides, let the line through y_s along n meet a primary face, looking at it, at sum N_l y_l.  Then
///
///   depth = n . (u_s - sum N_l u_l) - gap,  gap = n . (sum N_l x_l - x_s) or the given one,
///
/// is what a row of the node with the nodes of that face lacks: with the row in the system the node stays outside of the face that it came to.
class UnpairedNodes {
 public:
  struct Node {
    ContactPair pair;             ///< nothing in `primary`, no gap
    std::array<double, 3> place;
    std::optional<double> gap;    ///< where the user gives it
  };

  UnpairedNodes(std::vector<Node> nodes, const ContactSurface& primary, InitialPenetration penetration);
  ~UnpairedNodes();

  /// \brief Drops nodes that must not get a row.
  void drop(const std::function<bool(const ContactPair&)>& isToDrop);
  void renumber(const std::vector<std::int64_t>& nodes);  ///< \param nodes [mesh nodes so far] their new numbers

  /// \brief Mesh nodes whose displacements tell: the unpaired ones, then those of the primary surface.
  std::vector<std::int64_t> meshNodes() const;

  /// \brief Pairs of the nodes that are deeper inside than `tolerance`, ascending.  Faces that a node lies behind at the start do not count, nor
  /// does what is deeper than the node's element: such displacements are not small, as where somebody takes E = 1 and loads of 1.
  /// \param displacements at `meshNodes()`
  std::vector<ContactPair> pairsUnder(const std::vector<std::array<double, 3>>& displacements, double tolerance) const;

 private:
  std::vector<Node> nodes_;
  std::unique_ptr<ContactSurface> primary_;
  InitialPenetration penetration_;
};

}  // namespace Haptos
