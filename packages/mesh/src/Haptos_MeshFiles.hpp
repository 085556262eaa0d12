// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "Haptos_MeshShare.hpp"

namespace Haptos {

/// \brief Reads this rank's share of the mesh `path`: of that Exodus file, or, where there is none of that name, of the
/// files path.N.0 .. path.N.(N - 1) into which SEACAS' decomp or nem_spread have cut it.  Collective.
///
/// Of a decomposed mesh every rank reads some whole files; N need not be the number of ranks.  Their number maps say
/// which node and element of the whole mesh each is: nodes are numbered by ascending number, elements by block and then by
/// ascending number, as in the file that was cut.  Nodes of node sets come by ascending index, sides by element and side.
/// \param fields as `readExodusShare`
/// \throws InputError  on all ranks; as `readExodusShare`, or a file is missing, or the files do not belong together.
MeshShare readMeshFiles(const Communicator& comm, const std::string& path, const std::vector<std::string>& fields = {});

/// \brief The files of the mesh `path`: itself, or path.N.0 .. path.N.(N - 1) in their order.  Serial.
/// \throws InputError  one is missing, or they are there for more than one N.
std::vector<std::string> listMeshFiles(const std::string& path);

}  // namespace Haptos
