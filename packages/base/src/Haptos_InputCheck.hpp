// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <sstream>

#include "Haptos_Error.hpp"

/// Throws InputError where `condition` holds; `message` is put together by <<.
///
/// For the user's mistakes: Teuchos' own macros put their file, line and condition into the text.
#define HAPTOS_REFUSE_IF(condition, message)      \
  do { \
    if (condition) {                              \
      std::ostringstream haptosRefusal;           \
      haptosRefusal << message;                   \
      throw ::Haptos::InputError(haptosRefusal.str()); \
    }                                             \
  } while (false)
