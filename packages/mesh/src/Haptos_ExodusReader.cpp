// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ExodusReader.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <Teuchos_DefaultSerialComm.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <new>
#include <set>

#include "Haptos_Error.hpp"
#include "Haptos_ExodusFields.hpp"
#include "Haptos_ExodusHandle.hpp"
#include "Haptos_ExodusPart.hpp"
#include "Haptos_NetcdfFile.hpp"
#include "Haptos_SetMembers.hpp"

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

/// \return below 0 if that fails; why is found out by other means, as the library guesses.
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

/// \brief A stretch of one of several arrays that are counted one after the other.
struct Stretch {
  std::size_t array;
  Index first, count;  ///< in the array
};

/// \param starts [arrays + 1] of the arrays in the common count
std::vector<Stretch> stretchesBetween(const std::vector<Index>& starts, Index begin, Index end) {
  std::vector<Stretch> stretches;
  for (std::size_t a = 0; a + 1 < starts.size(); ++a) {
    const Index from = std::clamp(begin, starts[a], starts[a + 1]), to = std::clamp(end, starts[a], starts[a + 1]);
    if (from < to) stretches.push_back({a, from - starts[a], to - from});
  }
  return stretches;
}

/// \brief Reads one rank's share of one file, part by part; each part is checked before the next relies on it.
///
/// No method communicates but `read`.
class Reader {
 public:
  /// \param fields names of nodal fields that are wanted
  Reader(const Communicator& comm, const std::string& path, const std::vector<std::string>& fields)
      : comm_(comm), path_(path), fields_(fields) {
    share_.rank = comm.getRank();
  }

  /// Collective.
  /// \param mayBePart whether it may be one file of a decomposed mesh
  MeshShare read(bool mayBePart) {
    runOnAllRanks(comm_, [&] {
      requireWholeNetcdfFile(path_);
      if (isHdf5(path_) && !survivesInChild([&] { Reader(comm_, path_, fields_).readAlone(); }, trialLimits()))
        refuse("reading it ends in a fault of the HDF5 library; the file is damaged.");
      open();
      if (!mayBePart && numParts() > 1)
        refuse("it is one of the " + std::to_string(numParts()) +
               " files of a decomposed mesh; name the mesh without the two numbers at the end, and all of them are read.");
      readSizes();
    });
    runOnAllRanks(comm_, [&] { readNumberMaps(); });
    runOnAllRanks(comm_, [&] { readCoordinates(); });
    runOnAllRanks(comm_, [&] { readNodalFields(); });
    runOnAllRanks(comm_, [&] { readBlocks(); });
    std::vector<SetMember> nodes, sides;
    runOnAllRanks(comm_, [&] { nodes = readNodeSets(); });
    dealSetNodes(comm_, nodes, share_);
    runOnAllRanks(comm_, [&] { sides = readSideSets(); });
    dealSides(comm_, sides, share_);
    return std::move(share_);
  }

