// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_CommHelpers.hpp>
#include <algorithm>
#include <cstdint>
#include <type_traits>

#include "Haptos_Communication.hpp"

namespace Haptos {

// One value of every rank becomes one on all; of arrays (std::vector, std::array, Eigen's) entry by entry, their sizes the same
// on all ranks.  All Collective.

// MPI counts by int: arrays of more entries, as dense matrices of 46341 rows, go in parts of at most `most`.
template <class Value>
void reduceParts(const Communicator& comm, Teuchos::EReductionType how, std::int64_t count, const Value* mine, Value* all,
                 std::int64_t most = std::int64_t(1) << 28) {
  for (std::int64_t at = 0; at < count; at += most) Teuchos::reduceAll(comm, how, int(std::min(most, count - at)), mine + at, all + at);
}

template <class Values>
Values reduced(const Communicator& comm, Teuchos::EReductionType how, const Values& mine) {
  Values all(mine);
  if constexpr (std::is_arithmetic_v<Values>) Teuchos::reduceAll(comm, how, mine, Teuchos::outArg(all));
  else reduceParts(comm, how, std::int64_t(mine.size()), mine.data(), all.data());
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
