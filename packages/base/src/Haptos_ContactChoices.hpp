// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_Choices.hpp"

namespace Haptos {

/// \brief Where bodies overlap at the start: pressed apart (an interference fit), or as if they touched.
enum class InitialPenetration { Resolve, Ignore };
template <>
struct Choices<InitialPenetration> {
  using E = InitialPenetration;
  static constexpr Choice<E> all[] = {{E::Resolve, "Resolve"}, {E::Ignore, "Ignore"}};
};

/// \brief The surface that gaps of mortar are measured to: linear faces as they are, or a curved one through their nodes.
enum class PrimarySmoothing { None, Nagata, Cylinder, Sphere };
template <>
struct Choices<PrimarySmoothing> {
  using E = PrimarySmoothing;
  static constexpr Choice<E> all[] = {{E::None, "None"}, {E::Nagata, "Nagata"}, {E::Cylinder, "Cylinder"}, {E::Sphere, "Sphere"}};
};

}  // namespace Haptos
