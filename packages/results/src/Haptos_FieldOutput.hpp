// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_ContactResults.hpp"
#include "Haptos_EvenRanges.hpp"
#include "Haptos_ExodusWriter.hpp"
#include "Haptos_LinearElasticity.hpp"
#include "Haptos_NodalGather.hpp"

namespace Haptos {

/// \brief Stresses and subdomain of the elements of this rank's range.
struct ElementResults {
  std::vector<Stress> stress;     ///< [elements of the range] xx yy zz xy yz zx
  std::vector<double> subdomain;  ///< [elements of the range]
};

/// \param u on the primal map, \param offsets [local subdomains + 1] into it
/// \param elements of the mesh, dealt to the ranks.  Collective.
ElementResults gatherElementResults(const Communicator& comm, const std::vector<Subdomain>& subdomains,
                                    const std::vector<IsotropicMaterial>& materials, const std::vector<std::size_t>& offsets,
                                    const MultiVector& u, const EvenRanges& elements);

/// \brief What a step leaves; references are kept.
struct StepResults {
  const std::vector<double>& displacement;  ///< [3 x nodes of this rank's range]
  const std::vector<PairResult>& pairs;     ///< on any rank
  const ElementResults& elements;
  double kkt;
  long hessianMultiplications;
};

/// \brief This rank's part of the fields of the result file.  Collective.
ResultFields makeResultFields(const Communicator& comm, const EvenRanges& nodes, const StepResults& results);

}  // namespace Haptos
