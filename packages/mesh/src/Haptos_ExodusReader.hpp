// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "Haptos_MeshShare.hpp"

namespace Haptos {

/// \brief Reads this rank's share of a three-dimensional mesh from an Exodus II file.  Collective.
///
/// Every rank opens the file and reads its own ranges of nodes, elements and members of sets; what is small (sizes, names,
/// ids) all read.  Reads classic netCDF and HDF5 files, 32- and 64-bit, names of any length, element blocks of the types in
/// the element table, node sets, side sets and number maps; of results in the file nodal ones that are asked for.  Blocks without
/// elements are kept, as HEX8, so that no id is lost.  Every index is checked against its range.
/// \param fields names of nodal fields whose values are wanted; of others, if any is, the names are read
/// \throws InputError  on all ranks; names the file, the block, set or node, and what is wrong with it.
MeshShare readExodusShare(const Communicator& comm, const std::string& path, const std::vector<std::string>& fields = {});

/// \brief Reads the whole mesh on one rank.  Serial (see `runOnRoot`); throws as `readExodusShare`.
Mesh readExodus(const std::string& path);

}  // namespace Haptos
