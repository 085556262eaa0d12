// SPDX-License-Identifier: BSD-3-Clause
// Decomposed meshes as SEACAS' nem_spread writes them.
#pragma once
#include <exodusII.h>

#include <algorithm>
#include <functional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "Haptos_ExodusWriter.hpp"
#include "Haptos_Mesh.hpp"

namespace HaptosTest {

/// \brief What a test may spoil in one part before it is written, and what the file states of the whole.
struct FileSetOptions {
  bool keepOriginalNumbers = true;  ///< in maps of their own; the number maps count from 1 in any case
  std::function<void(int part, Haptos::Mesh&)> change;
  std::int64_t statedNodes = -1, statedElements = -1;  ///< -1: what is right
};

inline std::string partName(const std::string& path, int part, int parts) {
  const std::string count = std::to_string(parts), number = std::to_string(part);
  return path + "." + count + "." + std::string(count.size() - number.size(), '0') + number;
}

/// \brief Elements of one part with their nodes, in descending order, to be hard; numbers are index + 1 in the whole mesh.
inline Haptos::Mesh extractPart(const Haptos::Mesh& whole, const std::vector<int>& partOfElement, int part,
                                std::vector<std::int64_t>& nodes, std::vector<std::int64_t>& elements) {
  Haptos::Mesh mesh;
  mesh.title = part == 0 ? whole.title : "Parallel Mesh File for Processor " + std::to_string(part);
  mesh.wideIntegers = whole.wideIntegers;
  std::set<std::int64_t, std::greater<>> used;
  const auto offsets = Haptos::blockOffsets(whole);
  std::vector<std::int64_t> localElement(partOfElement.size(), -1);
  for (std::size_t b = 0; b < whole.blocks.size(); ++b) {
    const auto& block = whole.blocks[b];
    mesh.blocks.push_back({block.id, block.name, block.topology, {}});
    const auto n = Haptos::nodesPerElement(block.topology);
    for (std::int64_t e = offsets[b]; e < offsets[b + 1]; ++e) {
      if (partOfElement[std::size_t(e)] != part) continue;
      localElement[std::size_t(e)] = std::int64_t(elements.size());
      elements.push_back(e);
      for (int i = 0; i < n; ++i) mesh.blocks[b].connectivity.push_back(block.connectivity[std::size_t((e - offsets[b]) * n + i)]);
    }
    used.insert(mesh.blocks[b].connectivity.begin(), mesh.blocks[b].connectivity.end());
  }
  nodes.assign(used.begin(), used.end());
  const auto localNode = [&](std::int64_t node) {
    return std::lower_bound(nodes.begin(), nodes.end(), node, std::greater<>()) - nodes.begin();
  };
  for (auto& block : mesh.blocks)
    for (auto& node : block.connectivity) node = localNode(node);
  for (const auto node : nodes) {
    mesh.coordinates.push_back(whole.coordinates[std::size_t(node)]);
    mesh.nodeNumbers.push_back(node + 1);
  }
  for (const auto e : elements) mesh.elementNumbers.push_back(e + 1);
  for (const auto& set : whole.nodeSets) {
    mesh.nodeSets.push_back({set.id, set.name, {}});
    for (const auto node : set.nodes)
      if (used.count(node)) mesh.nodeSets.back().nodes.push_back(localNode(node));
  }
  for (const auto& set : whole.sideSets) {
    mesh.sideSets.push_back({set.id, set.name, {}});
    for (const auto& side : set.sides)
      if (const auto e = localElement[std::size_t(side.element)]; e >= 0) mesh.sideSets.back().sides.push_back({e, side.side});
  }
  return mesh;
}

/// \brief Adds what makes an Exodus file a part: the sizes of the whole and the numbers of the mesh before it was cut.
inline void markAsPart(const std::string& file, int parts, const Haptos::Mesh& whole, const std::vector<std::int64_t>& nodes,
                       const std::vector<std::int64_t>& elements, const FileSetOptions& options) {
  int wordSize = 8, fileWordSize = 0;
  float version = 0;
  const int id = ex_open(file.c_str(), EX_WRITE | EX_ALL_INT64_API, &wordSize, &fileWordSize, &version);
  const auto require = [&](int status) {
    if (status < 0) throw std::runtime_error("cannot make '" + file + "' a part");
  };
  require(id);
  char kind[] = "p";
  require(ex_put_init_info(id, parts, 1, kind));
  require(ex_put_init_global(id, options.statedNodes < 0 ? std::int64_t(whole.numNodes()) : options.statedNodes,
                             options.statedElements < 0 ? std::int64_t(whole.numElements()) : options.statedElements,
                             std::int64_t(whole.blocks.size()), std::int64_t(whole.nodeSets.size()),
                             std::int64_t(whole.sideSets.size())));
  if (options.keepOriginalNumbers) {
    std::vector<std::int64_t> nodeNumbers, elementNumbers;
    for (const auto n : nodes) nodeNumbers.push_back(whole.nodeNumbers[std::size_t(n)]);
    for (const auto e : elements) elementNumbers.push_back(whole.elementNumbers[std::size_t(e)]);
    require(ex_put_map_param(id, 1, 1));
    require(ex_put_num_map(id, EX_NODE_MAP, 1, nodeNumbers.data()));
    require(ex_put_num_map(id, EX_ELEM_MAP, 1, elementNumbers.data()));
    require(ex_put_name(id, EX_NODE_MAP, 1, "original_global_id_map"));
    require(ex_put_name(id, EX_ELEM_MAP, 1, "original_global_id_map"));
  }
  const int numFields = int(whole.nodalFields.size());
  if (numFields > 0) require(ex_put_variable_param(id, EX_NODAL, numFields));
  const double time = 1;
  if (numFields > 0) require(ex_put_time(id, 1, &time));
  for (int f = 0; f < numFields; ++f) {
    const auto& field = whole.nodalFields[std::size_t(f)];
    std::vector<double> values;
    for (const auto n : nodes) values.push_back(field.values[std::size_t(n)]);
    require(ex_put_variable_name(id, EX_NODAL, f + 1, field.name.c_str()));
    require(ex_put_var(id, 1, EX_NODAL, f + 1, 1, std::int64_t(values.size()), values.data()));
  }
  require(ex_close(id));
}

/// \brief Writes a mesh as path.N.0 .. path.N.(N - 1).  Serial.
inline void writeFileSet(const std::string& path, const Haptos::Mesh& whole, const std::vector<int>& partOfElement, int parts,
                         const FileSetOptions& options = {}) {
  for (int part = 0; part < parts; ++part) {
    std::vector<std::int64_t> nodes, elements;
    Haptos::Mesh mesh = extractPart(whole, partOfElement, part, nodes, elements);
    if (options.change) options.change(part, mesh);
    const auto file = partName(path, part, parts);
    Haptos::writeMesh(file, mesh);
    markAsPart(file, parts, whole, nodes, elements, options);
  }
}

}  // namespace HaptosTest