  /// What a part of a decomposed mesh says of the whole, after `read`.
  ExodusPart readPart() {
    ExodusPart part;
    part.mesh = read(true).part;
    part.numParts = numParts();
    Index blocks = 0, nodeSets = 0, sideSets = 0;
    if (ex_get_init_global(file_->id(), &part.numNodes, &part.numElements, &blocks, &nodeSets, &sideSets) < 0)
      part.numNodes = part.numElements = -1;
    int nodeMaps = 0, elementMaps = 0;
    require(ex_get_map_param(file_->id(), &nodeMaps, &elementMaps), "the number of maps");
    part.originalNodes = readOriginalNumbers(EX_NODE_MAP, nodeMaps, sizes_.num_nodes);
    part.originalElements = readOriginalNumbers(EX_ELEM_MAP, elementMaps, sizes_.num_elem);
    return part;
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

  // Where a group is a member of itself, the library goes round until it has neither time nor memory.
  TrialLimits trialLimits() const { return {20 + unsigned(1e-7 * fileBytes()), 1e8 + 3000 * fileBytes()}; }
  double fileBytes() const { return double(std::filesystem::file_size(path_)); }

  /// All that `read` takes from the file, without the other ranks.
  void readAlone() {
    open();
    readSizes();
    readNumberMaps();
    readCoordinates();
    readNodalFields();
    readBlocks();
    readNodeSets();
    readSideSets();
  }

  void open() {
    file_ = std::make_unique<ExodusHandle>(openForReading(path_));
    if (!file_->isOpen())
      refuse("it cannot be opened as an Exodus II file: it is cut short, damaged, or another kind of netCDF file.");
    // A box of 80^3 equal bricks, as well deflated as can be, has 3.4 nodes and elements a byte; HDF5 may state what was never written.
    largestCount_ = 50.0 * fileBytes();
  }

  int numParts() const {
    int parts = 0, here = 0;
    std::array<char, 8> kind{};
    return ex_get_init_info(file_->id(), &parts, &here, kind.data()) < 0 || here >= parts ? 1 : parts;
  }

  /// The map of that name, under which the decomposers keep them.
  std::vector<Index> readOriginalNumbers(ex_entity_type type, Index numMaps, Index size) const {
    const auto ids = readIds(type, numMaps, "number map");
    const auto names = readNames(type, numMaps, "number map");
    const auto found = std::find(names.begin(), names.end(), "original_global_id_map");
    if (found == names.end()) return {};
    std::vector<Index> numbers(std::size_t(size), 0);
    require(ex_get_num_map(file_->id(), type, ids[std::size_t(found - names.begin())], numbers.data()), *found);
    return numbers;
  }

  // Counts are checked against the size of the file before memory is asked for.
  void readSizes() {
    require(ex_get_init_ext(file_->id(), &sizes_), "the sizes of the mesh");
    sizes_.title[MAX_LINE_LENGTH] = '\0';
    share_.part.title = sizes_.title;
    share_.part.wideIntegers = (ex_int64_status(file_->id()) & EX_ALL_INT64_DB) != 0;
    if (sizes_.num_dim != 3)
      refuse("the mesh has " + std::to_string(sizes_.num_dim) +
             " dimensions; a three-dimensional one is wanted.");
    checkedCount(sizes_.num_nodes, "nodes");
    checkedCount(sizes_.num_elem, "elements");
    checkedCount(sizes_.num_elem_blk, "element blocks");
    checkedCount(sizes_.num_node_sets, "node sets");
    checkedCount(sizes_.num_side_sets, "side sets");
    if (sizes_.num_nodes == 0 || sizes_.num_elem == 0)
      refuse("the mesh has " + std::to_string(sizes_.num_nodes) + " nodes and " + std::to_string(sizes_.num_elem) + " elements.");
    share_.nodes = {sizes_.num_nodes, comm_.getSize()};
    share_.elements = {sizes_.num_elem, comm_.getSize()};
  }

  void readNumberMaps() {
    share_.part.nodeNumbers = readNumbers(EX_NODE_MAP, share_.nodes, "the node number map");
    share_.part.elementNumbers = readNumbers(EX_ELEM_MAP, share_.elements, "the element number map");
  }

  std::vector<Index> readNumbers(ex_entity_type type, const EvenRanges& ranges, const char* what) const {
    const Index n = ranges.count(share_.rank);
    std::vector<Index> numbers(std::size_t(n), 0);
    if (n > 0)
      require(ex_get_partial_id_map(file_->id(), type, ranges.begin(share_.rank) + 1, n, numbers.data()), what);
    return numbers;
  }

  void readCoordinates() {
    const auto n = std::size_t(share_.nodes.count(share_.rank));
    if (n == 0) return;
    std::array<std::vector<double>, 3> x;
    for (auto& component : x) component.resize(n);
    require(ex_get_partial_coord(file_->id(), share_.firstNode() + 1, Index(n), x[0].data(), x[1].data(), x[2].data()),
            "the coordinates of the nodes");
    share_.part.coordinates.resize(n);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        if (!std::isfinite(x[c][i]))
          refuse("node " + std::to_string(share_.part.nodeNumbers[i]) + " has the " + "xyz"[c] + " coordinate " +
                 std::to_string(x[c][i]) + "; coordinates must be finite.");
        share_.part.coordinates[i][c] = x[c][i];
      }
  }

  void readNodalFields() {
    const auto nodes = ExodusNodes{share_.firstNode(), share_.endNode() - share_.firstNode(), sizes_.num_nodes};
    if (!fields_.empty()) share_.part.nodalFields = Haptos::readNodalFields(file_->id(), path_, nodes, fields_);
  }

