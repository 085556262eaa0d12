// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_RCPDecl.hpp>
#include <TpetraCore_config.h>

#include "Haptos_Communication.hpp"

namespace Haptos {

// What headers without maps and vectors take from Trilinos: Haptos_Types_fwd.hpp, which has this too, reads Kokkos, a second a unit.

using Teuchos::RCP;
using LocalOrdinal = int;

/// \brief The default of Tpetra's maps, as Tpetra was configured; Haptos_Types_fwd.hpp compares.
#if defined(HAVE_TPETRA_INST_INT_LONG_LONG)
using GlobalOrdinal = long long;
#elif defined(HAVE_TPETRA_INST_INT_INT)
using GlobalOrdinal = int;
#else
using GlobalOrdinal = long;
#endif

}  // namespace Haptos
