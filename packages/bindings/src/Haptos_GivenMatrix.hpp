// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "Haptos_Types_fwd.hpp"
#include "haptos.h"

namespace Haptos {

/// \brief A subdomain's matrix as it was given, and where the caller's entries belong, in whatever order they come.
struct GivenMatrix {
  std::vector<std::int64_t> starts;
  std::vector<LocalOrdinal> columns;
  RCP<CrsMatrix> K;

  void take(const double* values);  ///< other values in the same places
};

/// \throws InputError where there is no matrix, or none of this size
GivenMatrix givenMatrix(const haptos_subdomain& given);

/// \throws InputError(otherwise) unless it holds
void require(bool holds, const std::string& otherwise);
/// \brief For where each of `count` lists begins in an array, and the last one ends.
/// \throws InputError unless they begin with 0 and do not fall
void requireStarts(const std::int64_t* starts, std::int64_t count, const std::string& what);
/// \brief For counted arrays, none of which is needed for a count of 0.
/// \throws InputError for a count < 0, or where one of them is missing
void requireArrays(std::int64_t count, bool areThere, const std::string& things, const std::string& arrays);

}  // namespace Haptos
