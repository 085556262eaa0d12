// SPDX-License-Identifier: BSD-3-Clause
// One mesh in one file and in several: the same answer, digit by digit.
#include <filesystem>

#include "../../packages/mesh/tests/FileSetTools.hpp"
#include "../../packages/mesh/tests/MeshTestTools.hpp"
#include "Haptos_BoxMesh.hpp"
#include "RankRuns.hpp"

using namespace Haptos;
using namespace Haptos::Testing;

namespace {

SimulationResult runFile(const std::string& file, int subdomains) {
  const std::string origin = HAPTOS_TABLE31;
  std::vector<std::string> warnings;
  auto parameters = parametersFromXml(readTextFile(origin), origin,
                                      {{"Solver->Relative Tolerance", "1e-8"},
                                       {"Decomposition->Method", "METIS"},
                                       {"Decomposition->Subdomains", std::to_string(subdomains)},
                                       {"Output->File", ""},
                                       {"Output->Summary", ""}},
                                      warnings);
  parameters.sublist("Mesh").remove("Two Beams");
  parameters.sublist("Mesh").set("File", file);
  Simulation simulation(world(), parameters);
  simulation.prepare();
  auto result = simulation.solve();
  result.displacement = wholeOnRoot(*world(), result.displacement);
  return result;
}

// Runs of elements in their order; the first part has the end of the lower beam and the start of the upper one.
std::vector<int> layers(const Mesh& mesh, int parts) {
  std::vector<int> part(mesh.numElements());
  for (std::size_t e = 0; e < part.size(); ++e) part[e] = int(e * std::size_t(parts) / part.size());
  std::rotate(part.begin(), part.begin() + std::ptrdiff_t(part.size() / 3), part.end());
  return part;
}

}  // namespace

TEUCHOS_UNIT_TEST(MeshFiles, DecomposedMeshGivesTheDigitsOfTheWholeFile) {
  const HaptosTest::TestFolder folder;
  const auto whole = folder.file("whole.exo"), cut = folder.file("cut.exo");
  HaptosTest::onRoot([&] { writeMesh(whole, makeTwoBeams({2, 2})); });
  const auto expected = runFile(whole, 12);
  TEST_ASSERT(expected.solved);
  for (const int parts : {2, 3}) {
    HaptosTest::onRoot([&] {
      for (const auto& old : folder.entries())
        if (old != "whole.exo") std::filesystem::remove(folder.file(old));
      const Mesh mesh = makeTwoBeams({2, 2});
      HaptosTest::writeFileSet(cut, mesh, layers(mesh, parts), parts);
    });
    const auto found = runFile(cut, 12);
    TEST_EQUALITY(found.report.solver.hessianMultiplications, expected.report.solver.hessianMultiplications);
    TEST_ASSERT(found.displacement == expected.displacement);
    TEST_ASSERT(contactForces(found) == contactForces(expected));
    if (world()->getRank() == 0) TEST_ASSERT(!found.displacement.empty() && !found.pairs.empty());
  }
}
