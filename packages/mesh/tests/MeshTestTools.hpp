// SPDX-License-Identifier: BSD-3-Clause
// What several test programs of this package share.
#pragma once
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "Haptos_Mesh.hpp"

namespace HaptosTest {

/// \brief An empty folder of its own, removed at the end.
class TestFolder {
 public:
  TestFolder() {
    auto name = (std::filesystem::temp_directory_path() / "haptos_mesh_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder for test files");
    path_ = name;
  }
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
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

}  // namespace HaptosTest
