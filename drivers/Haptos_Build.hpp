// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

namespace Haptos {

/// \brief Commit and flags of the program, "0a1b2c3d4 Release -O3 -DNDEBUG"; "+" after the commit where files differ from it.
std::string buildText();

}  // namespace Haptos
