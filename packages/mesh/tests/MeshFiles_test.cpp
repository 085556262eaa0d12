// SPDX-License-Identifier: BSD-3-Clause
// Meshes in several files: the same shares as of the whole file, or one message on all ranks.
#include "Haptos_MeshFiles.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <fstream>
#include <functional>
#include <tuple>

#include "FileSetTools.hpp"
#include "Haptos_BoxMesh.hpp"
#include "Haptos_CellMesh.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_ExodusReader.hpp"
#include "MeshTestTools.hpp"

using namespace Haptos;
using namespace HaptosTest;

namespace {

/// Every element somewhere else than its neighbours.
std::vector<int> scattered(const Mesh& mesh, int parts) {
  std::vector<int> part(mesh.numElements());
  for (std::size_t e = 0; e < part.size(); ++e) part[e] = int((7 * e + 1) % std::size_t(parts));
  return part;
}

/// Sets in the order in which those of a decomposed mesh come.
Mesh withSortedSets(Mesh mesh) {
  for (auto& set : mesh.nodeSets) std::sort(set.nodes.begin(), set.nodes.end());
  for (auto& set : mesh.sideSets)
    std::sort(set.sides.begin(), set.sides.end(), [](const ElementSide& a, const ElementSide& b) {
      return std::tie(a.element, a.side) < std::tie(b.element, b.side);
    });
  return mesh;
}

Mesh twoBeams() {
  Mesh mesh = makeTwoBeams({1, 3});
  mesh.nodeSets = {{4, "some", {5, 9, 33}}, {6, "none", {}}};
  return mesh;
}

/// What a spoilt decomposition of the two beams into three files is refused with; the same on all ranks.
std::string refusal(const TestFolder& folder, const FileSetOptions& options, const std::function<void(const std::string&)>& after = {}) {
  const auto path = folder.file("m.exo");
  onRoot([&] {
    const Mesh mesh = twoBeams();
    writeFileSet(path, mesh, scattered(mesh, 3), 3, options);
    if (after) after(path);
  });
  std::string message;
  try {
    readMeshFiles(world(), path);
  } catch (const InputError& e) {
    message = e.what();
  }
  for (const auto& other : gatherOnAll(world(), Bytes(message.begin(), message.end())))
    if (std::string(other.begin(), other.end()) != message) return "RANKS DIFFER";
  return message;
}

bool has(const std::string& message, const std::vector<std::string>& texts, Teuchos::FancyOStream& out) {
  out << message << "\n";
  return std::all_of(texts.begin(), texts.end(), [&](const auto& text) { return message.find(text) != std::string::npos; });
}

}  // namespace

TEUCHOS_UNIT_TEST(MeshFiles, FileSetIsReadAsTheWholeFile) {
  const int rank = world().getRank(), ranks = world().getSize();
  for (const Mesh& mesh : {makeRichMesh(), makeWideMesh(), twoBeams(), withElements(makeTwoBeams({1, 2}), Topology::Hex27)})
    for (const int parts : {1, 2, 3, 5, 12}) {
      const TestFolder folder;
      const auto path = folder.file("m.exo");
      onRoot([&] { writeFileSet(path, mesh, scattered(mesh, parts), parts); });
      TEST_EQUALITY(int(listMeshFiles(path).size()), parts);
      TEST_EQUALITY(difference(readMeshFiles(world(), path), sliceOfMesh(withSortedSets(mesh), rank, ranks)), "");
    }
}

TEUCHOS_UNIT_TEST(MeshFiles, NodalFieldsOfAFileSet) {
  const TestFolder folder;
  Mesh mesh = twoBeams();
  mesh.nodalFields = {{"MU", {}}, {"MV", {}}};
  for (std::size_t i = 0; i < mesh.numNodes(); ++i) {
    mesh.nodalFields[0].values.push_back(0.01 * double(i));
    mesh.nodalFields[1].values.push_back(-1.0);
  }
  const auto path = folder.file("m.exo");
  onRoot([&] { writeFileSet(path, mesh, scattered(mesh, 5), 5); });
  Mesh wanted = withSortedSets(mesh);
  wanted.nodalFields[1].values.clear();
  TEST_EQUALITY(difference(readMeshFiles(world(), path, {"MU"}), sliceOfMesh(wanted, world().getRank(), world().getSize())), "");
}

TEUCHOS_UNIT_TEST(MeshFiles, NumbersNeedNotCountFromOne) {
  const TestFolder folder;
  Mesh mesh = twoBeams();
  for (auto& number : mesh.nodeNumbers) number = 10 * number + (std::int64_t(1) << 20);
  for (auto& number : mesh.elementNumbers) number = 3 * number;
  FileSetOptions options;
  options.keepOriginalNumbers = false;
  options.change = [&](int, Mesh& part) {
    for (auto& number : part.nodeNumbers) number = mesh.nodeNumbers[std::size_t(number - 1)];
    for (auto& number : part.elementNumbers) number = mesh.elementNumbers[std::size_t(number - 1)];
  };
  onRoot([&] { writeFileSet(folder.file("m.exo"), mesh, scattered(mesh, 4), 4, options); });
  TEST_EQUALITY(difference(readMeshFiles(world(), folder.file("m.exo")), sliceOfMesh(mesh, world().getRank(), world().getSize())), "");
}

