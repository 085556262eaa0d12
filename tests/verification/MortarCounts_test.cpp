// SPDX-License-Identifier: BSD-3-Clause
// Meshes that do not match cost hardly more multiplications by F than matching ones of the same size, whichever side is stiffer.
#include <Teuchos_DefaultSerialComm.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "Haptos_CellMesh.hpp"
#include "Haptos_Partition.hpp"
#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

struct Beams {
  int lower, upper;           ///< elements an edge of length 1
  double shift = 0;           ///< of the upper mesh, in its elements
  double contrast = 1;        ///< E of the upper beam by that of the lower
  std::string method = "METIS";
  int subdomains = 32;        ///< of METIS, 0 chooses
  int bricks = 2;             ///< an edge of length 1
  Topology topology = Topology::Hex8;
};

std::vector<BoxSpec> beamBoxes(const Beams& beams) {
  BoxSpec lower, upper;
  lower.blockName = "lower";
  lower.lower = {0, 0, -1};
  lower.upper = {2, 1, 0};
  lower.divisions = {2 * beams.lower, beams.lower, beams.lower};
  lower.sideSetNames = {"clamp", "", "", "", "bottom", "lower_contact"};
  upper.blockName = "upper";
  upper.upper = {2, 1, 1};
  upper.divisions = {2 * beams.upper, beams.upper, beams.upper};
  upper.sideSetNames = {"clamp", "end", "", "", "upper_contact", "top"};
  const double by = 4 * beams.shift / beams.upper;
  upper.map = [by](const Array3& x) { return Array3{x[0] + by * x[0] * (2 - x[0]) / 4, x[1] + by * x[1] * (1 - x[1]), x[2]}; };
  return {lower, upper};
}

// Both beams in 2k x k x k bricks.
std::vector<int> bricksOf(const Mesh& mesh, int k) {
  std::vector<int> bricks;
  for (const auto& block : mesh.blocks)
    for (std::size_t e = 0; e < block.numElements(); ++e) {
      Array3 middle{0, 0, 0};
      for (std::size_t i = 0; i < 8; ++i)
        for (std::size_t c = 0; c < 3; ++c) middle[c] += mesh.coordinates[std::size_t(block.connectivity[8 * e + i])][c] / 8;
      const auto layer = [k](double x) { return int(std::floor(k * x + 1e-9)); };
      const bool upper = middle[2] > 0;
      bricks.push_back(2 * k * k * k * upper + layer(middle[0]) + 2 * k * layer(middle[1]) + 2 * k * k * layer(middle[2] + !upper));
    }
  return bricks;
}

std::vector<int> emptyOrBricks(const Mesh& mesh, const Beams& beams) {
  return beams.method == "Bricks" ? bricksOf(mesh, beams.bricks) : std::vector<int>{};
}

// Multiplications that two beams on each other take, cut by METIS, in bricks or as given.
long multiplications(const Beams& beams, const std::vector<int>& cut, Teuchos::FancyOStream& out, bool& success) {
  const Friction friction{"Coulomb", {0.3, 0.3}};
  const Mesh boxes = makeBoxes(beamBoxes(beams));
  ScenarioBuilder scene(beams.topology == Topology::Hex8 ? boxes : withElements(boxes, beams.topology), cut);
  scene.material("lower", 1e5, 0.3).material("upper", 1e5 * beams.contrast, 0.3).clamp({"clamp"})
      .pressure({"top", "bottom"}, "100*min(1, max(0, 1.5 - x))").traction({"end"}, {10, 10, 10})
      .contact("upper_contact", "lower_contact", &friction)
      .contactOption("Discretization", "Automatic").decomposition(cut.empty() ? "METIS" : "Bricks", cut.empty() ? beams.subdomains : 0);
  const auto result = scene.solve();
  TEST_ASSERT(result.solved);
  out << beams.lower << " : " << beams.upper << " shift " << beams.shift << " contrast " << beams.contrast << " " << beams.method << ", "
      << result.report.model.subdomains << " subdomains: " << result.report.solver.hessianMultiplications << " multiplications, "
      << result.report.model.discretization << ", " << result.report.model.contactPairs << " pairs, stick "
      << result.report.interfaces[0].stick << " slip " << result.report.interfaces[0].slip << " open " << result.report.interfaces[0].open
      << "\n";
  return result.report.solver.hessianMultiplications;
}

long multiplications(const Beams& beams, Teuchos::FancyOStream& out, bool& success) {
  return multiplications(beams, emptyOrBricks(makeBoxes(beamBoxes(beams)), beams), out, success);
}

Partition cutByMetis(const Mesh& mesh, int subdomains) {
  const Teuchos::SerialComm<int> alone;
  const OwnElements own = wholeMesh(mesh);
  const DualGraph graph = buildDualGraph(alone, own);
  PartitionOptions options;
  options.subdomains = subdomains;
  return partitionMesh(alone, own, graph, findBodies(alone, own, graph), options);
}

// Subdomains that METIS' cut gives each of two bodies.
std::array<int, 2> partsOfBodies(const Beams& beams) {
  std::array<int, 2> parts{0, 0};
  for (int body : cutByMetis(makeBoxes(beamBoxes(beams)), beams.subdomains).bodyOfSubdomain) ++parts[std::size_t(body)];
  return parts;
}

