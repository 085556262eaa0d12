// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "Haptos_ContactChoices.hpp"
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
  /// \throws InputError where the primary surface is no cylinder or sphere
  PointwiseGap(const ContactSurface& primary, PrimarySmoothing smoothing);

  std::optional<double> at(const ContactSurface& secondary, int node);  ///< nothing where no face lies opposite

 private:
  ContactSurface p_;
  FacetTree tree_;
  std::optional<RoundSurface> round_;
  std::vector<int> found_;
};

/// \brief The cylinder or sphere that is taken in place of a surface, if one is.  \throws InputError as above
std::optional<RoundSurface> roundSurface(const ContactSurface& primary, PrimarySmoothing smoothing);

/// \brief "gaps of 'joint' are measured to the cylinder of radius 2 ...": for the report.
std::string describe(const RoundSurface& round, const std::string& surface, const std::string& interface);

}  // namespace Haptos
