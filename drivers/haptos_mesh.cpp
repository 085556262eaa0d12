// SPDX-License-Identifier: BSD-3-Clause
// Makes benchmark meshes and tells what is in an Exodus file.  Serial.
#include <Teuchos_DefaultSerialComm.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <iostream>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_ExodusWriter.hpp"
#include "Haptos_MeshFiles.hpp"

namespace {

using Haptos::InputError;

constexpr const char* usage = R"(Usage:
  haptos_mesh two-beams --subdomains-per-edge K --elements-per-subdomain-edge P --output FILE.exo
      writes the benchmark of two beams: each body has 2K x K x K bricks of P^3 hexahedra
  haptos_mesh info FILE.exo
      prints blocks, sets, counts and the bounding box of an Exodus file, or of a decomposed mesh
  haptos_mesh --help | --version
Exit status: 0 done, 1 wrong usage or a wrong file, 70 another error.
)";

/// The values of "--name value" pairs; every wanted one must be there, and no other.
std::map<std::string, std::string> readOptions(const std::vector<std::string>& arguments,
                                               const std::vector<std::string>& wanted) {
  std::map<std::string, std::string> values;
  for (std::size_t i = 1; i < arguments.size(); i += 2) {
    const auto& name = arguments[i];
    if (std::find(wanted.begin(), wanted.end(), name) == wanted.end())
      throw InputError("Unknown option '" + name + "' of '" + arguments[0] + "'; see haptos_mesh --help.");
    if (i + 1 == arguments.size()) throw InputError("Option '" + name + "' needs a value.");
    if (!values.emplace(name, arguments[i + 1]).second)
      throw InputError("Option '" + name + "' is given twice.");
  }
  for (const auto& name : wanted)
    if (values.count(name) == 0)
      throw InputError("'" + arguments[0] + "' needs the option '" + name + "'; see haptos_mesh --help.");
  return values;
}

int toCount(const std::string& name, const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 1)
    throw InputError("Option '" + name + "' is '" + text + "'; a whole number of at least 1 is wanted.");
  return value;
}

void writeTwoBeams(const std::vector<std::string>& arguments) {
  const std::string edge = "--subdomains-per-edge", elements = "--elements-per-subdomain-edge",
                    output = "--output";
  const auto options = readOptions(arguments, {edge, elements, output});
  const Haptos::TwoBeamsSpec spec{toCount(edge, options.at(edge)), toCount(elements, options.at(elements))};
  Haptos::requireWritableFolder(options.at(output), "Option --output");
  const auto mesh = Haptos::makeTwoBeams(spec);
  Haptos::writeMesh(options.at(output), mesh);
  std::cout << options.at(output) << ": " << mesh.numNodes() << " nodes, " << mesh.numElements()
            << " elements\n";
}

void printBoundingBox(const Haptos::Mesh& mesh) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::array<double, 3> low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
  for (const auto& x : mesh.coordinates)
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::min(low[d], x[d]);
      high[d] = std::max(high[d], x[d]);
    }
  std::cout << "Bounding box:";
  for (std::size_t d = 0; d < 3; ++d) std::cout << " [" << low[d] << ", " << high[d] << "]";
  std::cout << "\n";
}

std::string label(std::int64_t id, const std::string& name) {
  return "  " + std::to_string(id) + (name.empty() ? "" : " " + name) + ": ";
}

void printInfo(const std::string& path) {
  const auto mesh = Haptos::readMeshFiles(Teuchos::SerialComm<int>(), path).part;
  std::cout << "File: " << path << (mesh.wideIntegers ? " (64-bit numbers)" : "") << "\n";
  if (!mesh.title.empty()) std::cout << "Title: " << mesh.title << "\n";
  std::cout << "Nodes: " << mesh.numNodes() << "\nElements: " << mesh.numElements() << "\n";
  printBoundingBox(mesh);
  std::cout << "Element blocks: " << mesh.blocks.size() << "\n";
  for (const auto& block : mesh.blocks)
    std::cout << label(block.id, block.name) << block.numElements() << " elements "
              << Haptos::topologyName(block.topology) << "\n";
  std::cout << "Side sets: " << mesh.sideSets.size() << "\n";
  for (const auto& set : mesh.sideSets)
    std::cout << label(set.id, set.name) << set.sides.size() << " sides\n";
  std::cout << "Node sets: " << mesh.nodeSets.size() << "\n";
  for (const auto& set : mesh.nodeSets)
    std::cout << label(set.id, set.name) << set.nodes.size() << " nodes\n";
}

void run(const std::vector<std::string>& arguments) {
  if (arguments.empty()) throw InputError("A command is wanted: two-beams or info; see haptos_mesh --help.");
  const auto& command = arguments[0];
  if (command == "--help" || command == "-h") {
    std::cout << usage;
  } else if (command == "--version") {
    std::cout << "haptos_mesh " << HAPTOS_VERSION << "\n";
  } else if (command == "two-beams") {
    writeTwoBeams(arguments);
  } else if (command == "info") {
    if (arguments.size() != 2) throw InputError("'info' needs exactly one file; see haptos_mesh --help.");
    printInfo(arguments[1]);
  } else {
    throw InputError("Unknown command '" + command +
                     "'; two-beams and info are known, see haptos_mesh --help.");
  }
}

}  // namespace

int main(int argc, char* argv[]) {
  try {
    run({argv + 1, argv + argc});
    return 0;
  } catch (const InputError& e) {
    std::cerr << "haptos_mesh: " << e.what() << "\n";
    return 1;
  } catch (const std::exception& e) {
    std::cerr << "haptos_mesh: " << e.what() << "\n";
    return 70;
  }
}
