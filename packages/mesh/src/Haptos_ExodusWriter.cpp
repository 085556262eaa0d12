// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ExodusWriter.hpp"

#include <Teuchos_Assert.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultSerialComm.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "Haptos_Error.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_ExodusHandle.hpp"
#include "Haptos_SetMembers.hpp"
#include "Haptos_TemporaryFile.hpp"

namespace Haptos {
namespace {

namespace fs = std::filesystem;
using Index = std::int64_t;

/// Numbers beyond 2^31 need the HDF5 format; others get the older one, which every reader takes.
template <class Entity>
bool anyIdIsWide(const std::vector<Entity>& all) {
  return std::any_of(all.begin(), all.end(),
                     [](const Entity& e) { return e.id > std::numeric_limits<int>::max(); });
}

bool needsWideIntegers(const Communicator& comm, const MeshShare& mesh) {
  const auto isWide = [](Index number) { return number > std::numeric_limits<int>::max(); };
  const Mesh& part = mesh.part;
  const int mine = part.wideIntegers || anyIdIsWide(part.blocks) || anyIdIsWide(part.sideSets) || anyIdIsWide(part.nodeSets) ||
                   isWide(mesh.nodes.size) || isWide(mesh.elements.size) ||
                   std::any_of(part.nodeNumbers.begin(), part.nodeNumbers.end(), isWide) ||
                   std::any_of(part.elementNumbers.begin(), part.elementNumbers.end(), isWide);
  int any = 0;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, mine, Teuchos::outArg(any));
  return any != 0;
}

/// \brief Longest name the file shall hold: at least 64, for the names of results, which come later.
std::size_t longestName(const Mesh& mesh) {
  std::size_t longest = 64;
  for (const auto& e : mesh.blocks) longest = std::max(longest, e.name.size());
  for (const auto& e : mesh.sideSets) longest = std::max(longest, e.name.size());
  for (const auto& e : mesh.nodeSets) longest = std::max(longest, e.name.size());
  return longest;
}

// 64-bit numbers in calls in any case, in the file where they are needed.
int createFile(const std::string& path, bool wideIntegers) {
  ex_opts(0);  // the library prints nothing by itself
  int wordSize = 8, fileWordSize = 8;
  const int kind = wideIntegers ? EX_NETCDF4 | EX_NOCLASSIC | EX_ALL_INT64_DB : EX_LARGE_MODEL;
  return ex_create(path.c_str(), EX_CLOBBER | EX_ALL_INT64_API | kind, &wordSize, &fileWordSize);
}

/// Exodus counts nodes, elements and sides from 1.
std::vector<Index> oneBased(const std::vector<Index>& indices) {
  auto shifted = indices;
  for (auto& index : shifted) ++index;
  return shifted;
}

template <class Field>
std::vector<std::string> namesOf(const std::vector<Field>& fields) {
  std::vector<std::string> names;
  for (const auto& field : fields) names.push_back(field.first);
  return names;
}

}  // namespace

/// The open file, on rank 0, and what of the mesh is needed to split the fields.
///
/// Ranks that only send cannot know whether rank 0 fails: it keeps its first error, goes on receiving, and tells it
/// in `agree`.
struct ExodusWriter::File {
  File(RCP<const Communicator> comm, const std::string& path, const MeshShare& mesh)
      : comm_(std::move(comm)), path_(path), numNodes_(std::size_t(mesh.nodes.count(mesh.rank))), longestName_(longestName(mesh.part)) {
    for (std::size_t b = 0; b < mesh.part.blocks.size(); ++b)
      blocks_.push_back({mesh.part.blocks[b].id, mesh.blockStarts[b + 1] - mesh.blockStarts[b],
                         std::size_t(mesh.firstElementOf(b) - mesh.firstElement()), std::size_t(mesh.numElementsOf(b))});
    numElements_ = std::size_t(mesh.elements.count(mesh.rank));
    const bool wide = needsWideIntegers(*comm_, mesh);
    onRoot([&] {
      requireWritableFolder(path, "result file");
      temporary_ = std::make_unique<TemporaryFile>(path);
      handle_ = std::make_unique<ExodusHandle>(temporary_->exists() ? createFile(temporary_->name(), wide) : -1);
      if (!handle_->isOpen()) fail("cannot be created");
    });
    agree();
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError("Result file '" + path_ + "' " + what + "; is there space left on the disk?");
  }
  void require(int status, const char* what) const {
    if (status < 0) fail(std::string("cannot be written (") + what + ")");
  }
  int id() const { return handle_->id(); }

  /// Runs `work` on rank 0 unless it failed before.
  template <class Work>
  void onRoot(const Work& work) {
    if (comm_->getRank() != 0 || error_.kind != 0) return;
    try {
      work();
    } catch (...) {
      error_ = describeCurrentException();
    }
  }
  /// Throws on all ranks what rank 0 has met.
  void agree() const { broadcastAndThrow(*comm_, error_, 0); }

