// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "Haptos_MeshShare.hpp"

namespace Haptos {

/// \brief Reads this rank's share of a three-dimensional mesh from an Exodus II file.  Collective.
///
/// Every rank opens the file and reads its own ranges of nodes, elements and members of sets; what is small (sizes, names,
/// ids) all read.  Reads classic netCDF and HDF5 files, 32- and 64-bit, names of any length, element blocks of HEX8 and
/// TET4, node sets, side sets and number maps; results in the file are left aside.  Blocks without
/// elements are kept, as HEX8, so that no id is lost.  Every index is checked against its range.
/// \throws InputError  on all ranks; names the file, the block, set or node, and what is wrong with it.
MeshShare readExodusShare(const Communicator& comm, const std::string& path);

/// \brief Reads the whole mesh on one rank.  Serial (see `runOnRoot`); throws as `readExodusShare`.
Mesh readExodus(const std::string& path);

}  // namespace Haptos
