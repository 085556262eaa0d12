// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief The program `haptos` after MPI has begun: arguments as in `main`, the exit status is returned.  Collective.
///
/// Statuses: doc/input.md; whatever is thrown has become one line on stderr.  An error on one rank of several aborts them all.
int runProgram(const RCP<const Communicator>& comm, int argc, char* argv[]);

}  // namespace Haptos