  /// \brief Brings an array to rank 0 piece by piece, and has `put(first, count, values)` write each.
  ///
  /// All ranks' parts follow on each other; `first` (1-based) and `count` are of entities of `width` values.
  template <class T, class Put>
  void pass(const T* mine, std::size_t size, std::size_t width, const Put& put) {
    const std::size_t entity = width * sizeof(T);
    Index first = 1;
    passToRoot(*comm_, {reinterpret_cast<const char*>(mine), size * sizeof(T)}, std::max(kPieceBytes / entity, std::size_t(1)) * entity,
               [&](int, ByteView piece) {
                 const auto count = Index(piece.size / entity);
                 onRoot([&] { put(first, count, reinterpret_cast<const T*>(piece.data)); });
                 first += count;
               });
  }

  void writeMesh(const MeshShare& mesh);
  void writeNodes(const MeshShare& mesh);
  void writeNumbers(ex_entity_type type, const std::vector<Index>& numbers, const char* what);
  void writeBlocks(const MeshShare& mesh);
  void writeNodeSets(const MeshShare& mesh);
  void writeSideSets(const MeshShare& mesh);
  template <class Entity>
  void writeNames(ex_entity_type type, const std::vector<Entity>& all);

  void defineFields(const ResultFields& fields);
  void defineNames(ex_entity_type type, const std::vector<std::string>& names);
  void checkFields(const ResultFields& fields) const;
  void writeElementField(int index, const std::vector<double>& values);

  struct Block {
    Index id, size;
    std::size_t first, count;  ///< in this rank's part of an element field
  };
  RCP<const Communicator> comm_;
  std::string path_;
  std::unique_ptr<TemporaryFile> temporary_;  // before handle_: the file is closed first, then removed
  std::size_t numNodes_, numElements_ = 0, longestName_;
  std::vector<Block> blocks_;
  std::vector<std::string> nodal_, element_, global_;
  int step_ = 0;
  CaughtError error_;
  std::unique_ptr<ExodusHandle> handle_;
};

// Sizes first, since the library lays the file out by them; then what the ranks have, piece by piece in the order of entities.
void ExodusWriter::File::writeMesh(const MeshShare& mesh) {
  onRoot([&] {
    ex_init_params sizes{};
    mesh.part.title.copy(sizes.title, MAX_LINE_LENGTH);
    sizes.num_dim = 3;
    sizes.num_nodes = mesh.nodes.size;
    sizes.num_elem = mesh.elements.size;
    sizes.num_elem_blk = Index(mesh.part.blocks.size());
    sizes.num_node_sets = Index(mesh.part.nodeSets.size());
    sizes.num_side_sets = Index(mesh.part.sideSets.size());
    ex_set_max_name_length(id(), int(longestName_));
    require(ex_put_init_ext(id(), &sizes), "sizes of the mesh");
  });
  writeNodes(mesh);
  writeBlocks(mesh);
  writeNodeSets(mesh);
  writeSideSets(mesh);
  onRoot([&] {
    writeNames(EX_NODE_SET, mesh.part.nodeSets);
    writeNames(EX_SIDE_SET, mesh.part.sideSets);
  });
  agree();
}

// Components apart, as the library wants them; ranks send points, so that a piece is a range of nodes.
void ExodusWriter::File::writeNodes(const MeshShare& mesh) {
  const auto& x = mesh.part.coordinates;
  pass(x.data(), x.size(), 1, [&](Index first, Index count, const std::array<double, 3>* nodes) {
    std::array<std::vector<double>, 3> components;
    for (std::size_t c = 0; c < 3; ++c)
      for (Index i = 0; i < count; ++i) components[c].push_back(nodes[i][c]);
    require(ex_put_partial_coord(id(), first, count, components[0].data(), components[1].data(), components[2].data()), "coordinates");
  });
  onRoot([&] {
    std::array<char, 2> names[3] = {{'x', 0}, {'y', 0}, {'z', 0}};
    char* pointers[3] = {names[0].data(), names[1].data(), names[2].data()};
    require(ex_put_coord_names(id(), pointers), "names of the coordinates");
  });
  writeNumbers(EX_NODE_MAP, mesh.part.nodeNumbers, "node number map");
}

/// A mesh without numbers has none on any rank.
void ExodusWriter::File::writeNumbers(ex_entity_type type, const std::vector<Index>& numbers, const char* what) {
  pass(numbers.data(), numbers.size(), 1, [&](Index first, Index count, const Index* values) {
    require(ex_put_partial_id_map(id(), type, first, count, values), what);
  });
}