  /// Numbers of all blocks or sets of one kind; they must differ, since the library looks entities up by
  /// them.
  std::vector<Index> readIds(ex_entity_type type, Index count, const std::string& kind) const {
    std::vector<Index> ids(std::size_t(count), 0);
    if (count > 0) require(ex_get_ids(file_->id(), type, ids.data()), "the numbers of the " + kind + "s");
    std::set<Index> seen;
    for (const Index id : ids) {
      if (id < 0) refuse("a " + kind + " has the number " + std::to_string(id) + "; numbers are at least 0.");
      if (!seen.insert(id).second)
        refuse("the number " + std::to_string(id) + " is given to more than one " + kind + ".");
    }
    return ids;
  }

  std::vector<std::string> readNames(ex_entity_type type, Index count, const std::string& kind) const {
    std::vector<std::string> names;
    require(readTexts(file_->id(), count, [&](char** texts) { return ex_get_names(file_->id(), type, texts); }, names),
            "the names of the " + kind + "s");
    return names;
  }

  // All ranks know all blocks; each reads its stretch of the connectivity.
  void readBlocks() {
    const auto ids = readIds(EX_ELEM_BLOCK, sizes_.num_elem_blk, "element block");
    const auto names = readNames(EX_ELEM_BLOCK, sizes_.num_elem_blk, "element block");
    auto& blocks = share_.part.blocks;
    share_.blockStarts = {0};
    for (std::size_t b = 0; b < ids.size(); ++b) {
      blocks.push_back({ids[b], names[b], Topology::Hex8, {}});
      share_.blockStarts.push_back(share_.blockStarts.back() + readBlockSize(blocks.back()));
    }
    if (share_.blockStarts.back() != sizes_.num_elem)
      refuse("it states " + std::to_string(sizes_.num_elem) + " elements, but its element blocks hold " +
             std::to_string(share_.blockStarts.back()) + "; the file is damaged.");
    for (const auto& s : stretchesBetween(share_.blockStarts, share_.firstElement(), share_.endElement())) {
      const std::string what = "element block " + quoted(ids[s.array], names[s.array]);
      auto& block = blocks[s.array];
      block.connectivity.resize(std::size_t(s.count * nodesPerElement(block.topology)));
      require(ex_get_partial_conn(file_->id(), EX_ELEM_BLOCK, ids[s.array], s.first + 1, s.count, block.connectivity.data(), nullptr, nullptr),
              "the connectivity of " + what);
      makeZeroBased(block.connectivity, what);
    }
  }

  /// Sets the topology.
  Index readBlockSize(ElementBlock& block) const {
    const std::string what = "element block " + quoted(block.id, block.name);
    // The library copies the name of the type whole, however long it is and without its end, over what follows it in memory: zeros.
    const std::unique_ptr<void, decltype(&std::free)> room(std::calloc(sizeof(ex_block) + std::size_t(fileBytes()), 1), &std::free);
    if (!room) throw std::bad_alloc();
    auto& info = *new (room.get()) ex_block{};
    info.id = block.id;
    info.type = EX_ELEM_BLOCK;
    require(ex_get_block_param(file_->id(), &info), what);
    if (info.topology[MAX_STR_LENGTH] != '\0')
      refuse("the elements of block " + std::to_string(block.id) + " are of a type with a name of more than 32 characters.");
    if (info.num_entry == 0) return 0;  // "NULL", or any type without elements

    int topology = 0;
    while (topology < kNumTopologies && !isNameOf(Topology(topology), info.topology, int(info.num_nodes_per_entry))) ++topology;
    if (topology == kNumTopologies)
      refuse(what + " has elements of type '" + info.topology + "' with " +
             std::to_string(info.num_nodes_per_entry) + " nodes; those that can be read are " + listTopologies() + ".");
    block.topology = Topology(topology);
    return Index(checkedCount(info.num_entry, "elements in " + what));
  }

  /// Exodus counts from 1; what lies outside would be read beyond arrays.
  void makeZeroBased(std::vector<Index>& nodes, const std::string& owner) const {
    for (auto& node : nodes) {
      if (node < 1 || node > sizes_.num_nodes)
        refuse(owner + " refers to node " + std::to_string(node) + ", but the nodes go from 1 to " +
               std::to_string(sizes_.num_nodes) + "; the file is damaged or cut short.");
      --node;
    }
  }

