// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Mesh.hpp"

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <sstream>

#include "Haptos_Error.hpp"

namespace Haptos {
namespace {

// A name first, then a number: a block may be called "2".
template <class Entity>
int findEntity(const std::vector<Entity>& all, const std::string& nameOrNumber, const char* kind) {
  if (nameOrNumber.empty()) return -1;
  const auto bearsName = [&](const Entity& e) { return e.name == nameOrNumber; };
  const auto found = std::find_if(all.begin(), all.end(), bearsName);
  if (found == all.end()) {
    const auto bearsNumber = [&](const Entity& e) { return std::to_string(e.id) == nameOrNumber; };
    const auto numbered = std::find_if(all.begin(), all.end(), bearsNumber);
    return numbered == all.end() ? -1 : int(numbered - all.begin());
  }
  const auto second = std::find_if(found + 1, all.end(), bearsName);
  if (second != all.end())
    throw InputError("The name '" + nameOrNumber + "' is borne by more than one " + kind + " (numbers " +
                     std::to_string(found->id) + " and " + std::to_string(second->id) +
                     "); name it by its number instead.");
  return int(found - all.begin());
}

// For messages: what the user could have meant.
template <class Entity>
std::string listEntities(const std::vector<Entity>& all) {
  std::string text;
  for (const auto& e : all) {
    if (!text.empty()) text += ", ";
    text += e.name.empty() ? std::to_string(e.id) : e.name + " (" + std::to_string(e.id) + ")";
  }
  return text.empty() ? "none" : text;
}

}  // namespace

std::size_t Mesh::numElements() const {
  std::size_t count = 0;
  for (const auto& block : blocks) count += block.numElements();
  return count;
}

std::vector<std::int64_t> blockOffsets(const Mesh& mesh) {
  std::vector<std::int64_t> offsets(1, 0);
  for (const auto& block : mesh.blocks) offsets.push_back(offsets.back() + std::int64_t(block.numElements()));
  return offsets;
}

ElementLocation locateElement(const std::vector<std::int64_t>& offsets, std::int64_t element) {
  TEUCHOS_ASSERT(element >= 0 && element < offsets.back());
  // The last offset <= element; of empty blocks, which share an offset, the last one is not empty.
  const auto next = std::upper_bound(offsets.begin(), offsets.end(), element);
  const auto block = next - offsets.begin() - 1;
  return {int(block), element - offsets[std::size_t(block)]};
}

std::vector<std::int64_t> nodesOfSide(const Mesh& mesh, const std::vector<std::int64_t>& offsets,
                                      ElementSide side) {
  const auto where = locateElement(offsets, side.element);
  const auto& block = mesh.blocks[std::size_t(where.block)];
  const auto first = where.position * nodesPerElement(block.topology);
  std::vector<std::int64_t> nodes;
  for (const int position : sideNodes(block.topology, side.side)) nodes.push_back(block.connectivity[std::size_t(first + position)]);
  return nodes;
}

int findBlock(const Mesh& mesh, const std::string& nameOrNumber) {
  return findEntity(mesh.blocks, nameOrNumber, "element block");
}
int findSideSet(const Mesh& mesh, const std::string& nameOrNumber) {
  return findEntity(mesh.sideSets, nameOrNumber, "side set");
}
int findNodeSet(const Mesh& mesh, const std::string& nameOrNumber) {
  return findEntity(mesh.nodeSets, nameOrNumber, "node set");
}

std::string listBlocks(const Mesh& mesh) { return listEntities(mesh.blocks); }
std::string listSideSets(const Mesh& mesh) { return listEntities(mesh.sideSets); }
std::string listNodeSets(const Mesh& mesh) { return listEntities(mesh.nodeSets); }

int findNodalField(const Mesh& mesh, const std::string& name) {
  const auto found = std::find_if(mesh.nodalFields.begin(), mesh.nodalFields.end(), [&](const NodalField& f) { return f.name == name; });
  return found == mesh.nodalFields.end() ? -1 : int(found - mesh.nodalFields.begin());
}

std::string listNodalFields(const Mesh& mesh) {
  std::string list;
  for (const auto& field : mesh.nodalFields) list += (list.empty() ? "" : ", ") + field.name;
  return list.empty() ? "none" : list;
}

// By its number in the file, and its place where numbers say nothing.
std::string describeNode(const Mesh& mesh, std::int64_t node) {
  const auto& x = mesh.coordinates[std::size_t(node)];
  std::ostringstream text;
  text << "node " << (mesh.nodeNumbers.empty() ? node + 1 : mesh.nodeNumbers[std::size_t(node)]) << " ("
       << x[0] << ", " << x[1] << ", " << x[2] << ")";
  return text.str();
}

}  // namespace Haptos