// Block by block all ranks send what they have of it: their ranges follow on each other in the block.
void ExodusWriter::File::writeBlocks(const MeshShare& mesh) {
  onRoot([&] {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const Topology topology = mesh.part.blocks[b].topology;
      require(ex_put_block(id(), EX_ELEM_BLOCK, blocks_[b].id, topologyName(topology), blocks_[b].size, nodesPerElement(topology), 0, 0, 0),
              "element block");
    }
    writeNames(EX_ELEM_BLOCK, mesh.part.blocks);
  });
  for (const auto& block : mesh.part.blocks) {
    const auto nodes = oneBased(block.connectivity);
    pass(nodes.data(), nodes.size(), std::size_t(nodesPerElement(block.topology)), [&](Index first, Index count, const Index* values) {
      require(ex_put_partial_elem_conn(id(), block.id, first, count, values), "connectivity");
    });
  }
  writeNumbers(EX_ELEM_MAP, mesh.part.elementNumbers, "element number map");
}

// Members lie with their nodes; they go to the places that they had in the set first, so that a set is written as it was read.
void ExodusWriter::File::writeNodeSets(const MeshShare& mesh) {
  const auto members = setNodesInOrder(*comm_, mesh);
  auto member = members.begin();
  for (std::size_t s = 0; s < mesh.part.nodeSets.size(); ++s) {
    const Index set = mesh.part.nodeSets[s].id;
    std::vector<Index> nodes;
    for (; member != members.end() && member->set == int(s); ++member) nodes.push_back(member->index + 1);
    onRoot([&] { require(ex_put_set_param(id(), EX_NODE_SET, set, mesh.nodeSetSizes[s], 0), "node set"); });
    pass(nodes.data(), nodes.size(), 1, [&](Index first, Index count, const Index* values) {
      require(ex_put_partial_node_set(id(), set, first, count, values), "node set");
    });
  }
}

// The same for sides, which lie with their elements.
void ExodusWriter::File::writeSideSets(const MeshShare& mesh) {
  const auto members = sidesInOrder(*comm_, mesh);
  auto member = members.begin();
  for (std::size_t s = 0; s < mesh.part.sideSets.size(); ++s) {
    const Index set = mesh.part.sideSets[s].id;
    std::vector<std::array<Index, 2>> sides;
    for (; member != members.end() && member->set == int(s); ++member) sides.push_back({member->index + 1, member->side + 1});
    onRoot([&] { require(ex_put_set_param(id(), EX_SIDE_SET, set, mesh.sideSetSizes[s], 0), "side set"); });
    pass(sides.data(), sides.size(), 1, [&](Index first, Index count, const std::array<Index, 2>* values) {
      std::vector<Index> elements, numbers;
      for (Index i = 0; i < count; ++i) elements.push_back(values[i][0]), numbers.push_back(values[i][1]);
      require(ex_put_partial_side_set(id(), set, first, count, elements.data(), numbers.data()), "side set");
    });
  }
}

template <class Entity>
void ExodusWriter::File::writeNames(ex_entity_type type, const std::vector<Entity>& all) {
  std::vector<char*> pointers;
  for (const auto& e : all)
    pointers.push_back(const_cast<char*>(e.name.c_str()));  // not changed by the library
  if (!all.empty()) require(ex_put_names(id(), type, pointers.data()), "names");
}

void ExodusWriter::File::defineNames(ex_entity_type type, const std::vector<std::string>& names) {
  std::vector<char*> pointers;
  for (const auto& name : names) pointers.push_back(const_cast<char*>(name.c_str()));
  const int n = int(names.size());
  if (n > 0) require(ex_put_variable_names(id(), type, n, pointers.data()), "names of results");
}

// At the first step; every later one has the same.
void ExodusWriter::File::defineFields(const ResultFields& fields) {
  nodal_ = namesOf(fields.nodal);
  element_ = namesOf(fields.element);
  global_ = namesOf(fields.global);
  onRoot([&] {
    // One call defines all results at once; block by block, every definition would move the data behind it.
    std::vector<int> isDefined;
    for (const auto& block : blocks_)
      isDefined.insert(isDefined.end(), element_.size(), block.size > 0 ? 1 : 0);
    require(ex_put_all_var_param(id(), int(global_.size()), int(nodal_.size()), int(element_.size()),
                                 isDefined.data(), 0, nullptr, 0, nullptr),
            "definition of results");
    defineNames(EX_GLOBAL, global_);
    defineNames(EX_NODAL, nodal_);
    defineNames(EX_ELEM_BLOCK, element_);
  });
}