  /// Ids, names and sizes of all sets of a kind.  \return this rank's stretches of their members, which it shall read.
  template <class Set>
  std::vector<Stretch> readSets(ex_entity_type type, Index count, const std::string& kind, std::vector<Set>& sets,
                                std::vector<Index>& sizes) const {
    const auto ids = readIds(type, count, kind);
    const auto names = readNames(type, count, kind);
    std::vector<Index> starts{0};
    for (std::size_t s = 0; s < ids.size(); ++s) {
      const std::string what = kind + " " + quoted(ids[s], names[s]);
      Index entries = 0, factors = 0;
      require(ex_get_set_param(file_->id(), type, ids[s], &entries, &factors), what);
      sizes.push_back(Index(checkedCount(entries, "entries in " + what)));
      sets.push_back({ids[s], names[s], {}});
      starts.push_back(starts.back() + sizes.back());
    }
    const EvenRanges members{starts.back(), comm_.getSize()};
    return stretchesBetween(starts, members.begin(share_.rank), members.begin(share_.rank + 1));
  }

  // Every rank reads an even part of all members, wherever their nodes lie; they travel to the owners afterwards.
  std::vector<SetMember> readNodeSets() {
    std::vector<SetMember> members;
    auto& sets = share_.part.nodeSets;
    for (const auto& s : readSets(EX_NODE_SET, sizes_.num_node_sets, "node set", sets, share_.nodeSetSizes)) {
      const std::string what = "node set " + quoted(sets[s.array].id, sets[s.array].name);
      std::vector<Index> nodes(std::size_t(s.count), 0);
      require(ex_get_partial_node_set(file_->id(), sets[s.array].id, s.first + 1, s.count, nodes.data()), what);
      makeZeroBased(nodes, what);
      for (std::size_t i = 0; i < nodes.size(); ++i) members.push_back({s.first + Index(i), nodes[i], int(s.array), 0});
    }
    return members;
  }

  std::vector<SetMember> readSideSets() {
    std::vector<SetMember> members;
    auto& sets = share_.part.sideSets;
    for (const auto& s : readSets(EX_SIDE_SET, sizes_.num_side_sets, "side set", sets, share_.sideSetSizes)) {
      const std::string what = "side set " + quoted(sets[s.array].id, sets[s.array].name);
      std::vector<Index> elements(std::size_t(s.count), 0), sides(elements);
      require(ex_get_partial_side_set(file_->id(), sets[s.array].id, s.first + 1, s.count, elements.data(), sides.data()), what);
      for (std::size_t i = 0; i < elements.size(); ++i) {
        const ElementSide side = checkedSide(elements[i], sides[i], what);
        members.push_back({s.first + Index(i), side.element, int(s.array), side.side});
      }
    }
    return members;
  }

  /// 0-based; refused where there is no such element or side.
  ElementSide checkedSide(Index element, Index side, const std::string& what) const {
    if (element < 1 || element > sizes_.num_elem)
      refuse(what + " refers to element " + std::to_string(element) + ", but the elements go from 1 to " + std::to_string(sizes_.num_elem) + ".");
    const auto topology = share_.part.blocks[std::size_t(locateElement(share_.blockStarts, element - 1).block)].topology;
    if (side < 1 || side > sidesPerElement(topology))
      refuse(what + " refers to side " + std::to_string(side) + " of element " + std::to_string(element) + ", but the sides of a " +
             topologyName(topology) + " go from 1 to " + std::to_string(sidesPerElement(topology)) + ".");
    return {element - 1, int(side - 1)};
  }

  const Communicator& comm_;
  std::string path_;
  std::vector<std::string> fields_;
  std::unique_ptr<ExodusHandle> file_;
  double largestCount_ = 0.0;
  ex_init_params sizes_{};
  MeshShare share_;
};

}  // namespace

MeshShare readExodusShare(const Communicator& comm, const std::string& path, const std::vector<std::string>& fields) {
  return Reader(comm, path, fields).read(false);
}

Mesh readExodus(const std::string& path) { return readExodusShare(Teuchos::SerialComm<int>(), path).part; }

ExodusPart readExodusPart(const std::string& path, const std::vector<std::string>& fields) {
  const Teuchos::SerialComm<int> alone;
  return Reader(alone, path, fields).readPart();
}

}  // namespace Haptos
