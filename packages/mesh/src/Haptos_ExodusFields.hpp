// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "Haptos_Mesh.hpp"

namespace Haptos {

/// \brief A range of the nodes of a file.
struct ExodusNodes {
  std::int64_t first, count, total;
};

/// \brief `count` texts of an open Exodus file, of any length, that `get` reads into its argument.
/// \return what `get` returns: below 0 if that fails
int readTexts(int file, std::int64_t count, const std::function<int(char**)>& get, std::vector<std::string>& texts);

/// \brief All nodal fields of an open Exodus file by name; with values, of the last time step, those that are `wanted`.  Serial.
/// \throws InputError for one that is wanted and has no value, or not one a node, in the file; one that is not there is not refused here
std::vector<NodalField> readNodalFields(int file, const std::string& path, const ExodusNodes& nodes, const std::vector<std::string>& wanted);

}  // namespace Haptos
