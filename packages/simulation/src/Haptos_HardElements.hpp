// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_Communication.hpp"
#include "Haptos_LinearElasticity.hpp"
#include "Haptos_Subdomain.hpp"

namespace Haptos {

/// \brief Poisson's ratio from which an element resists changes of volume so much more than others that F does not mirror it.
constexpr double kNearlyIncompressible = 0.4;

/// \brief And from which a preconditioner with `kNearlyIncompressible` in its place is one of another body, and plain elements lock (decisions/011, 042).
constexpr double kHardlyCompressible = 0.45;

/// \brief Whether any element has middle nodes, is nearly incompressible, or the elements of a subdomain are stretched.
///
/// The preconditioner is poor there from the first step on: 40 to 190 multiplications without contact, where its spectral modes leave 14 to 30
/// (decisions/042).  Collective.
bool hasHardElements(const Communicator& comm, const std::vector<Subdomain>& subdomains, const std::vector<IsotropicMaterial>& materials);

}  // namespace Haptos