// Our own mistakes, told before rank 0 waits for pieces that do not come.
void ExodusWriter::File::checkFields(const ResultFields& fields) const {
  TEUCHOS_TEST_FOR_EXCEPTION(
      step_ > 0 && (namesOf(fields.nodal) != nodal_ || namesOf(fields.element) != element_ || namesOf(fields.global) != global_),
      std::logic_error, "ExodusWriter: every step must have the fields of the first one, in the same order.");
  const auto check = [&](const std::string& name, std::size_t size, std::size_t wanted, const char* of) {
    TEUCHOS_TEST_FOR_EXCEPTION(size != wanted, std::logic_error,
                               "ExodusWriter: field " << name << " has " << size << " values for " << wanted << " " << of << ".");
    TEUCHOS_TEST_FOR_EXCEPTION(
        name.empty() || name.size() > longestName_, std::logic_error,
        "ExodusWriter: the field name '" << name << "' must have 1 to " << longestName_ << " characters.");
  };
  for (const auto& [name, values] : fields.nodal) check(name, values.size(), numNodes_, "nodes");
  for (const auto& [name, values] : fields.element) check(name, values.size(), numElements_, "elements");
  for (const auto& field : fields.global) check(field.first, 1, 1, "file");
}

// Exodus has element results by blocks.
void ExodusWriter::File::writeElementField(int index, const std::vector<double>& values) {
  for (const auto& block : blocks_)
    pass(values.data() + block.first, block.count, 1, [&](Index first, Index count, const double* piece) {
      require(ex_put_partial_var(id(), step_, EX_ELEM_BLOCK, index, block.id, first, count, piece), "element results");
    });
}

ExodusWriter::ExodusWriter(RCP<const Communicator> comm, const std::string& path, const MeshShare& mesh)
    : file_(std::make_unique<File>(std::move(comm), path, mesh)) {
  file_->writeMesh(mesh);
}

ExodusWriter::~ExodusWriter() = default;

// What rank 0 meets it tells at the end: the others only send, and would wait for ever if it threw before.
void ExodusWriter::writeStep(double time, const ResultFields& fields) {
  TEUCHOS_TEST_FOR_EXCEPTION(!file_, std::logic_error, "ExodusWriter: the file is closed.");
  File& f = *file_;
  runOnAllRanks(*f.comm_, [&] { f.checkFields(fields); });
  if (f.step_ == 0) f.defineFields(fields);
  ++f.step_;
  f.onRoot([&] {
    f.require(ex_put_time(f.id(), f.step_, &time), "time");
    std::vector<double> global;
    for (const auto& field : fields.global) global.push_back(field.second);
    if (!global.empty())
      f.require(ex_put_var(f.id(), f.step_, EX_GLOBAL, 1, 0, Index(global.size()), global.data()), "global results");
  });
  for (std::size_t i = 0; i < fields.nodal.size(); ++i)
    f.pass(fields.nodal[i].second.data(), f.numNodes_, 1, [&](Index first, Index count, const double* values) {
      f.require(ex_put_partial_var(f.id(), f.step_, EX_NODAL, int(i) + 1, 1, first, count, values), "nodal results");
    });
  for (std::size_t i = 0; i < fields.element.size(); ++i)
    f.writeElementField(int(i) + 1, fields.element[i].second);
  f.onRoot([&] { f.require(ex_update(f.id()), "end of a step"); });
  f.agree();
}

void ExodusWriter::close() {
  TEUCHOS_TEST_FOR_EXCEPTION(!file_, std::logic_error, "ExodusWriter: the file is closed already.");
  const auto file = std::move(file_);
  file->onRoot([&] {
    if (!file->handle_->close()) file->fail("cannot be written (closing it)");
    if (!file->temporary_->renameTo(file->path_)) file->fail("cannot be given its name");
  });
  file->agree();
}

void writeMesh(const std::string& path, const Mesh& mesh) {
  ExodusWriter writer(Teuchos::rcp(new Teuchos::SerialComm<int>()), path, sliceOfMesh(mesh, 0, 1));
  writer.close();
}

void requireWritableFolder(const std::string& file, const std::string& parameterName) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(parameterName + " '" + file + "': " + what);
  };
  std::error_code error;
  if (file.empty()) refuse("a file name is wanted.");
  if (fs::is_directory(file, error)) refuse("this is a folder; a file name is wanted.");
  // The finished file is renamed to this name: that would replace the device itself.
  if (fs::exists(file, error) && !fs::is_regular_file(file, error))
    refuse("this is a device or a pipe; the name of a file is wanted, or an empty one for none.");
  const fs::path folder = fs::path(file).has_parent_path() ? fs::path(file).parent_path() : fs::path(".");
  if (!fs::exists(folder, error)) refuse("the folder '" + folder.string() + "' does not exist.");
  if (!fs::is_directory(folder, error)) refuse("'" + folder.string() + "' is not a folder.");
  // Permissions alone do not tell (read-only file systems, the superuser): try.
  if (!TemporaryFile(file).exists())
    refuse("no file can be written in the folder '" + folder.string() + "'.");
}

}  // namespace Haptos
