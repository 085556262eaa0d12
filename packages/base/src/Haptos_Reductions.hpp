// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_CommHelpers.hpp>
#include <type_traits>

#include "Haptos_Communication.hpp"

namespace Haptos {

// One value of every rank becomes one on all; of arrays (std::vector, std::array, Eigen's) entry by entry, their sizes the same
// on all ranks.  All Collective.

template <class Values>
Values reduced(const Communicator& comm, Teuchos::EReductionType how, const Values& mine) {
  Values all(mine);
  if constexpr (std::is_arithmetic_v<Values>) Teuchos::reduceAll(comm, how, mine, Teuchos::outArg(all));
  else if (mine.size() > 0) Teuchos::reduceAll(comm, how, int(mine.size()), mine.data(), all.data());
  return all;
}

template <class Values>
Values sumOfAll(const Communicator& comm, const Values& mine) {
  return reduced(comm, Teuchos::REDUCE_SUM, mine);
}
template <class Values>
Values largestOfAll(const Communicator& comm, const Values& mine) {
  return reduced(comm, Teuchos::REDUCE_MAX, mine);
}
template <class Values>
Values leastOfAll(const Communicator& comm, const Values& mine) {
  return reduced(comm, Teuchos::REDUCE_MIN, mine);
}
inline bool anyOfAll(const Communicator& comm, bool mine) { return largestOfAll(comm, int(mine)) != 0; }

/// \brief Sum over the ranks below this one: where this one's begin in a common numbering.
template <class Values>
Values sumOfLower(const Communicator& comm, const Values& mine) {
  Values sums(mine);
  if constexpr (std::is_arithmetic_v<Values>) {
    Teuchos::scan(comm, Teuchos::REDUCE_SUM, mine, Teuchos::outArg(sums));
    return sums - mine;
  } else {
    if (mine.size() > 0) Teuchos::scan(comm, Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), sums.data());
    for (std::size_t i = 0; i < std::size_t(mine.size()); ++i) sums[i] -= mine[i];
    return sums;
  }
}

}  // namespace Haptos