TEUCHOS_UNIT_TEST(MeshFiles, WholeFileGoesFirst) {
  const TestFolder folder;
  const Mesh mesh = makeRichMesh();
  const auto path = folder.file("m.exo");
  onRoot([&] {
    writeFileSet(path, twoBeams(), scattered(twoBeams(), 2), 2);
    writeMesh(path, mesh);
  });
  TEST_EQUALITY(difference(readMeshFiles(world(), path), sliceOfMesh(mesh, world().getRank(), world().getSize())), "");
}

TEUCHOS_UNIT_TEST(MeshFiles, AFileOfASetIsNoMesh) {
  const TestFolder folder;
  const auto path = folder.file("m.exo");
  onRoot([&] { writeFileSet(path, twoBeams(), scattered(twoBeams(), 2), 2); });
  try {
    readExodusShare(world(), partName(path, 1, 2));
    TEST_ASSERT(false);
  } catch (const InputError& e) {
    TEST_ASSERT(has(e.what(), {"m.exo.2.1'", "one of the 2 files of a decomposed mesh"}, out));
  }
}

TEUCHOS_UNIT_TEST(MeshFiles, IncompleteSetsAreRefused) {
  const auto remove = [](const std::string& file) { std::filesystem::remove(file); };
  TEST_EQUALITY(refusal(TestFolder(), {}), "");
  TEST_ASSERT(has(refusal(TestFolder(), {}, [&](auto& path) { remove(partName(path, 1, 3)); }), {"m.exo'", "file 1 of 3 is missing"}, out));
  TEST_ASSERT(has(refusal(TestFolder(), {}, [&](auto& path) {
                    for (int i : {0, 1, 2}) remove(partName(path, i, 3));
                  }), {"m.exo'", "there is no such file"}, out));
  TEST_ASSERT(has(refusal(TestFolder(), {}, [&](auto& path) { writeMesh(partName(path, 0, 8), twoBeams()); }),
                  {"m.exo'", "into 3 and into 8 files"}, out));
  TEST_ASSERT(has(refusal(TestFolder(), {}, [&](auto& path) { std::ofstream(partName(path, 2, 3)) << "no mesh"; }),
                  {"m.exo.3.2'", "not an Exodus II file"}, out));
  TEST_ASSERT(has(refusal(TestFolder(), {}, [&](auto& path) {  // a part of four renamed as one of three
                    writeFileSet(path, twoBeams(), scattered(twoBeams(), 4), 4);
                    std::filesystem::rename(partName(path, 1, 4), partName(path, 1, 3));
                    for (int i : {0, 2, 3}) remove(partName(path, i, 4));
                  }), {"m.exo.3.1'", "in 4 files", "in 3"}, out));
}

TEUCHOS_UNIT_TEST(MeshFiles, PartsThatDoNotBelongTogetherAreRefused) {
  const auto spoilt = [&](const std::function<void(Mesh&)>& change) {
    FileSetOptions options;
    options.change = [&](int part, Mesh& mesh) { if (part == 1) change(mesh); };
    return refusal(TestFolder(), options);
  };
  TEST_ASSERT(has(spoilt([](Mesh& m) { m.blocks[1].name = "another"; }), {"do not belong together", "another (2)", "upper (2)"}, out));
  TEST_ASSERT(has(spoilt([](Mesh& m) { m.nodeSets.pop_back(); }), {"do not belong together", "none (6)"}, out));
  TEST_ASSERT(has(spoilt([](Mesh& m) { for (auto& x : m.coordinates) x[1] += 1e-9; }), {"lies at different places in two of its files"}, out));
  TEST_ASSERT(has(spoilt([](Mesh& m) { m.elementNumbers[0] = 5; }), {"element 5 is in two of its files"}, out));
  TEST_ASSERT(has(spoilt([](Mesh& m) { m.nodeNumbers[0] = 0; }), {"node with the number 0"}, out));
  TEST_ASSERT(has(spoilt([](Mesh& m) { m.nodeNumbers[0] = 4000; }), {"hold 225 nodes, but state 224"}, out));
  TEST_ASSERT(has(spoilt([](Mesh& m) { m.blocks[0].connectivity[2] = 999; }), {"m.exo.3.1'", "element block 1 ('lower') refers to node 1000"}, out));
  TEST_ASSERT(has(spoilt([](Mesh& m) {  // hexahedra in one file, tetrahedra in another
                    auto& block = m.blocks[0];
                    const auto n = block.numElements();
                    block.topology = Topology::Tet4;
                    block.connectivity.resize(4 * n);
                    for (auto& set : m.sideSets) set.sides.clear();
                  }), {"element block 1 is of HEX8 in one and of TETRA4 in another"}, out));
  FileSetOptions options;
  options.statedElements = 107;
  TEST_ASSERT(has(refusal(TestFolder(), options), {"hold 108 elements, but state 107"}, out));
}
