// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_FieldOutput.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <cstdlib>
#include <filesystem>

#include "../../feti/tests/FetiScene.hpp"
#include "Haptos_RunReport.hpp"

namespace {

using namespace Haptos;
using namespace Haptos::Testing;

Scene scene() { return makeScene(heldScene(7)); }

}  // namespace

TEUCHOS_UNIT_TEST(NodalGather, MeanRangeAndSumOfCopies) {
  const Scene s = scene();
  const Dealt dealt = deal(Tpetra::getDefaultComm(), s);
  const auto comm = Tpetra::getDefaultComm();
  const NodalGather gather(comm, nodesOf(dealt.mine), std::int64_t(s.mesh.numNodes()));
  const auto offsets = s.offsets();
  const Eigen::VectorXd u = someVector(offsets.back());
  const auto v = scattered(dealt.jump->getDomainMap(), u);
  const auto copies = gather.copies(*v);
  const auto sum = gather.sum(*v);
  TEST_EQUALITY(std::int64_t(sum.size()), 3 * gather.nodes().count(comm->getRank()));
  const std::int64_t first = gather.firstNode(), end = first + std::int64_t(gather.numNodes());
  std::map<std::pair<std::int64_t, int>, std::vector<double>> values;
  for (const auto& sub : s.subdomains)
    for (int i = 0; i < 3 * sub.numNodes(); ++i) values[{sub.nodes[i / 3], i % 3}].push_back(u[offsets[sub.id] + i]);
  bool several = false;
  for (const auto& [key, list] : values) {
    if (key.first < first || key.first >= end) continue;  // another rank has this node
    const std::size_t at = 3 * std::size_t(key.first - first) + std::size_t(key.second);
    double total = 0;
    for (double x : list) total += x;
    several = several || list.size() > 2;
    TEST_ASSERT(std::abs(sum[at] - total) < 1e-14);
    TEST_ASSERT(std::abs(copies.mean[at] - total / double(list.size())) < 1e-14);
    TEST_EQUALITY(copies.lowest[at], *std::min_element(list.begin(), list.end()));
    TEST_EQUALITY(copies.highest[at], *std::max_element(list.begin(), list.end()));
  }
  TEST_ASSERT(several);

  // Any rank may ask for any nodes, and for one more than once.
  const std::int64_t last = std::int64_t(s.mesh.numNodes()) - 1;
  const std::vector<std::int64_t> wanted{last, comm->getRank(), last / 2, last};
  const auto fetched = gather.fetch(sum, wanted);
  TEST_EQUALITY(fetched.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) {
    double total = 0;
    for (double x : values[{wanted[i / 3], int(i % 3)}]) total += x;
    TEST_ASSERT(std::abs(fetched[i] - total) < 1e-14);
  }
  const auto whole = wholeOnRoot(*comm, sum);
  TEST_EQUALITY(whole.size(), comm->getRank() == 0 ? 3 * s.mesh.numNodes() : 0);
}

// ANALYTIC: a linear displacement gives the same stress in all elements of a material.
TEUCHOS_UNIT_TEST(ElementResults, UniformStrain) {
  const Scene s = scene();
  const Dealt dealt = deal(Tpetra::getDefaultComm(), s);
  const auto offsets = s.offsets();
  Eigen::VectorXd u(offsets.back());
  for (const auto& sub : s.subdomains)
    for (int i = 0; i < sub.numNodes(); ++i) u.segment<3>(offsets[sub.id] + 3 * i) << 1e-3 * sub.coordinates[i][0], 0, 0;
  const EvenRanges elements{std::int64_t(s.mesh.numElements()), Tpetra::getDefaultComm()->getSize()};
  const auto results = gatherElementResults(Tpetra::getDefaultComm().operator*(), dealt.mine, s.materials, dealt.jump->primalOffsets(),
                                            *scattered(dealt.jump->getDomainMap(), u), elements);
  const int rank = Tpetra::getDefaultComm()->getRank();
  TEST_EQUALITY(std::int64_t(results.stress.size()), elements.count(rank));
  const auto blockStart = blockOffsets(s.mesh);
  for (std::size_t i = 0; i < results.stress.size(); ++i) {
    const std::size_t e = i + std::size_t(elements.begin(rank));
    const ElasticModuli m = elasticModuli(s.materials[locateElement(blockStart, std::int64_t(e)).block]);
    TEST_FLOATING_EQUALITY(results.stress[i][0], 1e-3 * (m.lambda + 2 * m.shear), 1e-10);
    TEST_FLOATING_EQUALITY(results.stress[i][1], 1e-3 * m.lambda, 1e-10);
    TEST_FLOATING_EQUALITY(vonMises(results.stress[i]), 2e-3 * m.shear, 1e-10);
    TEST_EQUALITY(int(results.subdomain[i]), s.partition.ofElement[e]);
  }
}

