// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ExodusReader.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <set>

#include "Haptos_Error.hpp"
#include "Haptos_ExodusHandle.hpp"
#include "Haptos_NetcdfFile.hpp"

namespace Haptos {
namespace {

using Index = std::int64_t;

/// \brief Keeps stderr quiet during its life: `ex_open` prints (and guesses wrongly) whatever `ex_opts` says.
class QuietStderr {
 public:
  QuietStderr() : saved_(dup(STDERR_FILENO)) {
    std::fflush(stderr);
    const int nowhere = ::open("/dev/null", O_WRONLY);
    if (saved_ >= 0 && nowhere >= 0) dup2(nowhere, STDERR_FILENO);
    if (nowhere >= 0) ::close(nowhere);
  }
  ~QuietStderr() {
    std::fflush(stderr);
    if (saved_ < 0) return;
    dup2(saved_, STDERR_FILENO);
    ::close(saved_);
  }
  QuietStderr(const QuietStderr&) = delete;
  QuietStderr& operator=(const QuietStderr&) = delete;

 private:
  int saved_;
};

int openForReading(const std::string& path) {
  const QuietStderr quiet;
  ex_opts(0);  // nor shall later calls print
  int wordSize = 8, fileWordSize = 0;
  float version = 0;
  return ex_open(path.c_str(), EX_READ | EX_ALL_INT64_API, &wordSize, &fileWordSize, &version);
}

std::string quoted(Index id, const std::string& name) {
  return std::to_string(id) + (name.empty() ? "" : " ('" + name + "')");
}

/// \brief "hex8" -> {"HEX", "8"}
std::pair<std::string, std::string> splitTypeName(std::string type) {
  std::transform(type.begin(), type.end(), type.begin(),
                 [](unsigned char c) { return char(std::toupper(c)); });
  type.erase(type.find_last_not_of(' ') + 1);
  const auto digits = type.find_last_not_of("0123456789") + 1;
  return {type.substr(0, digits), type.substr(digits)};
}

bool isHex8(const std::string& type, Index nodes) {
  const auto [family, digits] = splitTypeName(type);
  return (family == "HEX" || family == "HEXAHEDRON") && (digits.empty() || digits == "8") && nodes == 8;
}

bool isTet4(const std::string& type, Index nodes) {
  const auto [family, digits] = splitTypeName(type);
  return (family == "TET" || family == "TETRA" || family == "TETRAHEDRON") &&
         (digits.empty() || digits == "4") && nodes == 4;
}

/// \brief Reads one file part by part; each part is checked before the next relies on it.
class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path), file_(openForReading(path)) {
    if (!file_.isOpen())
      refuse(
          "it cannot be opened as an Exodus II file: it is cut short, damaged, or another kind of netCDF "
          "file.");
    // The largest compression of the formats is about a thousandfold.
    largestCount_ = 1000.0 * double(std::filesystem::file_size(path));
  }

  Mesh read() {
    readSizes();
    readNumberMaps();
    readCoordinates();
    readBlocks();
    readNodeSets();
    readSideSets();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError("Mesh file '" + path_ + "': " + what);
  }
  /// Negative values are failures, positive ones warnings.
  void require(int status, const std::string& what) const {
    if (status < 0) refuse("cannot read " + what + "; the file is damaged.");
  }
  std::size_t checkedCount(Index count, const std::string& what) const {
    if (count < 0 || double(count) > largestCount_)
      refuse("it states " + std::to_string(count) + " " + what + ", which a file of its size cannot hold.");
    return std::size_t(count);
  }

  void readSizes() {
    require(ex_get_init_ext(file_.id(), &sizes_), "the sizes of the mesh");
    sizes_.title[MAX_LINE_LENGTH] = '\0';
    mesh_.title = sizes_.title;
    mesh_.wideIntegers = (ex_int64_status(file_.id()) & EX_ALL_INT64_DB) != 0;
    if (sizes_.num_dim != 3)
      refuse("the mesh has " + std::to_string(sizes_.num_dim) +
             " dimensions; a three-dimensional one is wanted.");
    checkedCount(sizes_.num_nodes, "nodes");
    checkedCount(sizes_.num_elem, "elements");
    checkedCount(sizes_.num_elem_blk, "element blocks");
    checkedCount(sizes_.num_node_sets, "node sets");
    checkedCount(sizes_.num_side_sets, "side sets");
    if (sizes_.num_nodes == 0 || sizes_.num_elem == 0)
      refuse("the mesh has " + std::to_string(sizes_.num_nodes) + " nodes and " +
             std::to_string(sizes_.num_elem) + " elements.");
  }

