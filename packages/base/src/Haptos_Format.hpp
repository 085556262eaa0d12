// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdio>
#include <string>

namespace Haptos {

/// \brief A number in a printf format, at most 63 characters.
inline std::string formatted(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace Haptos