TEUCHOS_UNIT_TEST(ResultFields, NamesAreThoseOfTheManual) {
  const auto comm = Tpetra::getDefaultComm();
  const int rank = comm->getRank(), ranks = comm->getSize();
  const EvenRanges nodes{3, ranks};
  std::vector<double> displacement{1, 2, 3, 4, 5, 6, 7, 8, 9};
  displacement = {displacement.begin() + 3 * nodes.begin(rank), displacement.begin() + 3 * nodes.begin(rank + 1)};
  PairResult pair{};
  pair.secondaryNode = 2;
  pair.secondary = {{2, 1.0}};
  pair.primary = {{0, 1.0}};
  pair.force = {0.1, 0.2, 5};
  pair.normalForce = 5;
  pair.gap = 0.25;
  pair.axis = {1, 0, 0};
  pair.status = ContactStatus::Stick;
  ElementResults elements;
  if (rank == 0) elements.stress = {{1, 2, 3, 4, 5, 6}}, elements.subdomain = {4};
  std::vector<PairResult> pairs;
  if (rank == ranks - 1) pairs = {pair};
  ResultFields fields = makeResultFields(*comm, nodes, {displacement, pairs, elements, 1e-7, 42});
  for (auto& [name, values] : fields.nodal) {
    TEST_EQUALITY(std::int64_t(values.size()), nodes.count(rank));
    values = wholeOnRoot(*comm, values);
  }

  std::vector<std::string> nodal, element, global;
  for (const auto& field : fields.nodal) nodal.push_back(field.first);
  for (const auto& field : fields.element) element.push_back(field.first);
  for (const auto& field : fields.global) global.push_back(field.first);
  const std::vector<std::string> nodalNames{
      "displacement_x", "displacement_y", "displacement_z", "contact_force_x", "contact_force_y", "contact_force_z",
      "contact_normal_force", "contact_pressure", "contact_gap", "contact_slip_x", "contact_slip_y", "contact_slip_z",
      "contact_status", "friction_axis_x", "friction_axis_y", "friction_axis_z", "friction_coefficient_1", "friction_coefficient_2"};
  const std::vector<std::string> elementNames{"stress_xx", "stress_yy", "stress_zz", "stress_xy", "stress_yz", "stress_zx", "von_mises", "subdomain"};
  TEST_ASSERT(nodal == nodalNames);
  TEST_ASSERT(element == elementNames);
  TEST_ASSERT((global == std::vector<std::string>{"kkt", "hessian_multiplications"}));

  if (rank != 0) return;
  const auto value = [&](const std::string& name, std::size_t i) {
    for (const auto& field : fields.nodal)
      if (field.first == name) return field.second.at(i);
    return -1.0;
  };
  TEST_EQUALITY(value("displacement_y", 1), 5.0);
  TEST_EQUALITY(value("contact_force_z", 2), 5.0);   // the force on the secondary node,
  TEST_EQUALITY(value("contact_force_z", 0), -5.0);  // its opposite on the primary one
  TEST_EQUALITY(value("contact_normal_force", 0), 5.0);
  TEST_EQUALITY(value("contact_status", 2), 3.0);
  TEST_EQUALITY(value("contact_status", 1), 0.0);
  TEST_EQUALITY(value("contact_gap", 2), 0.25);
  TEST_EQUALITY(value("friction_axis_x", 0), 1.0);
}