  void readNumberMaps() {
    mesh_.nodeNumbers.resize(std::size_t(sizes_.num_nodes));
    mesh_.elementNumbers.resize(std::size_t(sizes_.num_elem));
    require(ex_get_id_map(file_.id(), EX_NODE_MAP, mesh_.nodeNumbers.data()), "the node number map");
    require(ex_get_id_map(file_.id(), EX_ELEM_MAP, mesh_.elementNumbers.data()), "the element number map");
  }

  void readCoordinates() {
    const auto n = std::size_t(sizes_.num_nodes);
    std::array<std::vector<double>, 3> x;
    for (auto& component : x) component.resize(n);
    require(ex_get_partial_coord(file_.id(), 1, sizes_.num_nodes, x[0].data(), x[1].data(), x[2].data()),
            "the coordinates of the nodes");
    mesh_.coordinates.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        if (!std::isfinite(x[c][i]))
          refuse("node " + std::to_string(mesh_.nodeNumbers[i]) + " has the " + "xyz"[c] + " coordinate " +
                 std::to_string(x[c][i]) + "; coordinates must be finite.");
        mesh_.coordinates[i][c] = x[c][i];
      }
  }

  /// Numbers of all blocks or sets of one kind; they must differ, since the library looks entities up by
  /// them.
  std::vector<Index> readIds(ex_entity_type type, Index count, const std::string& kind) const {
    std::vector<Index> ids(std::size_t(count), 0);
    if (count > 0) require(ex_get_ids(file_.id(), type, ids.data()), "the numbers of the " + kind + "s");
    std::set<Index> seen;
    for (const Index id : ids)
      if (!seen.insert(id).second)
        refuse("the number " + std::to_string(id) + " is given to more than one " + kind + ".");
    return ids;
  }

  std::vector<std::string> readNames(ex_entity_type type, Index count, const std::string& kind) const {
    std::vector<std::string> names(std::size_t(count), std::string{});
    if (count == 0) return names;
    // Names longer than the library's default of 32 characters come whole only when asked for.
    const auto stored = ex_inquire_int(file_.id(), EX_INQ_DB_MAX_ALLOWED_NAME_LENGTH);
    const int length = int(std::clamp<Index>(stored, MAX_STR_LENGTH, 4096));
    ex_set_max_name_length(file_.id(), length);
    std::vector<std::vector<char>> buffers(names.size(), std::vector<char>(std::size_t(length) + 2, '\0'));
    std::vector<char*> pointers;
    for (auto& buffer : buffers) pointers.push_back(buffer.data());
    require(ex_get_names(file_.id(), type, pointers.data()), "the names of the " + kind + "s");
    for (std::size_t i = 0; i < names.size(); ++i) {
      names[i] = pointers[i];
      names[i].erase(names[i].find_last_not_of(' ') + 1);
    }
    return names;
  }

  void readBlocks() {
    const auto ids = readIds(EX_ELEM_BLOCK, sizes_.num_elem_blk, "element block");
    const auto names = readNames(EX_ELEM_BLOCK, sizes_.num_elem_blk, "element block");
    for (std::size_t b = 0; b < ids.size(); ++b) mesh_.blocks.push_back(readBlock(ids[b], names[b]));
    if (Index(mesh_.numElements()) != sizes_.num_elem)
      refuse("it states " + std::to_string(sizes_.num_elem) + " elements, but its element blocks hold " +
             std::to_string(mesh_.numElements()) + "; the file is damaged.");
  }

  ElementBlock readBlock(Index id, const std::string& name) const {
    const std::string what = "element block " + quoted(id, name);
    ex_block info{};
    info.id = id;
    info.type = EX_ELEM_BLOCK;
    require(ex_get_block_param(file_.id(), &info), what);
    ElementBlock block{id, name, Topology::Hex8, {}};
    if (info.num_entry == 0) return block;  // "NULL", or any type without elements

    info.topology[MAX_STR_LENGTH] = '\0';
    if (isTet4(info.topology, info.num_nodes_per_entry))
      block.topology = Topology::Tet4;
    else if (!isHex8(info.topology, info.num_nodes_per_entry))
      refuse(what + " has elements of type '" + info.topology + "' with " +
             std::to_string(info.num_nodes_per_entry) + " nodes; only HEX8 and TET4 are supported.");
    const auto n = checkedCount(info.num_entry, "elements in " + what);
    block.connectivity.resize(n * std::size_t(info.num_nodes_per_entry));
    require(ex_get_partial_conn(file_.id(), EX_ELEM_BLOCK, id, 1, info.num_entry, block.connectivity.data(),
                                nullptr, nullptr),
            "the connectivity of " + what);
    makeZeroBased(block.connectivity, what);
    return block;
  }

  void makeZeroBased(std::vector<Index>& nodes, const std::string& owner) const {
    for (auto& node : nodes) {
      if (node < 1 || node > sizes_.num_nodes)
        refuse(owner + " refers to node " + std::to_string(node) + ", but the nodes go from 1 to " +
               std::to_string(sizes_.num_nodes) + "; the file is damaged or cut short.");
      --node;
    }
  }

  std::size_t readSetSize(ex_entity_type type, Index id, const std::string& what) const {
    Index entries = 0, factors = 0;
    require(ex_get_set_param(file_.id(), type, id, &entries, &factors), what);
    return checkedCount(entries, "entries in " + what);
  }

  void readNodeSets() {
    const auto ids = readIds(EX_NODE_SET, sizes_.num_node_sets, "node set");
    const auto names = readNames(EX_NODE_SET, sizes_.num_node_sets, "node set");
    for (std::size_t s = 0; s < ids.size(); ++s) {
      const std::string what = "node set " + quoted(ids[s], names[s]);
      NodeSet set{ids[s], names[s], std::vector<Index>(readSetSize(EX_NODE_SET, ids[s], what))};
      if (!set.nodes.empty())
        require(ex_get_set(file_.id(), EX_NODE_SET, ids[s], set.nodes.data(), nullptr), what);
      makeZeroBased(set.nodes, what);
      mesh_.nodeSets.push_back(std::move(set));
    }
  }

  void readSideSets() {
    const auto ids = readIds(EX_SIDE_SET, sizes_.num_side_sets, "side set");
    const auto names = readNames(EX_SIDE_SET, sizes_.num_side_sets, "side set");
    const auto offsets = blockOffsets(mesh_);
    for (std::size_t s = 0; s < ids.size(); ++s) {
      const std::string what = "side set " + quoted(ids[s], names[s]);
      const auto n = readSetSize(EX_SIDE_SET, ids[s], what);
      std::vector<Index> elements(n), sides(n);
      if (n > 0) require(ex_get_set(file_.id(), EX_SIDE_SET, ids[s], elements.data(), sides.data()), what);
      SideSet set{ids[s], names[s], {}};
      for (std::size_t i = 0; i < n; ++i)
        set.sides.push_back(checkedSide(offsets, elements[i], sides[i], what));
      mesh_.sideSets.push_back(std::move(set));
    }
  }

  ElementSide checkedSide(const std::vector<Index>& offsets, Index element, Index side,
                          const std::string& what) const {
    if (element < 1 || element > sizes_.num_elem)
      refuse(what + " refers to element " + std::to_string(element) + ", but the elements go from 1 to " +
             std::to_string(sizes_.num_elem) + ".");
    const auto topology = mesh_.blocks[std::size_t(locateElement(offsets, element - 1).block)].topology;
    if (side < 1 || side > sidesPerElement(topology))
      refuse(what + " refers to side " + std::to_string(side) + " of element " + std::to_string(element) +
             ", but the sides of a " + topologyName(topology) + " go from 1 to " +
             std::to_string(sidesPerElement(topology)) + ".");
    return {element - 1, int(side - 1)};
  }

  std::string path_;
  ExodusHandle file_;
  double largestCount_ = 0.0;
  ex_init_params sizes_{};
  Mesh mesh_;
};

}  // namespace

Mesh readExodus(const std::string& path) {
  requireWholeNetcdfFile(path);
  return Reader(path).read();
}

}  // namespace Haptos
