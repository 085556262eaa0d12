// SPDX-License-Identifier: BSD-3-Clause
#include <exodusII.h>
#include <sys/resource.h>

#include <Teuchos_UnitTestHarness.hpp>
#include <Teuchos_DefaultSerialComm.hpp>
#include <csignal>
#include <fstream>
#include <sstream>

#include "Haptos_BoxMesh.hpp"
#include "Haptos_CellMesh.hpp"
#include "Haptos_Error.hpp"
#include "Haptos_ExodusReader.hpp"
#include "Haptos_ExodusWriter.hpp"
#include "MeshTestTools.hpp"

using namespace Haptos;
using namespace HaptosTest;

namespace {

/// \brief Whether a file holds a mesh: as one rank reads it, and this rank's share.  Collective.
void compareWithFile(const Mesh& mesh, const std::string& path, Teuchos::FancyOStream& out, bool& success) {
  const int rank = world().getRank(), ranks = world().getSize();
  TEST_EQUALITY(difference(sliceOfMesh(readExodus(path), 0, 1), sliceOfMesh(mesh, 0, 1)), "");
  TEST_EQUALITY(difference(readExodusShare(world(), path), sliceOfMesh(mesh, rank, ranks)), "");
}

std::string firstBytes(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes(4, '\0');
  in.read(bytes.data(), 4);
  return bytes;
}

/// Results as another program reads them, through the C library.
class ResultFile {
 public:
  explicit ResultFile(const std::string& path) {
    int wordSize = 8, fileWordSize = 0;
    float version = 0;
    id_ = ex_open(path.c_str(), EX_READ | EX_ALL_INT64_API, &wordSize, &fileWordSize, &version);
    ex_set_max_name_length(id_, 80);
  }
  ~ResultFile() { ex_close(id_); }
  int steps() const { return int(ex_inquire_int(id_, EX_INQ_TIME)); }
  double time(int step) const {
    double value = -1;
    ex_get_time(id_, step, &value);
    return value;
  }
  std::string name(ex_entity_type type, int index) const {
    char text[100] = {};
    ex_get_variable_name(id_, type, index, text);
    return text;
  }
  std::vector<double> values(int step, ex_entity_type type, int index, std::int64_t entity,
                             std::size_t n) const {
    std::vector<double> read(n, -77.0);
    ex_get_var(id_, step, type, index, entity, std::int64_t(n), read.data());
    return read;
  }

