// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ExodusWriter.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "Haptos_Error.hpp"
#include "Haptos_ExodusHandle.hpp"

namespace Haptos {
namespace {

namespace fs = std::filesystem;
using Index = std::int64_t;

/// \brief A file of its own name beside `path`; removed at the end of its life unless it was renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& path) : name_(path + ".XXXXXX") {
    const int descriptor = mkstemp(name_.data());
    if (descriptor >= 0)
      ::close(descriptor);
    else
      name_.clear();
  }
  ~TemporaryFile() {
    std::error_code ignored;
    if (!name_.empty()) fs::remove(name_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  bool exists() const { return !name_.empty(); }
  const std::string& name() const { return name_; }

  /// \return false if the system refuses.
  bool renameTo(const std::string& path) {
    std::error_code error;
    // mkstemp gives the file to its owner alone; a result has the permissions of any new file.
    const auto mask = ::umask(0);
    ::umask(mask);
    fs::permissions(name_, fs::perms(0666 & ~mask), error);
    fs::rename(name_, path, error);
    if (!error) name_.clear();
    return !error;
  }

 private:
  std::string name_;
};

template <class Entity>
bool anyIdIsWide(const std::vector<Entity>& all) {
  return std::any_of(all.begin(), all.end(),
                     [](const Entity& e) { return e.id > std::numeric_limits<int>::max(); });
}

bool needsWideIntegers(const Mesh& mesh) {
  const auto isWide = [](Index number) { return number > std::numeric_limits<int>::max(); };
  return mesh.wideIntegers || anyIdIsWide(mesh.blocks) || anyIdIsWide(mesh.sideSets) ||
         anyIdIsWide(mesh.nodeSets) || isWide(Index(mesh.numNodes())) || isWide(Index(mesh.numElements())) ||
         std::any_of(mesh.nodeNumbers.begin(), mesh.nodeNumbers.end(), isWide) ||
         std::any_of(mesh.elementNumbers.begin(), mesh.elementNumbers.end(), isWide);
}

/// \brief Longest name the file shall hold: at least 64, for the names of results, which come later.
std::size_t longestName(const Mesh& mesh) {
  std::size_t longest = 64;
  for (const auto& e : mesh.blocks) longest = std::max(longest, e.name.size());
  for (const auto& e : mesh.sideSets) longest = std::max(longest, e.name.size());
  for (const auto& e : mesh.nodeSets) longest = std::max(longest, e.name.size());
  return longest;
}

int createFile(const std::string& path, const Mesh& mesh) {
  ex_opts(0);  // the library prints nothing by itself
  int wordSize = 8, fileWordSize = 8;
  const int kind = needsWideIntegers(mesh) ? EX_NETCDF4 | EX_NOCLASSIC | EX_ALL_INT64_DB : EX_LARGE_MODEL;
  return ex_create(path.c_str(), EX_CLOBBER | EX_ALL_INT64_API | kind, &wordSize, &fileWordSize);
}

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

/// The open file and what of the mesh is needed to split the fields.
struct ExodusWriter::File {
  File(const std::string& path, const Mesh& mesh)
      : path_(path),
        temporary_(path),
        numNodes_(mesh.numNodes()),
        numElements_(mesh.numElements()),
        longestName_(longestName(mesh)),
        handle_(temporary_.exists() ? createFile(temporary_.name(), mesh) : -1) {
    if (!handle_.isOpen()) fail("cannot be created");
    for (const auto& block : mesh.blocks) blocks_.push_back({block.id, block.numElements()});
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error("Result file '" + path_ + "' " + what + "; is there space left on the disk?");
  }
  void require(int status, const char* what) const {
    if (status < 0) fail(std::string("cannot be written (") + what + ")");
  }

  void writeMesh(const Mesh& mesh);
  void writeNodes(const Mesh& mesh);
  void writeBlocks(const Mesh& mesh);
  void writeSets(const Mesh& mesh);
  template <class Entity>
  void writeNames(ex_entity_type type, const std::vector<Entity>& all);

  void defineFields(const ResultFields& fields);
  void defineNames(ex_entity_type type, const std::vector<std::string>& names);
  void checkFields(const ResultFields& fields) const;
  void writeElementField(int index, const std::vector<double>& values);

  struct Block {
    Index id;
    std::size_t size;
  };
  std::string path_;
  TemporaryFile temporary_;  // before handle_: the file is closed first, then removed
  std::size_t numNodes_, numElements_, longestName_;
  std::vector<Block> blocks_;
  std::vector<std::string> nodal_, element_, global_;
  int step_ = 0;
  ExodusHandle handle_;
};

void ExodusWriter::File::writeMesh(const Mesh& mesh) {
  ex_init_params sizes{};
  mesh.title.copy(sizes.title, MAX_LINE_LENGTH);
  sizes.num_dim = 3;
  sizes.num_nodes = Index(mesh.numNodes());
  sizes.num_elem = Index(mesh.numElements());
  sizes.num_elem_blk = Index(mesh.blocks.size());
  sizes.num_node_sets = Index(mesh.nodeSets.size());
  sizes.num_side_sets = Index(mesh.sideSets.size());
  ex_set_max_name_length(handle_.id(), int(longestName_));
  require(ex_put_init_ext(handle_.id(), &sizes), "sizes of the mesh");
  writeNodes(mesh);
  writeBlocks(mesh);
  writeSets(mesh);
}

void ExodusWriter::File::writeNodes(const Mesh& mesh) {
  std::array<std::vector<double>, 3> x;
  for (std::size_t c = 0; c < 3; ++c)
    for (const auto& node : mesh.coordinates) x[c].push_back(node[c]);
  require(ex_put_coord(handle_.id(), x[0].data(), x[1].data(), x[2].data()), "coordinates");
  std::array<char, 2> names[3] = {{'x', 0}, {'y', 0}, {'z', 0}};
  char* pointers[3] = {names[0].data(), names[1].data(), names[2].data()};
  require(ex_put_coord_names(handle_.id(), pointers), "names of the coordinates");
  if (!mesh.nodeNumbers.empty())
    require(ex_put_id_map(handle_.id(), EX_NODE_MAP, mesh.nodeNumbers.data()), "node number map");
}

void ExodusWriter::File::writeBlocks(const Mesh& mesh) {
  for (const auto& block : mesh.blocks)
    require(ex_put_block(handle_.id(), EX_ELEM_BLOCK, block.id, topologyName(block.topology),
                         Index(block.numElements()), nodesPerElement(block.topology), 0, 0, 0),
            "element block");
  writeNames(EX_ELEM_BLOCK, mesh.blocks);
  for (const auto& block : mesh.blocks)
    if (block.numElements() > 0)
      require(ex_put_conn(handle_.id(), EX_ELEM_BLOCK, block.id, oneBased(block.connectivity).data(), nullptr,
                          nullptr),
              "connectivity");
  if (!mesh.elementNumbers.empty())
    require(ex_put_id_map(handle_.id(), EX_ELEM_MAP, mesh.elementNumbers.data()), "element number map");
}

void ExodusWriter::File::writeSets(const Mesh& mesh) {
  for (const auto& set : mesh.nodeSets) {
    require(ex_put_set_param(handle_.id(), EX_NODE_SET, set.id, Index(set.nodes.size()), 0), "node set");
    if (!set.nodes.empty())
      require(ex_put_set(handle_.id(), EX_NODE_SET, set.id, oneBased(set.nodes).data(), nullptr), "node set");
  }
  for (const auto& set : mesh.sideSets) {
    std::vector<Index> elements, sides;
    for (const auto& side : set.sides) {
      elements.push_back(side.element + 1);
      sides.push_back(side.side + 1);
    }
    require(ex_put_set_param(handle_.id(), EX_SIDE_SET, set.id, Index(sides.size()), 0), "side set");
    if (!sides.empty())
      require(ex_put_set(handle_.id(), EX_SIDE_SET, set.id, elements.data(), sides.data()), "side set");
  }
  writeNames(EX_NODE_SET, mesh.nodeSets);
  writeNames(EX_SIDE_SET, mesh.sideSets);
}

template <class Entity>
void ExodusWriter::File::writeNames(ex_entity_type type, const std::vector<Entity>& all) {
  std::vector<char*> pointers;
  for (const auto& e : all)
    pointers.push_back(const_cast<char*>(e.name.c_str()));  // not changed by the library
  if (!all.empty()) require(ex_put_names(handle_.id(), type, pointers.data()), "names");
}

void ExodusWriter::File::defineNames(ex_entity_type type, const std::vector<std::string>& names) {
  std::vector<char*> pointers;
  for (const auto& name : names)
    TEUCHOS_TEST_FOR_EXCEPTION(
        name.empty() || name.size() > longestName_, std::logic_error,
        "ExodusWriter: the field name '" << name << "' must have 1 to " << longestName_ << " characters.");
  for (const auto& name : names) pointers.push_back(const_cast<char*>(name.c_str()));
  const int n = int(names.size());
  if (n > 0) require(ex_put_variable_names(handle_.id(), type, n, pointers.data()), "names of results");
}

void ExodusWriter::File::defineFields(const ResultFields& fields) {
  nodal_ = namesOf(fields.nodal);
  element_ = namesOf(fields.element);
  global_ = namesOf(fields.global);
  // One call defines all results at once; block by block, every definition would move the data behind it.
  std::vector<int> isDefined;
  for (const auto& block : blocks_)
    isDefined.insert(isDefined.end(), element_.size(), block.size > 0 ? 1 : 0);
  require(ex_put_all_var_param(handle_.id(), int(global_.size()), int(nodal_.size()), int(element_.size()),
                               isDefined.data(), 0, nullptr, 0, nullptr),
          "definition of results");
  defineNames(EX_GLOBAL, global_);
  defineNames(EX_NODAL, nodal_);
  defineNames(EX_ELEM_BLOCK, element_);
}

void ExodusWriter::File::checkFields(const ResultFields& fields) const {
  TEUCHOS_TEST_FOR_EXCEPTION(
      namesOf(fields.nodal) != nodal_ || namesOf(fields.element) != element_ ||
          namesOf(fields.global) != global_,
      std::logic_error, "ExodusWriter: every step must have the fields of the first one, in the same order.");
  for (const auto& [name, values] : fields.nodal)
    TEUCHOS_TEST_FOR_EXCEPTION(values.size() != numNodes_, std::logic_error,
                               "ExodusWriter: nodal field " << name << " has " << values.size()
                                                            << " values for " << numNodes_ << " nodes.");
  for (const auto& [name, values] : fields.element)
    TEUCHOS_TEST_FOR_EXCEPTION(values.size() != numElements_, std::logic_error,
                               "ExodusWriter: element field " << name << " has " << values.size()
                                                              << " values for " << numElements_
                                                              << " elements.");
}

void ExodusWriter::File::writeElementField(int index, const std::vector<double>& values) {
  std::size_t first = 0;
  for (const auto& block : blocks_) {
    if (block.size > 0)
      require(
          ex_put_var(handle_.id(), step_, EX_ELEM_BLOCK, index, block.id, Index(block.size), &values[first]),
          "element results");
    first += block.size;
  }
}

ExodusWriter::ExodusWriter(const std::string& path, const Mesh& mesh) {
  requireWritableFolder(path, "result file");
  file_ = std::make_unique<File>(path, mesh);
  file_->writeMesh(mesh);
}

ExodusWriter::~ExodusWriter() = default;

void ExodusWriter::writeStep(double time, const ResultFields& fields) {
  TEUCHOS_TEST_FOR_EXCEPTION(!file_, std::logic_error, "ExodusWriter: the file is closed.");
  File& f = *file_;
  if (f.step_ == 0) f.defineFields(fields);
  f.checkFields(fields);
  ++f.step_;
  const int id = f.handle_.id();
  f.require(ex_put_time(id, f.step_, &time), "time");

  std::vector<double> global;
  for (const auto& field : fields.global) global.push_back(field.second);
  if (!global.empty())
    f.require(ex_put_var(id, f.step_, EX_GLOBAL, 1, 0, Index(global.size()), global.data()),
              "global results");
  for (std::size_t i = 0; i < fields.nodal.size(); ++i)
    f.require(
        ex_put_var(id, f.step_, EX_NODAL, int(i) + 1, 1, Index(f.numNodes_), fields.nodal[i].second.data()),
        "nodal results");
  for (std::size_t i = 0; i < fields.element.size(); ++i)
    f.writeElementField(int(i) + 1, fields.element[i].second);
  f.require(ex_update(id), "end of a step");
}

void ExodusWriter::close() {
  TEUCHOS_TEST_FOR_EXCEPTION(!file_, std::logic_error, "ExodusWriter: the file is closed already.");
  const auto file = std::move(file_);
  if (!file->handle_.close()) file->fail("cannot be written (closing it)");
  if (!file->temporary_.renameTo(file->path_)) file->fail("cannot be given its name");
}

void writeMesh(const std::string& path, const Mesh& mesh) {
  ExodusWriter writer(path, mesh);
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
