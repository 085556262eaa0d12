// SPDX-License-Identifier: BSD-3-Clause
// What several test programs of this package share.
#pragma once
#include <unistd.h>

#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultComm.hpp>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_MeshShare.hpp"

namespace HaptosTest {

inline const Haptos::Communicator& world() { return *Teuchos::DefaultComm<int>::getComm(); }

/// \brief Runs on rank 0; the others wait for it, before and after.
template <class Work>
void onRoot(const Work& work) {
  world().barrier();
  if (world().getRank() == 0) work();
  world().barrier();
}

/// \brief An empty folder of all ranks, removed at the end.
class TestFolder {
 public:
  TestFolder() {
    auto name = (std::filesystem::temp_directory_path() / "haptos_mesh_XXXXXX").string();
    if (world().getRank() == 0 && mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder for test files");
    Teuchos::broadcast(world(), 0, int(name.size()), name.data());
    path_ = name;
  }
  ~TestFolder() {
    onRoot([&] {
      std::error_code ignored;
      std::filesystem::remove_all(path_, ignored);
    });
  }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::vector<std::string> entries() const {
    std::vector<std::string> names;
    for (const auto& e : std::filesystem::directory_iterator(path_))
      names.push_back(e.path().filename().string());
    return names;
  }

 private:
  std::filesystem::path path_;
};

using Vector3 = std::array<double, 3>;

inline Vector3 minus(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline Vector3 centre(const Haptos::Mesh& mesh, const std::vector<std::int64_t>& nodes) {
  Vector3 c{0, 0, 0};
  for (const auto n : nodes)
    for (std::size_t d = 0; d < 3; ++d) c[d] += mesh.coordinates[std::size_t(n)][d] / double(nodes.size());
  return c;
}

inline std::vector<std::int64_t> nodesOfElement(const Haptos::Mesh& mesh, std::int64_t element) {
  const auto where = Haptos::locateElement(Haptos::blockOffsets(mesh), element);
  const auto& block = mesh.blocks[std::size_t(where.block)];
  const auto first = block.connectivity.begin() + where.position * Haptos::nodesPerElement(block.topology);
  return {first, first + Haptos::nodesPerElement(block.topology)};
}

/// \brief Area vector of a side by the right-hand rule on its nodes (a quadrilateral by its diagonals).
inline Vector3 areaVector(const Haptos::Mesh& mesh, const std::vector<std::int64_t>& side) {
  const auto at = [&](std::size_t i) { return mesh.coordinates[std::size_t(side[i])]; };
  const Vector3 twice = side.size() == 4 ? cross(minus(at(2), at(0)), minus(at(3), at(1)))
                                         : cross(minus(at(1), at(0)), minus(at(2), at(0)));
  return {twice[0] / 2, twice[1] / 2, twice[2] / 2};
}

inline const std::string longName = "a_block_name_of_sixty_characters_that_exceeds_thirty_two_xyz";

/// \brief Boxes of hexahedra and of tetrahedra, with a side set over both.
inline std::vector<Haptos::BoxSpec> mixedBoxes() {
  Haptos::BoxSpec hex, tet;
  hex.blockName = longName;
  hex.blockId = 17;
  hex.divisions = {2, 3, 1};
  hex.sideSetNames = {"", longName + "_side", "", "both", "", ""};
  tet.blockName = "tet";
  tet.blockId = 4;
  tet.lower = {3, 0, 0};
  tet.upper = {4, 1, 1};
  tet.topology = Haptos::Topology::Tet4;
  tet.divisions = {1, 2, 2};
  tet.sideSetNames = {"both", "", "", "", "", "top"};
  return {hex, tet};
}

/// \brief HEX8 and TET4 blocks, an empty block between them, sets with and without names, number maps.
inline Haptos::Mesh makeRichMesh() {
  Haptos::Mesh mesh = Haptos::makeBoxes(mixedBoxes());
  mesh.blocks.insert(mesh.blocks.begin() + 1, Haptos::ElementBlock{9, "empty", Haptos::Topology::Hex8, {}});
  mesh.title = "rich";
  mesh.sideSets[0].id = 100;
  mesh.sideSets[1].id = 12;
  mesh.sideSets[1].name = "";
  mesh.sideSets.push_back({33, "hollow", {}});
  mesh.nodeSets = {{55, longName + "_node", {0, 5, 3}}, {2, "", {7}}, {6, "hollow", {}}};
  for (auto& number : mesh.nodeNumbers) number = 10 * number + 1;
  for (auto& number : mesh.elementNumbers) number = 1000 - number;
  return mesh;
}

/// \brief The same with numbers that do not fit into 32 bits.
inline Haptos::Mesh makeWideMesh() {
  Haptos::Mesh mesh = makeRichMesh();
  mesh.blocks[0].id = (std::int64_t(1) << 31) + 5;
  mesh.sideSets[0].id = (std::int64_t(1) << 40) + 1;
  mesh.nodeSets[0].id = (std::int64_t(1) << 33);
  mesh.nodeNumbers.back() = (std::int64_t(1) << 35) + 3;
  mesh.elementNumbers.back() = (std::int64_t(1) << 36);
  mesh.wideIntegers = true;
  return mesh;
}

/// \brief In what two shares differ, in a word; empty if they are the same.
inline std::string difference(const Haptos::MeshShare& a, const Haptos::MeshShare& b) {
  const Haptos::Mesh &p = a.part, &q = b.part;
  if (a.rank != b.rank || a.nodes.size != b.nodes.size || a.nodes.ranks != b.nodes.ranks) return "nodes";
  if (a.elements.size != b.elements.size || a.elements.ranks != b.elements.ranks) return "elements";
  if (p.title != q.title || p.wideIntegers != q.wideIntegers) return "header";
  if (p.coordinates != q.coordinates || p.nodeNumbers != q.nodeNumbers) return "coordinates or node numbers";
  if (p.elementNumbers != q.elementNumbers) return "element numbers";
  if (a.blockStarts != b.blockStarts || listBlocks(p) != listBlocks(q)) return "blocks";
  for (std::size_t i = 0; i < p.blocks.size(); ++i)
    if (p.blocks[i].topology != q.blocks[i].topology || p.blocks[i].connectivity != q.blocks[i].connectivity)
      return "block " + p.blocks[i].name;
  if (a.sideSetSizes != b.sideSetSizes || listSideSets(p) != listSideSets(q)) return "side sets";
  if (a.nodeSetSizes != b.nodeSetSizes || listNodeSets(p) != listNodeSets(q)) return "node sets";
  if (a.sidePositions != b.sidePositions) return "positions in side sets";
  if (a.nodePositions != b.nodePositions) return "positions in node sets";
  for (std::size_t i = 0; i < p.nodeSets.size(); ++i)
    if (p.nodeSets[i].nodes != q.nodeSets[i].nodes) return "node set " + p.nodeSets[i].name;
  if (listNodalFields(p) != listNodalFields(q)) return "nodal fields";
  for (std::size_t i = 0; i < p.nodalFields.size(); ++i)
    if (p.nodalFields[i].values != q.nodalFields[i].values) return "nodal field " + p.nodalFields[i].name;
  const auto same = [](const Haptos::ElementSide& s, const Haptos::ElementSide& t) { return s.element == t.element && s.side == t.side; };
  for (std::size_t i = 0; i < p.sideSets.size(); ++i) {
    const auto &s = p.sideSets[i].sides, &t = q.sideSets[i].sides;
    if (!std::equal(s.begin(), s.end(), t.begin(), t.end(), same)) return "side set " + p.sideSets[i].name;
  }
  return "";
}

}  // namespace HaptosTest
