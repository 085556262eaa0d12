// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Haptos {

/// \brief Makes communicationSoFar() count this process's MPI calls, those of Trilinos included.
///
/// By MPI's profiling interface: a program that links this file sends through wrappers that count and call PMPI_*.
/// Counted: blocking and non-blocking sends, and the collectives of MPI 1 with MPI_Iallreduce; persistent sends and
/// one-sided communication, which neither Haptos nor what it calls uses, are not.
void countMpiCalls();

}  // namespace Haptos
