// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_ConstraintRows.hpp"
#include "Haptos_RowShare.hpp"

namespace Haptos {

/// \brief Numbers the rows of B and sends every rank its share; no rank ever has more than a share of them.  Collective.
///
/// Ranks meet in a `NodeDirectory`: who keeps a node makes its gluing and Dirichlet rows and those of the pairs whose
/// secondary node it is.  Numbers come from exclusive scans.
/// \throws InputError, InsufficientModel on all ranks
RowShare dealRows(const Communicator& comm, const RowSources& sources);

}  // namespace Haptos
