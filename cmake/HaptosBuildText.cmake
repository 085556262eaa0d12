# SPDX-License-Identifier: BSD-3-Clause
# Script, run before every build: writes FILE, the C++ source of `buildText`, anew where the commit in SOURCE or the FLAGS changed.
execute_process(COMMAND git -C ${SOURCE} describe --always --abbrev=9 --exclude * --dirty=+ OUTPUT_VARIABLE commit
                OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  set(commit "unknown")   # no repository, or no git
endif()
file(CONFIGURE OUTPUT ${FILE} @ONLY CONTENT [[
// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Build.hpp"

std::string Haptos::buildText() { return "@commit@ @FLAGS@"; }
]])
