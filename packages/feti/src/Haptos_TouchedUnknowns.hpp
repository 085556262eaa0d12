// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_JumpOperator.hpp"

namespace Haptos {

class LocalSystems;

/// \brief Unknowns of subdomains that rows of B touch: what is not free to follow in the Dirichlet preconditioner.
///
/// Subdomains whose K has one pattern share one list, on whatever ranks they are: congruent ones, which share one S, are among
/// them, and M must not depend on how subdomains are dealt out (decisions/039).
class TouchedUnknowns {
 public:
  /// \brief Lists of this rank's subdomains, whose patterns `systems` knows.  Collective: one message there and one back.
  TouchedUnknowns(const LocalSystems& systems, const JumpOperator& jump);

  /// \brief [ascending] local unknowns of local subdomain i.
  const std::vector<int>& of(int i) const { return lists_[std::size_t(listOf_[std::size_t(i)])]; }

 private:
  std::vector<int> listOf_;              // [local subdomains]
  std::vector<std::vector<int>> lists_;  // [patterns on this rank]
};

}  // namespace Haptos
