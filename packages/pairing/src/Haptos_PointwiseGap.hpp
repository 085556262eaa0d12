// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <vector>

#include "Haptos_ContactChoices.hpp"
#include "Haptos_ContactPair.hpp"
#include "Haptos_ContactSurface.hpp"
#include "Haptos_FacetTree.hpp"
#include "Haptos_RoundSurface.hpp"

namespace Haptos {

/// \brief Distances from nodes along their normals to the nearest face of the primary surface, either way.  Serial.
///
/// With smoothing to a curved surface instead: of quadratic patches (`nagataSurface`), or the cylinder or sphere that fits the primary nodes best
/// (`fitCylinder`), where a face lies opposite.
class PointwiseGap {
 public:
  /// \param secondary must outlive it
  /// \param interface gets a remark of what was fitted
  /// \throws InputError where the primary surface is no cylinder or sphere
  PointwiseGap(const ContactSurface& secondary, const ContactSurface& primary, PrimarySmoothing smoothing, ContactInterface& interface);

  std::optional<double> at(int node);  ///< nothing where no face lies opposite

 private:
  const ContactSurface& s_;
  ContactSurface p_;
  FacetTree tree_;
  std::optional<RoundSurface> round_;
  std::vector<int> found_;
};

}  // namespace Haptos
