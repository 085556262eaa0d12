// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_ContactResults.hpp"
#include "Haptos_ExodusWriter.hpp"
#include "Haptos_LinearElasticity.hpp"
#include "Haptos_NodalGather.hpp"

namespace Haptos {

/// \brief Stresses and subdomain of every element of the mesh, on rank 0; empty elsewhere.
struct ElementResults {
  std::vector<Stress> stress;     ///< [numElements] xx yy zz xy yz zx
  std::vector<double> subdomain;  ///< [numElements]
};

/// \param u on the primal map, \param offsets [local subdomains + 1] into it.  Collective.
ElementResults gatherElementResults(const Communicator& comm, const std::vector<Subdomain>& subdomains,
                                    const std::vector<IsotropicMaterial>& materials, const std::vector<std::size_t>& offsets,
                                    const MultiVector& u, std::size_t numMeshElements);

/// \brief The fields of the result file; serial, on rank 0.
/// \param displacement [3 x numNodes]
ResultFields makeResultFields(std::size_t numNodes, const std::vector<double>& displacement,
                              const std::vector<PairResult>& pairs, const ElementResults& elements, double kkt,
                              long hessianMultiplications);

}  // namespace Haptos