 private:
  int id_;
};

using Values = std::vector<double>;

Values slice(const Values& all, const EvenRanges& ranges) {
  const int rank = ranges.ranks == 1 ? 0 : world().getRank();
  return {all.begin() + ranges.begin(rank), all.begin() + ranges.begin(rank + 1)};
}

/// This rank's part of fields of the whole mesh; of all of it where `ranks` is 1.
ResultFields makeFields(const Mesh& mesh, double factor, int ranks = world().getSize()) {
  Values x(mesh.numNodes()), twice(x), element(mesh.numElements());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = factor * double(i), twice[i] = 2 * x[i];
  for (std::size_t e = 0; e < element.size(); ++e) element[e] = factor + 100.0 * double(e);
  const EvenRanges nodes{std::int64_t(x.size()), ranks}, elements{std::int64_t(element.size()), ranks};
  return {{{"displacement_x", slice(x, nodes)}, {"a_nodal_field_with_a_name_of_fifty_characters_____", slice(twice, nodes)}},
          {{"stress_xx", slice(element, elements)}, {"subdomain", slice(element, elements)}},
          {{"kkt", 1e-7 * factor}, {"hessian_multiplications", 10 * factor}}};
}

RCP<const Communicator> worldComm() { return Teuchos::DefaultComm<int>::getComm(); }

MeshShare shareOf(const Mesh& mesh) { return sliceOfMesh(mesh, world().getRank(), world().getSize()); }

std::string bytesOf(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

void writeResults(const RCP<const Communicator>& comm, const std::string& path, const Mesh& mesh) {
  const int ranks = comm->getSize();
  ExodusWriter writer(comm, path, sliceOfMesh(mesh, comm->getRank(), ranks));
  writer.writeStep(1.0, makeFields(mesh, 1.0, ranks));
  writer.writeStep(2.5, makeFields(mesh, 3.0, ranks));
  writer.close();
}

}  // namespace

TEUCHOS_UNIT_TEST(ExodusRoundTrip, AllElementTypes) {
  const TestFolder folder;
  BoxSpec box;
  box.blockName = "box";
  box.divisions = {2, 2, 2};
  box.sideSetNames = {"west", "", "", "", "bottom", "top"};
  for (int t = 0; t < kNumTopologies; ++t) {
    const Mesh mesh = withElements(makeBoxes({box}), Topology(t));
    onRoot([&] { writeMesh(folder.file("all.exo"), mesh); });
    compareWithFile(mesh, folder.file("all.exo"), out, success);
    TEST_ASSERT(readExodus(folder.file("all.exo")).blocks[0].topology == Topology(t));
  }
  const std::vector<Cell> cells{Cell::Hexahedron, Cell::Hexahedron, Cell::Hexahedron, Cell::Hexahedron,
                                Cell::Pyramids,   Cell::Wedges,     Cell::Wedges,     Cell::Pyramids};
  const Mesh mesh = withCells(makeBoxes({box}), cells, ElementOrder::Quadratic);
  onRoot([&] { writeMesh(folder.file("mixed.exo"), mesh); });
  compareWithFile(mesh, folder.file("mixed.exo"), out, success);
}

// Of the last step; the other field by its name alone.
TEUCHOS_UNIT_TEST(Exodus, NodalFieldsAreReadWhereTheyAreWanted) {
  const std::string wanted = "a_nodal_field_with_a_name_of_fifty_characters_____";
  for (Mesh mesh : {makeRichMesh(), makeWideMesh()}) {
    const TestFolder folder;
    writeResults(worldComm(), folder.file("m.exo"), mesh);
    const int rank = world().getRank(), ranks = world().getSize();
    TEST_EQUALITY(difference(readExodusShare(world(), folder.file("m.exo")), sliceOfMesh(mesh, rank, ranks)), "");
    mesh.nodalFields = {{"displacement_x", {}}, {wanted, makeFields(mesh, 3.0, 1).nodal[1].second}};
    TEST_EQUALITY(difference(readExodusShare(world(), folder.file("m.exo"), {wanted, "none of them"}), sliceOfMesh(mesh, rank, ranks)), "");
  }
}

TEUCHOS_UNIT_TEST(Exodus, MeshSurvivesClassicFile) {
  const TestFolder folder;
  const Mesh mesh = makeRichMesh();
  TEST_EQUALITY(mesh.blocks[0].name.size(), 60u);
  onRoot([&] { writeMesh(folder.file("m.exo"), mesh); });
  TEST_EQUALITY(firstBytes(folder.file("m.exo")).substr(0, 3), "CDF");
  compareWithFile(mesh, folder.file("m.exo"), out, success);
  TEST_EQUALITY(findSideSet(readExodus(folder.file("m.exo")), "12"), 1);
}

TEUCHOS_UNIT_TEST(Exodus, MeshWithWideNumbersSurvives) {
  const TestFolder folder;
  const Mesh mesh = makeWideMesh();
  onRoot([&] { writeMesh(folder.file("m.exo"), mesh); });
  TEST_EQUALITY(firstBytes(folder.file("m.exo")), "\x89HDF");
  compareWithFile(mesh, folder.file("m.exo"), out, success);

  // One wide number alone asks for 64 bits, even if the mesh did not say so.
  Mesh numbered = makeRichMesh();
  numbered.nodeNumbers[3] = std::int64_t(1) << 32;
  onRoot([&] { writeMesh(folder.file("n.exo"), numbered); });
  const Mesh read = readExodus(folder.file("n.exo"));
  TEST_ASSERT(read.wideIntegers);
  TEST_EQUALITY(read.nodeNumbers[3], std::int64_t(1) << 32);
}

TEUCHOS_UNIT_TEST(Exodus, ResultsAreWrittenStepByStep) {
  const TestFolder folder;
  for (const Mesh& mesh : {makeRichMesh(), makeWideMesh()}) {
    const auto path = folder.file("r.exo");
    writeResults(worldComm(), path, mesh);
    compareWithFile(mesh, path, out, success);
    const ResultFile file(path);
    TEST_EQUALITY(file.steps(), 2);
    TEST_EQUALITY(file.time(2), 2.5);
    const auto fields = makeFields(mesh, 3.0, 1);
    for (int i = 1; i <= 2; ++i) {
      TEST_EQUALITY(file.name(EX_NODAL, i), fields.nodal[std::size_t(i - 1)].first);
      TEST_EQUALITY(file.name(EX_ELEM_BLOCK, i), fields.element[std::size_t(i - 1)].first);
      TEST_EQUALITY(file.name(EX_GLOBAL, i), fields.global[std::size_t(i - 1)].first);
      TEST_COMPARE_ARRAYS(file.values(2, EX_NODAL, i, 1, mesh.numNodes()),
                          fields.nodal[std::size_t(i - 1)].second);
    }
    TEST_COMPARE_ARRAYS(file.values(2, EX_GLOBAL, 1, 1, 2), (std::vector<double>{3e-7, 30.0}));
    TEST_COMPARE_ARRAYS(file.values(1, EX_GLOBAL, 1, 1, 2), (std::vector<double>{1e-7, 10.0}));
    // The tetrahedra come after 6 hexahedra and an empty block.
    const auto tets = file.values(2, EX_ELEM_BLOCK, 1, 4, mesh.blocks[2].numElements());
    TEST_EQUALITY(tets.size(), 24u);
    TEST_EQUALITY(tets.front(), 603.0);
    TEST_EQUALITY(tets.back(), 2903.0);
  }
}

// Piece by piece from all ranks, more than one piece from each: byte by byte what one rank writes.
TEUCHOS_UNIT_TEST(Exodus, RanksWriteTheFileOfOneRank) {
  const TestFolder folder;
  for (const Mesh& mesh : {makeRichMesh(), makeTwoBeams({2, 16})}) {
    onRoot([&] { writeResults(Teuchos::rcp(new Teuchos::SerialComm<int>()), folder.file("one.exo"), mesh); });
    writeResults(worldComm(), folder.file("all.exo"), mesh);
    TEST_ASSERT(bytesOf(folder.file("all.exo")) == bytesOf(folder.file("one.exo")));
  }
  const std::size_t connectivity = 8 * sizeof(std::int64_t) * makeTwoBeams({2, 16}).numElements();
  TEST_ASSERT(connectivity / std::size_t(world().getSize()) > ExodusWriter::kPieceBytes);
}

TEUCHOS_UNIT_TEST(Exodus, MisuseOfTheWriterIsNoticed) {
  const TestFolder folder;
  const Mesh mesh = makeRichMesh();
  ExodusWriter writer(worldComm(), folder.file("r.exo"), shareOf(mesh));
  auto shorter = makeFields(mesh, 1.0);
  if (world().getRank() == world().getSize() - 1) shorter.nodal[0].second.pop_back();
  TEST_THROW(writer.writeStep(1.0, shorter), CollectiveError);

  ExodusWriter second(worldComm(), folder.file("s.exo"), shareOf(mesh));
  second.writeStep(1.0, makeFields(mesh, 1.0));
  auto renamed = makeFields(mesh, 1.0);
  renamed.element[0].first = "stress_yy";
  TEST_THROW(second.writeStep(2.0, renamed), CollectiveError);
  second.close();
  TEST_THROW(second.close(), std::logic_error);
  TEST_THROW(second.writeStep(2.0, makeFields(mesh, 1.0)), std::logic_error);
}

TEUCHOS_UNIT_TEST(Exodus, NoPartialFilePassesAsWhole) {
  const TestFolder folder;
  const Mesh mesh = makeRichMesh();
  onRoot([&] { std::ofstream(folder.file("r.exo")) << "an older result"; });
  {
    ExodusWriter writer(worldComm(), folder.file("r.exo"), shareOf(mesh));
    writer.writeStep(1.0, makeFields(mesh, 1.0));
    onRoot([&] {
      TEST_EQUALITY(folder.entries().size(), 2u);  // the temporary file beside the older one
      TEST_EQUALITY(firstBytes(folder.file("r.exo")), "an o");
    });
  }
  onRoot([&] {
    TEST_EQUALITY(folder.entries().size(), 1u);
    TEST_EQUALITY(firstBytes(folder.file("r.exo")), "an o");

    writeMesh(folder.file("r.exo"), mesh);
    TEST_EQUALITY(folder.entries().size(), 1u);
    TEST_EQUALITY(firstBytes(folder.file("r.exo")).substr(0, 3), "CDF");
    const auto permissions = std::filesystem::status(folder.file("r.exo")).permissions();
    std::ofstream(folder.file("plain")) << "x";
    TEST_ASSERT(permissions == std::filesystem::status(folder.file("plain")).permissions());
  });
}

// Rank 0 fails in the middle; the others have still to send.
TEUCHOS_UNIT_TEST(Exodus, FullDiskIsReportedAndLeavesNothing) {
  const TestFolder folder;
  const Mesh mesh = makeTwoBeams({2, 4});
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto oldHandler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{20000, before.rlim_max};
  std::string message;
  if (world().getRank() == 0) setrlimit(RLIMIT_FSIZE, &small);
  try {
    writeResults(worldComm(), folder.file("full.exo"), mesh);
  } catch (const InputError& e) {
    message = e.what();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, oldHandler);
  TEST_INEQUALITY(message.find("full.exo' cannot be written"), std::string::npos);
  onRoot([&] {
    TEST_EQUALITY(folder.entries().size(), 0u);
    writeMesh(folder.file("full.exo"), mesh);  // the limit was what stopped it
    TEST_COMPARE(std::filesystem::file_size(folder.file("full.exo")), >, 20000u);
  });
}

TEUCHOS_UNIT_TEST(Exodus, OutputFolderIsCheckedBeforehand) {
  const TestFolder folder;
  const auto messageOf = [](const std::string& file) -> std::string {
    try {
      requireWritableFolder(file, "Output->File");
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  onRoot([&] {
  std::ofstream(folder.file("plain")) << "x";
  TEST_EQUALITY(messageOf(folder.file("new.exo")), "");
  TEST_EQUALITY(messageOf(folder.file("plain")), "");
  TEST_EQUALITY(folder.entries().size(), 1u);  // the trial left nothing and changed nothing
  TEST_EQUALITY(firstBytes(folder.file("plain"))[0], 'x');
  TEST_INEQUALITY(messageOf(folder.file("no/new.exo")).find("no' does not exist"), std::string::npos);
  TEST_INEQUALITY(messageOf(folder.file("no/new.exo")).find("Output->File"), std::string::npos);
  TEST_INEQUALITY(messageOf(folder.file("plain/new.exo")).find("plain' is not a folder"), std::string::npos);
  TEST_INEQUALITY(messageOf(folder.file("")).find("this is a folder"), std::string::npos);
  TEST_INEQUALITY(messageOf("").find("a file name is wanted"), std::string::npos);
  if (std::filesystem::exists("/proc/self"))
    TEST_INEQUALITY(messageOf("/proc/new.exo").find("no file can be written"), std::string::npos);
  });
}