// Two pairs with lists: forces go by the weights, pressures are force by area of the pairs that use a node, or of its own pair.
// Node 4 is on the secondary side and has no multiplier; the weights of a quadratic face may be below 0.
TEUCHOS_UNIT_TEST(ResultFields, ListsShareForceAndPressure) {
  const auto comm = Tpetra::getDefaultComm();
  const EvenRanges nodes{6, comm->getSize()};
  std::vector<PairResult> pairs(2);
  pairs[0].secondaryNode = 3;
  pairs[0].secondary = {{3, 0.75}, {2, 0.35}, {4, -0.1}};
  pairs[0].primary = {{0, 0.4}, {1, 0.6}};
  pairs[1].secondaryNode = 2;
  pairs[1].secondary = {{2, 1.0}};
  pairs[1].primary = {{1, 1.25}, {5, -0.25}};
  const double force[] = {10, 6}, area[] = {2, 3};
  for (std::size_t i = 0; i < 2; ++i) {
    pairs[i].normalForce = force[i];
    pairs[i].area = area[i];
    pairs[i].force = {0, 0, -force[i]};
    pairs[i].slip = {double(i + 1), 0, 0};
    pairs[i].status = ContactStatus::Slip;
  }
  if (comm->getRank() != 0) pairs.clear();
  const std::vector<double> displacement(3 * std::size_t(nodes.count(comm->getRank())), 0.0);
  ResultFields fields = makeResultFields(*comm, nodes, {displacement, pairs, {}, 1e-7, 42});
  const auto check = [&](const std::string& name, const std::array<double, 6>& expected) {
    for (auto& field : fields.nodal) {
      if (field.first != name) continue;
      const auto values = wholeOnRoot(*comm, field.second);
      for (std::size_t i = 0; i < values.size(); ++i) TEST_ASSERT(std::abs(values[i] - expected[i]) < 1e-14);
    }
  };
  check("contact_force_z", {4, 13.5, -9.5, -7.5, 1, -1.5});
  check("contact_normal_force", {4, 13.5, 6, 10, 0, -1.5});  // a multiplier on its own node, as the pressure; 16 on either side
  check("contact_pressure", {5, 13.5 / 4.95, 2, 5, 5, 2});
  check("contact_slip_x", {1, 2, 2, 1, 1, 2});
}

// A node on the joint of two bodies, each of which has its share of its area: uniform pressure is uniform there, too.
TEUCHOS_UNIT_TEST(ResultFields, PressureOfTwoContactsIsForceByArea) {
  const auto comm = Tpetra::getDefaultComm();
  const EvenRanges nodes{3, comm->getSize()};
  std::vector<PairResult> pairs(2);
  for (int i = 0; i < 2; ++i) {
    pairs[std::size_t(i)].interface = i;
    pairs[std::size_t(i)].secondaryNode = 2;
    pairs[std::size_t(i)].secondary = {{2, 1.0}};
    pairs[std::size_t(i)].primary = {{i, 1.0}};
    pairs[std::size_t(i)].area = 0.25 + i;
    pairs[std::size_t(i)].normalForce = 10 * pairs[std::size_t(i)].area;
  }
  if (comm->getRank() != 0) pairs.clear();
  const std::vector<double> displacement(3 * std::size_t(nodes.count(comm->getRank())), 0.0);
  const ResultFields fields = makeResultFields(*comm, nodes, {displacement, pairs, {}, 1e-7, 42});
  for (const auto& field : fields.nodal)
    if (field.first == "contact_pressure")
      for (double pressure : wholeOnRoot(*comm, field.second)) TEST_FLOATING_EQUALITY(pressure, 10.0, 1e-14);
}

// A folder bears the name: it stays, and nothing lies beside it.
TEUCHOS_UNIT_TEST(RunReport, TextThatCannotBeWrittenLeavesNothing) {
  std::string name = (std::filesystem::temp_directory_path() / "haptos_report_XXXXXX").string();  // every rank has its own
  TEST_ASSERT(mkdtemp(name.data()) != nullptr);
  const std::filesystem::path summary = std::filesystem::path(name) / "summary.json";
  std::filesystem::create_directory(summary);
  TEST_THROW(writeTextFile(summary.string(), "text"), std::runtime_error);
  TEST_ASSERT(std::filesystem::is_directory(summary));
  TEST_ASSERT(!std::filesystem::exists(summary.string() + ".part"));
  std::filesystem::remove_all(name);
}
