// SPDX-License-Identifier: BSD-3-Clause
// doc/input.md is made from the table of valid parameters.
//
//   input_documentation --check FILE    exit status 1 if FILE is not current
//   input_documentation --write FILE
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

#include "Haptos_Parameters.hpp"

int main(int argc, char* argv[]) {
  const std::string mode = argc == 3 ? argv[1] : "";
  if (mode != "--check" && mode != "--write") {
    std::cerr << "usage: input_documentation --check|--write FILE\n";
    return 2;
  }
  const std::string current = Haptos::inputDocumentation();
  if (mode == "--write") {
    std::ofstream out(argv[2]);
    out << current;
    return out.good() ? 0 : 1;
  }
  std::ifstream in(argv[2]);
  std::stringstream text;
  text << in.rdbuf();
  if (in && text.str() == current) return 0;
  std::cerr << argv[2] << " is not what the valid parameters say; to write it anew:\n    " << argv[0] << " --write " << argv[2] << "\n";
  return 1;
}
