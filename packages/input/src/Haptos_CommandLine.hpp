// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace Haptos {

/// \brief What the user asked for on the command line of `haptos`.
struct CommandLine {
  std::string input;  ///< XML file; empty only with help, version, printParameters
  std::vector<std::pair<std::string, std::string>> sets;  ///< path and value of every --set, in order
  std::string output;   ///< --output, relative to the current folder; may be empty
  std::string summary;  ///< --summary, as output
  bool validateOnly = false;
  bool printParameters = false;
  bool version = false;
  bool help = false;
};

/// \brief Reads the arguments (without the program's name).
///
/// "--option VALUE" and "--option=VALUE" are the same; options and the input may come in any order.
/// \throws InputError for an unknown option (with the nearest valid one), a missing value, no input or two
CommandLine parseCommandLine(const std::vector<std::string>& arguments);

/// \brief As above, from `main`; argv[0] is skipped.
CommandLine parseCommandLine(int argc, const char* const* argv);

std::string helpText();
std::string versionText();    ///< "haptos 0.1.0"
std::string versionNumber();  ///< "0.1.0"

}  // namespace Haptos
