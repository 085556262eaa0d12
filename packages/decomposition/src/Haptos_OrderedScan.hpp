// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "Haptos_PlainTypes.hpp"

namespace Haptos {

/// \brief A number at a place of a list that all ranks have parts of, in any order.
struct PlacedCount {
  GlobalOrdinal place, count;
};

/// \brief For every item of this rank the sum of all items, of any rank, at lower places.  Collective.
///
/// Every rank sums a contiguous range of places.  \param total number of places
std::vector<GlobalOrdinal> scanInOrder(const Communicator& comm, const std::vector<PlacedCount>& items, GlobalOrdinal total);

}  // namespace Haptos