// Each beam cut by METIS in so many parts.
std::vector<int> cutInto(const Beams& beams, const std::array<int, 2>& parts) {
  const auto boxes = beamBoxes(beams);
  std::vector<int> cut = cutByMetis(makeBoxes({boxes[0]}), parts[0]).ofElement;
  for (int part : cutByMetis(makeBoxes({boxes[1]}), parts[1]).ofElement) cut.push_back(parts[0] + part);
  return cut;
}

constexpr double kContrasts[] = {1, 1e3, 1e-3};

// 3:2, 1:2 and 2:1 beside n:n, with about as many elements.
std::vector<Beams> unlike(int n) {
  if (n == 10) return {{10, 10, 0.5}, {8, 12}, {6, 12}, {12, 6}};
  return {{8, 8, 0.5}, {6, 9}, {5, 10}, {10, 5}};
}

void compare(long matching, Beams beams, const Beams& as, Teuchos::FancyOStream& out, bool& success) {
  beams.contrast = as.contrast;
  beams.method = as.method;
  beams.subdomains = as.subdomains;
  TEST_COMPARE(double(multiplications(beams, out, success)), <=, 1.3 * double(matching));
}

TEUCHOS_UNIT_TEST(MortarCounts, at_most_1_3_times_those_of_matching_meshes_in_bricks) {
  for (const double contrast : kContrasts) {
    const Beams as{8, 8, 0, contrast, "Bricks"};
    const long matching = multiplications(as, out, success);
    for (const Beams& beams : unlike(8)) compare(matching, beams, as, out, success);
  }
}

TEUCHOS_UNIT_TEST(MortarCounts, at_most_1_3_times_those_of_matching_meshes_in_as_many_subdomains_as_chosen) {
  for (const double contrast : kContrasts) {
    const Beams as{10, 10, 0, contrast, "METIS", 0};
    const long matching = multiplications(as, out, success);
    for (const Beams& beams : unlike(10)) compare(matching, beams, as, out, success);
  }
}

void compareIn(int subdomains, Teuchos::FancyOStream& out, bool& success) {
  for (const double contrast : kContrasts) {
    const Beams as{8, 8, 0, contrast, "METIS", subdomains};
    const long matching = multiplications(as, out, success);
    for (const Beams& beams : unlike(8)) compare(matching, beams, as, out, success);
  }
}

TEUCHOS_UNIT_TEST(MortarCounts, at_most_1_3_times_those_of_matching_meshes_in_few_and_many_parts) {
  for (const int subdomains : {8, 128}) compareIn(subdomains, out, success);
}

TEUCHOS_UNIT_TEST(MoreMortarCounts, at_most_1_3_times_those_of_matching_meshes_in_parts_between) {
  for (const int subdomains : {16, 64}) compareIn(subdomains, out, success);
}

// In 32 parts, bodies get as many as they have elements for.  METIS cuts each beam of the matching mesh into 16 cubes, which take 16 to 19
// multiplications; 15 or 17 parts take 3 more, 4 and 28 up to 7 more, on the matching mesh as well.  Meshes are compared here, not cuts: the
// matching mesh is cut into as many parts a body.
TEUCHOS_UNIT_TEST(MortarCounts, at_most_1_3_times_those_of_matching_meshes_in_as_many_parts_a_body) {
  for (const double contrast : kContrasts)
    for (const Beams& beams : unlike(8)) {
      const Beams as{8, 8, 0, contrast, "METIS", 32};
      const auto cut = cutInto(as, partsOfBodies(beams));
      out << partsOfBodies(beams)[0] << " + " << partsOfBodies(beams)[1] << " parts\n";
      compare(multiplications(as, cut, out, success), beams, as, out, success);
    }
}

// The same mesh in 16 times as many parts, and meshes that grow with the bricks.
TEUCHOS_UNIT_TEST(MortarCounts, do_not_grow_with_the_number_of_subdomains) {
  const auto metis = [&](int subdomains) { return double(multiplications({8, 12, 0, 1, "METIS", subdomains}, out, success)); };
  const double few = metis(8);
  for (const int subdomains : {16, 32, 64, 128}) TEST_COMPARE(metis(subdomains), <=, 1.2 * few);
  const auto bricks = [&](int k) { return double(multiplications({2 * k, 3 * k, 0, 1, "Bricks", 0, k}, out, success)); };
  const double small = bricks(2);
  for (const int k : {3, 4}) TEST_COMPARE(bricks(k), <=, 1.2 * small);
}

// Walls of parts are smooth among tetrahedra, too: with teeth these took 41, 43, 51 and 37 multiplications.
TEUCHOS_UNIT_TEST(MortarCounts, of_quadratic_tetrahedra_do_not_grow_either) {
  const auto metis = [&](int subdomains) {
    return double(multiplications({5, 7, 0, 1, "METIS", subdomains, 0, Topology::Tet10}, out, success));
  };
  for (const int subdomains : {16, 32, 64, 128}) TEST_COMPARE(metis(subdomains), <=, 36);
}

}  // namespace
