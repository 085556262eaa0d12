// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "Haptos_Mesh.hpp"

namespace Haptos {

/// \brief Reads a three-dimensional mesh from an Exodus II file.  Serial: call it on one rank (see
/// `runOnRoot`).
///
/// Reads classic netCDF and HDF5 files, 32- and 64-bit, names of any length, element blocks of HEX8 and
/// TET4, node sets, side sets and number maps; results in the file are left aside.  Blocks without
/// elements are kept, as HEX8, so that no id is lost.  Every index is checked against its range.
/// \throws InputError  names the file, the block, set or node, and what is wrong with it.
Mesh readExodus(const std::string& path);

}  // namespace Haptos
