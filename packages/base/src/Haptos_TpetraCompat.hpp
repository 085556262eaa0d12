// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Teuchos_ArrayView.hpp>
#include <cstddef>

namespace Haptos {

// Newer Trilinos says getLocal... where 13.2 says getNode...; these functions take whichever is there.
// The int argument makes the first overload, with the new name, the better match.
namespace Compat {

#define HAPTOS_EITHER_NAME(function, newName, oldName)    \
  template <class T>                                      \
  auto function(const T& t, int)->decltype(t.newName()) { \
    return t.newName();                                   \
  }                                                       \
  template <class T>                                      \
  auto function(const T& t, long)->decltype(t.oldName()) { \
    return t.oldName();                                   \
  }

HAPTOS_EITHER_NAME(numElements, getLocalNumElements, getNodeNumElements)
HAPTOS_EITHER_NAME(elementList, getLocalElementList, getNodeElementList)
HAPTOS_EITHER_NAME(numRows, getLocalNumRows, getNodeNumRows)
HAPTOS_EITHER_NAME(numEntries, getLocalNumEntries, getNodeNumEntries)
HAPTOS_EITHER_NAME(maxNumRowEntries, getLocalMaxNumRowEntries, getNodeMaxNumRowEntries)
#undef HAPTOS_EITHER_NAME

}  // namespace Compat

/// \brief Number of indices of `map` on this rank.
template <class M>
std::size_t localNumElements(const M& map) {
  return Compat::numElements(map, 0);
}

/// \brief Global indices of `map` on this rank, by local index; valid as long as the map.
template <class M>
auto localElementList(const M& map) {
  return Compat::elementList(map, 0);
}

/// \brief Number of rows of a matrix or graph on this rank.
template <class A>
std::size_t localNumRows(const A& matrix) {
  return Compat::numRows(matrix, 0);
}

/// \brief Number of stored entries of a matrix or graph on this rank.
template <class A>
std::size_t localNumEntries(const A& matrix) {
  return Compat::numEntries(matrix, 0);
}

/// \brief Largest number of entries in one row on this rank.
template <class A>
std::size_t localMaxNumRowEntries(const A& matrix) {
  return Compat::maxNumRowEntries(matrix, 0);
}

}  // namespace Haptos
