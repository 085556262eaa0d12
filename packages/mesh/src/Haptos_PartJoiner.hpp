// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <vector>

#include "Haptos_ExodusPart.hpp"
#include "Haptos_MeshShare.hpp"

namespace Haptos {

/// \brief Makes shares of a mesh out of its parts, of which every rank has some.  Collective.
///
/// \param path for messages
/// \param parts those of rank 0 begin with the first, whose title is the mesh's
/// \throws InputError  on all ranks: the parts do not belong together
MeshShare joinParts(const Communicator& comm, const std::string& path, std::vector<ExodusPart> parts);

}  // namespace Haptos
