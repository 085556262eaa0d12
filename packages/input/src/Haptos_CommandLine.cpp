// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_CommandLine.hpp"

#include <algorithm>

#include "Haptos_Error.hpp"
#include "Haptos_NearestName.hpp"
#include "Haptos_ParameterValue.hpp"

namespace Haptos {

namespace {

const std::vector<std::string> valueOptions = {"--set", "--output", "--summary"};
const std::vector<std::string> flagOptions = {"--validate-only", "--print-parameters", "--version", "--help"};

bool isIn(const std::vector<std::string>& options, const std::string& option) {
  return std::find(options.begin(), options.end(), option) != options.end();
}

/// At the first '=': names have none, values may.
std::pair<std::string, std::string> splitAssignment(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || trimmed(text.substr(0, equals)).empty())
    throw InputError("--set '" + text + "': write it as --set \"Solver->Relative Tolerance=1e-8\"");
  return {trimmed(text.substr(0, equals)), trimmed(text.substr(equals + 1))};
}

/// A second one would silently win.
void setFileOption(std::string& target, const std::string& option, const std::string& value) {
  if (!target.empty()) throw InputError(option + ": is given twice ('" + target + "' and '" + value + "')");
  if (value.empty()) throw InputError(option + ": the file name is empty");
  target = value;
}

void applyValueOption(CommandLine& line, const std::string& option, const std::string& value) {
  if (option == "--set")
    line.sets.push_back(splitAssignment(value));
  else
    setFileOption(option == "--output" ? line.output : line.summary, option, value);
}

void applyFlag(CommandLine& line, const std::string& option) {
  if (option == "--validate-only") line.validateOnly = true;
  if (option == "--print-parameters") line.printParameters = true;
  if (option == "--version") line.version = true;
  if (option == "--help") line.help = true;
}

/// With the option that was meant, most likely, and all that there are.
[[noreturn]] void refuseOption(const std::string& option) {
  auto valid = valueOptions;
  valid.insert(valid.end(), flagOptions.begin(), flagOptions.end());
  throw InputError("unknown option '" + option + "'" + suggestion(option, valid) + " Valid: " + joinNames(valid));
}

void setInput(CommandLine& line, const std::string& name) {
  if (!line.input.empty())
    throw InputError("two input files are given, '" + line.input + "' and '" + name + "'; give one");
  line.input = name;
}

/// Reads the option at `position`, and moves it on where the next argument is the option's value.
void readOption(CommandLine& line, const std::vector<std::string>& arguments, std::size_t& position) {
  const std::string& argument = arguments[position];
  const auto equals = argument.find('=');
  const bool hasValue = equals != std::string::npos;
  const std::string option = argument == "-h" ? "--help" : argument.substr(0, equals);
  if (isIn(flagOptions, option)) {
    if (hasValue) throw InputError(option + ": takes no value, '" + argument + "' is given");
    applyFlag(line, option);
  } else if (isIn(valueOptions, option)) {
    // what begins with "--" is the next option and not a value that was forgotten
    const bool follows = position + 1 < arguments.size() && arguments[position + 1].compare(0, 2, "--") != 0;
    if (!hasValue && !follows) throw InputError(option + ": its value is missing");
    applyValueOption(line, option, hasValue ? argument.substr(equals + 1) : arguments[++position]);
  } else {
    refuseOption(option);
  }
}

}  // namespace

// Options may stand before and after the one input file; all of them are read before anything is done.
CommandLine parseCommandLine(const std::vector<std::string>& arguments) {
  CommandLine line;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i].empty()) throw InputError("an argument is empty; give the path of an XML file");
    if (arguments[i][0] == '-')
      readOption(line, arguments, i);
    else
      setInput(line, arguments[i]);
  }
  if (line.input.empty() && !line.help && !line.version && !line.printParameters)
    throw InputError("no input file is given; usage: haptos INPUT.xml [options], see haptos --help");
  return line;
}

CommandLine parseCommandLine(int argc, const char* const* argv) {
  return parseCommandLine(std::vector<std::string>(argv + std::min(argc, 1), argv + argc));
}

// What contract there is with scripts stands here: options and exit statuses.
std::string helpText() {
  return R"(usage: mpirun -n RANKS haptos INPUT.xml [options]

Solves static contact of linearly elastic bodies with orthotropic friction by Total FETI.
INPUT.xml is a Teuchos parameter list; file names inside it are relative to its folder.

  --set "LIST->PARAMETER=VALUE"  overrides or adds one parameter; may be repeated
  --output RESULT.exo            result file (Exodus II) instead of Output->File
  --summary SUMMARY.json         summary file instead of Output->Summary
  --validate-only                checks input and mesh and prints the model; nothing is solved
  --print-parameters             prints every valid parameter: name, type, default, range, meaning
  --version                      prints the version
  --help                         prints this text

Exit status: 0 solved to the requested tolerance; 1 the input is wrong; 2 not converged;
3 the problem has no solution or the model is insufficient; 70 internal error.
)";
}

std::string versionNumber() { return HAPTOS_VERSION; }

std::string versionText() { return "haptos " + versionNumber(); }

}  // namespace Haptos
