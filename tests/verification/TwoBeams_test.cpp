// SPDX-License-Identifier: BSD-3-Clause
// The benchmark of two beams: sizes of all 20 cells, and the contact forces of two small cases.
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "ScenarioBuilder.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Verification;

ScenarioBuilder twoBeams(int k, int p, const std::array<double, 2>& coefficients) {
  const Friction friction{"Coulomb", coefficients};
  return ScenarioBuilder(TwoBeamsSpec{k, p})
      .material("lower", 6.9e4, 0.333)
      .material("upper", 2.119e5, 0.277)
      .clamp({"lower_clamp", "upper_clamp"})
      .contact("upper_contact", "lower_contact", &friction)
      .decomposition("Bricks");
}

struct Sizes {
  long n, nd, l;
};

// EXTERNAL: Table 3.1 of the paper, rows k = 1..5, columns p = 2..5.  Only its last n_d, 125047, cannot be: it
// breaks m + 3 m_c with the same decomposition; OWN: 125178.
constexpr Sizes table[5][4] = {
    {{324, 153, 24}, {768, 276, 24}, {1500, 435, 24}, {2592, 630, 24}},
    {{2592, 1527, 192}, {6144, 2889, 192}, {12000, 4683, 192}, {20736, 6909, 192}},
    {{8748, 5493, 648}, {20736, 10506, 648}, {40500, 17139, 648}, {69984, 25392, 648}},
    {{20736, 13419, 1536}, {49152, 25791, 1536}, {96000, 42195, 1536}, {165888, 62631, 1536}},
    {{40500, 26673, 3000}, {96000, 51408, 3000}, {187500, 84243, 3000}, {324000, 125178, 3000}}};

TEUCHOS_UNIT_TEST(TwoBeams, SizesOfTable31) {
  for (int k = 1; k <= 5; ++k)
    for (int p = 2; p <= 5; ++p) {
      const auto model = twoBeams(k, p, {0.3, 0.3}).pressure({"upper_top"}, 1.0).prepare();
      const Sizes& s = table[k - 1][p - 2];
      TEST_EQUALITY(model.primalUnknowns, s.n);
      TEST_EQUALITY(model.dualUnknowns, s.nd);
      TEST_EQUALITY(model.kernelDimension, s.l);
      TEST_EQUALITY(model.subdomains, 4 * k * k * k);
    }
}

struct Reference {
  double x, y;
  Array3 force;  // on the upper node
};

// Contact nodes with the forces that the reference found.
std::vector<Reference> readReference(const std::string& name) {
  std::ifstream file(std::string(HAPTOS_VERIFICATION_DATA) + "/" + name);
  std::vector<Reference> rows;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream numbers(line);
    Reference r;
    numbers >> r.x >> r.y >> r.force[2] >> r.force[0] >> r.force[1];
    rows.push_back(r);
  }
  return rows;
}

// Weight of a place on a face of length `length` cut into bricks of size H with p elements: h (1 inside, also where
// two bricks meet, 1/2 at the ends).
double lumped(double s, double length, double h) { return s < 0.5 * h || s > length - 0.5 * h ? 0.5 * h : h; }

// Squeeze load, lumped to the nodes of the faces.
Array3 squeeze(const Array3& x, double h) {
  Array3 force{0, 0, 0};
  const double onTop = lumped(x[0], 2, h) * lumped(x[1], 1, h), ramp = 100 * std::clamp(1.5 - x[0], 0.0, 1.0);
  if (x[2] > 1 - 0.5 * h) force[2] -= ramp * onTop;
  if (x[2] < -1 + 0.5 * h) force[2] += ramp * onTop;
  return force;
}

NodalForces benchmarkLoad(const Mesh& mesh, double h) {
  const auto& upper = mesh.blocks[1].connectivity;
  const std::int64_t firstUpper = *std::min_element(upper.begin(), upper.end());
  return [firstUpper, h](std::int64_t node, const Array3& x) {
    Array3 force = squeeze(x, h);
    if (node >= firstUpper && x[0] > 2 - 0.5 * h)  // the end of the upper beam: traction (10, 10, 10)
      for (double& f : force) f += 10 * lumped(x[1], 1, h) * lumped(x[2], 1, h);
    return force;
  };
}

// OWN: dense condensed semismooth Newton on the same discrete problem, checked by a conic solver.
void compare(const std::string& file, const std::array<double, 2>& coefficients, const std::string& method,
             Teuchos::FancyOStream& out, bool& success) {
  const int k = 2, p = 3;
  auto scene = twoBeams(k, p, coefficients);
  scene.nodalForces(benchmarkLoad(scene.mesh(), 1.0 / (k * p))).solver(method).tolerance(1e-9).maximumMultiplications(20000);
  const auto reference = readReference(file);
  TEST_EQUALITY(reference.size(), std::size_t(84));
  const auto result = scene.solve();
  TEST_ASSERT(result.solved);
  double largest = 0, error = 0;
  std::size_t found = 0;
  for (const auto& r : reference)
    for (double f : r.force) largest = std::max(largest, std::abs(f));
  for (const auto& pair : result.pairs)
    for (const auto& r : reference) {
      const auto& x = scene.mesh().coordinates[pair.secondaryNode];
      if (std::hypot(x[0] - r.x, x[1] - r.y) > 1e-9) continue;
      ++found;
      for (int d = 0; d < 3; ++d) error = std::max(error, std::abs(pair.force[d] - r.force[d]) / largest);
    }
  if (result.pairs.empty()) return;  // not the root
  TEST_EQUALITY(found, reference.size());
  TEST_COMPARE(error, <=, 1e-6);
  const auto& contact = result.report.interfaces.at(0);
  TEST_ASSERT(contact.stick > 0 && contact.slip > 0 && contact.open > 0);  // all states occur
  out << file << " by " << result.report.solver.method << ": error " << error << " of the largest force " << largest << "; "
      << contact.stick << " stick, " << contact.slip << " slip, " << contact.open << " open; kkt "
      << result.report.accuracy.errors.kkt() << " after " << result.report.solver.hessianMultiplications << " multiplications\n";
}

TEUCHOS_UNIT_TEST(TwoBeams, ContactForcesIsotropic) { compare("iso_k2p3.csv", {0.3, 0.3}, "Automatic", out, success); }
TEUCHOS_UNIT_TEST(TwoBeams, ContactForcesOrthotropicByNewton) {
  compare("ortho_k2p3.csv", {0.5, 0.05}, "Subspace Newton", out, success);
}
TEUCHOS_UNIT_TEST(TwoBeams, ContactForcesOrthotropicBySmalse) {
  compare("ortho_k2p3.csv", {0.5, 0.05}, "SMALSE", out, success);
}

}  // namespace
