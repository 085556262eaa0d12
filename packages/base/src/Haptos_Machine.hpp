// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

#include "Haptos_Communication.hpp"

namespace Haptos {

/// \brief What seconds depend on, beside the program: written beside them.
struct Machine {
  std::string host;      ///< name of rank 0's
  int hosts = 1;         ///< machines that have ranks
  int processors = 1;    ///< of rank 0's machine
  std::string processor; ///< their model; empty where the system does not tell
  std::string mpi;       ///< name and version of the library
  std::string blas;      ///< what it says of itself, or the name of its file
  std::string trilinos, compiler;
};

/// \brief Rank 0 knows all, the others only `hosts`.  Collective.
Machine describeMachine(const Communicator& comm);

}  // namespace Haptos
