// SPDX-License-Identifier: BSD-3-Clause
// Files that must be refused: each with one InputError that names the file and what is wrong with it,
// and without a word of the libraries on stderr; on all ranks alike, whoever has the bad part in its share.
#include <exodusII.h>
#include <fcntl.h>

#include <Teuchos_UnitTestHarness.hpp>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_ExodusReader.hpp"
#include "Haptos_ExodusWriter.hpp"
#include "MeshTestTools.hpp"

using namespace Haptos;
using namespace HaptosTest;

namespace {

/// \brief Collects what anybody writes to stderr during its life.
class StderrTrap {
 public:
  explicit StderrTrap(std::string file) : file_(std::move(file)), saved_(dup(2)) {
    const int trap = open(file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(trap, 2);
    close(trap);
  }
  ~StderrTrap() { release(); }
  std::string release() {
    if (saved_ >= 0) {
      fflush(stderr);
      dup2(saved_, 2);
      close(saved_);
      saved_ = -1;
    }
    std::ostringstream text;
    text << std::ifstream(file_).rdbuf();
    return text.str();
  }

 private:
  std::string file_;
  int saved_;
};

/// \brief The message with which a file is refused, followed by any chatter; empty if it is read.  Collective.
std::string refusal(const TestFolder& folder, const std::string& path) {
  world().barrier();
  StderrTrap trap(folder.file("stderr" + std::to_string(world().getRank())));
  std::string message;
  try {
    readExodusShare(world(), path);
  } catch (const InputError& e) {
    message = e.what();
  }
  const auto chatter = trap.release();
  if (!chatter.empty()) message += "\nCHATTER: " + chatter;
  const auto all = gatherOnAll(world(), Bytes(message.begin(), message.end()));
  for (const auto& other : all)
    if (other != all[0]) return "\nANOTHER RANK SAYS: " + std::string(other.begin(), other.end());
  return message;
}

/// \brief Refused in one line that names the file and holds all `parts`.
bool says(const std::string& message, const std::string& path, const std::vector<std::string>& parts,
          Teuchos::FancyOStream& out) {
  out << message << "\n";
  bool fine = message.find("'" + path + "'") != std::string::npos && message.find('\n') == std::string::npos;
  for (const auto& part : parts) fine = fine && message.find(part) != std::string::npos;
  return fine;
}

Mesh smallMesh() {
  BoxSpec box;
  box.blockName = "box";
  box.divisions = {4, 4, 4};
  box.sideSetNames = {"west", "", "", "", "", ""};
  Mesh mesh = makeBoxes({box});
  mesh.nodeSets = {{8, "corner", {0}}};
  return mesh;
}

std::string writeAndRefuse(const TestFolder& folder, const Mesh& mesh) {
  onRoot([&] { writeMesh(folder.file("m.exo"), mesh); });
  return refusal(folder, folder.file("m.exo"));
}

std::string readBytes(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

void writeBytes(const std::string& path, const std::string& bytes) {
  onRoot([&] { std::ofstream(path, std::ios::binary) << bytes; });
}

bool libraryOpens(const std::string& path) {
  ex_opts(0);
  int wordSize = 8, fileWordSize = 0;
  float version = 0;
  const int id = ex_open(path.c_str(), EX_READ, &wordSize, &fileWordSize, &version);
  if (id >= 0) ex_close(id);
  return id >= 0;
}

/// \brief A file with one block as the C library writes it, for meshes that `writeMesh` cannot express.
void writeBlock(const std::string& path, const char* type, int dimension, int nodesPerElement, int elements) {
  int wordSize = 8, fileWordSize = 8;
  const int id = ex_create(path.c_str(), EX_CLOBBER, &wordSize, &fileWordSize);
  ex_put_init(id, "raw", dimension, nodesPerElement, 1, elements > 0 ? 1 : 2, 0, 0);
  const std::vector<double> x(std::size_t(nodesPerElement), 0.0);
  ex_put_coord(id, x.data(), x.data(), x.data());
  std::vector<int> nodes;
  for (int i = 0; i < nodesPerElement; ++i) nodes.push_back(i + 1);
  ex_put_elem_block(id, 33, type, elements, nodesPerElement, 0);
  if (elements > 0)
    ex_put_elem_conn(id, 33, nodes.data());
  else {
    ex_put_elem_block(id, 44, "HEX", 1, 8, 0);
    ex_put_elem_conn(id, 44, nodes.data());
  }
  ex_put_name(id, EX_ELEM_BLOCK, 33, "odd one");
  ex_close(id);
}

}  // namespace

TEUCHOS_UNIT_TEST(HostileFile, NotAFileAtAll) {
  const TestFolder folder;
  const auto missing = folder.file("missing.exo");
  TEST_ASSERT(says(refusal(folder, missing), missing, {"there is no such file"}, out));
  TEST_ASSERT(says(refusal(folder, folder.file("")), folder.file(""), {"this is a folder"}, out));
  TEST_ASSERT(says(refusal(folder, ""), "", {"there is no such file"}, out));
  TEST_ASSERT(says(refusal(folder, "/dev/zero"), "/dev/zero", {"not a regular file"}, out));
  writeBytes(folder.file("empty.exo"), "");
  TEST_ASSERT(
      says(refusal(folder, folder.file("empty.exo")), folder.file("empty.exo"), {"the file is empty"}, out));
}

TEUCHOS_UNIT_TEST(HostileFile, NotExodus) {
  const TestFolder folder;
  const auto path = folder.file("text.exo");
  for (const auto& text : {"A", "CDF", "This is no mesh, whatever its name may say.\n"}) {
    writeBytes(path, text);
    TEST_ASSERT(says(refusal(folder, path), path, {"not an Exodus II file"}, out));
  }
  // Whole netCDF files without a mesh: an empty classic one, and a truncated HDF5 signature.
  writeBytes(path, std::string("CDF\x01", 4) + std::string(28, '\0'));
  TEST_ASSERT(says(refusal(folder, path), path, {"cannot be opened as an Exodus II file"}, out));
  writeBytes(path, "\x89HDF\r\n\x1a\n");
  TEST_ASSERT(says(refusal(folder, path), path, {"cannot be opened as an Exodus II file"}, out));
}

TEUCHOS_UNIT_TEST(HostileFile, CutShort) {
  const TestFolder folder;
  const auto whole = folder.file("whole.exo"), cut = folder.file("cut.exo");
  for (const bool wide : {false, true}) {
    Mesh mesh = smallMesh();
    mesh.wideIntegers = wide;
    onRoot([&] { writeMesh(whole, mesh); });
    const auto bytes = readBytes(whole);
    TEST_EQUALITY(refusal(folder, whole), "");
    int opened = 0;
    for (int part = 0; part <= 40; ++part) {
      writeBytes(cut, bytes.substr(0, 8 + (bytes.size() - 16) * std::size_t(part) / 40));
      opened += !wide && libraryOpens(cut) ? 1 : 0;
      TEST_ASSERT(says(refusal(folder, cut), cut, {"cut short"}, out));
    }
    // The library alone would have read zeros from most of the classic ones.
    if (!wide) TEST_COMPARE(opened, >, 20);
  }
}

TEUCHOS_UNIT_TEST(HostileFile, DamagedHeader) {
  const TestFolder folder;
  const auto whole = folder.file("whole.exo"), bad = folder.file("bad.exo");
  onRoot([&] { writeMesh(whole, smallMesh()); });
  const auto bytes = readBytes(whole);
  // Any count in the header made huge: refused, whatever the count was for, and never a crash.
  int refused = 0;
  for (std::size_t at = 4; at < 400; at += 4) {
    auto damaged = bytes;
    damaged.replace(at, 4, "\x7f\xff\xff\xff");
    writeBytes(bad, damaged);
    refused += refusal(folder, bad).empty() ? 0 : 1;
  }
  TEST_COMPARE(refused, >, 40);
}

TEUCHOS_UNIT_TEST(HostileFile, UnsupportedElements) {
  const TestFolder folder;
  const auto path = folder.file("odd.exo");
  onRoot([&] { writeBlock(path, "HEX16", 3, 16, 1); });
  TEST_ASSERT(says(refusal(folder, path), path, {"element block 33 ('odd one')", "'HEX16' with 16 nodes", "read are HEX8, TETRA4, HEX20"}, out));
  onRoot([&] { writeBlock(path, "HEX", 3, 9, 1); });
  TEST_ASSERT(says(refusal(folder, path), path, {"element block 33", "'HEX' with 9 nodes"}, out));
  onRoot([&] { writeBlock(path, "HEX20", 3, 27, 1); });
  TEST_ASSERT(says(refusal(folder, path), path, {"element block 33", "'HEX20' with 27 nodes"}, out));
  onRoot([&] { writeBlock(path, "WEDGE", 3, 18, 1); });
  TEST_ASSERT(says(refusal(folder, path), path, {"element block 33", "'WEDGE' with 18 nodes"}, out));
  onRoot([&] { writeBlock(path, "QUAD4", 2, 4, 1); });
  TEST_ASSERT(says(refusal(folder, path), path, {"2 dimensions", "three-dimensional"}, out));
}

TEUCHOS_UNIT_TEST(HostileFile, AcceptedSpellingsAndEmptyBlocks) {
  const TestFolder folder;
  const auto path = folder.file("fine.exo");
  for (const auto& type : {"HEX", "HEX8", "hex8", "Hex"}) {
    onRoot([&] { writeBlock(path, type, 3, 8, 1); });
    TEST_ASSERT(readExodus(path).blocks[0].topology == Topology::Hex8);
  }
  for (const auto& type : {"TET", "TET4", "TETRA", "tetra4", "TETRA4"}) {
    onRoot([&] { writeBlock(path, type, 3, 4, 1); });
    TEST_ASSERT(readExodus(path).blocks[0].topology == Topology::Tet4);
  }
  for (const auto& type : {"NULL", "HEX20"}) {
    onRoot([&] { writeBlock(path, type, 3, 8, 0); });  // no element of that type
    const Mesh mesh = readExodus(path);
    TEST_EQUALITY(listBlocks(mesh), "odd one (33), 44");
    TEST_EQUALITY(mesh.blocks[0].numElements(), 0u);
    TEST_EQUALITY(mesh.blocks[1].numElements(), 1u);
    TEST_EQUALITY(mesh.nodeNumbers.back(), 8);  // 1..n by default
  }
}

TEUCHOS_UNIT_TEST(HostileFile, IndicesOutOfRange) {
  const TestFolder folder;
  const auto path = folder.file("m.exo");
  const Mesh good = smallMesh();
  TEST_EQUALITY(writeAndRefuse(folder, good), "");
  for (const std::int64_t node : {std::int64_t(-1), std::int64_t(125), std::int64_t(-1000)}) {
    Mesh mesh = good;
    mesh.blocks[0].connectivity[77] = node;
    TEST_ASSERT(says(writeAndRefuse(folder, mesh), path,
                     {"element block 1 ('box')", "node " + std::to_string(node + 1), "from 1 to 125"}, out));
  }
  const auto spoil = [&](const std::function<void(int)>& put) {
    onRoot([&] {
      writeMesh(path, good);
      int wordSize = 8, fileWordSize = 0;
      float version = 0;
      const int id = ex_open(path.c_str(), EX_WRITE, &wordSize, &fileWordSize, &version);
      put(id);
      ex_close(id);
    });
    return refusal(folder, path);
  };
  const int node = 126;
  TEST_ASSERT(says(spoil([&](int id) { ex_put_partial_node_set(id, 8, 1, 1, &node); }), path,
                   {"node set 8 ('corner')", "node 126", "from 1 to 125"}, out));
  const auto side = [&](int place, int element, int number) {
    return spoil([&](int id) { ex_put_partial_side_set(id, 1, place, 1, &element, &number); });
  };
  TEST_ASSERT(says(side(4, 13, 7), path, {"side set 1 ('west')", "side 7 of element 13", "HEX8 go from 1 to 6"}, out));
  TEST_ASSERT(says(side(4, 65, 4), path, {"side set 1 ('west')", "element 65", "from 1 to 64"}, out));
  TEST_ASSERT(says(side(16, 0, 4), path, {"side set 1 ('west')", "element 0", "from 1 to 64"}, out));
}

TEUCHOS_UNIT_TEST(HostileFile, CoordinatesMustBeFinite) {
  const TestFolder folder;
  Mesh mesh = smallMesh();
  mesh.nodeNumbers[50] = 4711;
  mesh.coordinates[50][1] = std::numeric_limits<double>::quiet_NaN();
  TEST_ASSERT(says(writeAndRefuse(folder, mesh), folder.file("m.exo"),
                   {"node 4711", "the y coordinate", "nan"}, out));
  mesh.coordinates[50][1] = std::numeric_limits<double>::infinity();
  TEST_ASSERT(says(writeAndRefuse(folder, mesh), folder.file("m.exo"), {"node 4711", "inf"}, out));
}
