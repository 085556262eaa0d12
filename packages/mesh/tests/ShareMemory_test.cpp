// SPDX-License-Identifier: BSD-3-Clause
// No rank holds an array of the whole mesh, and what a rank touches falls with the number of ranks: by counting what
// operator new is asked for, on two and on four ranks.
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>

#include "AskedMemory.hpp"
#include "FileSetTools.hpp"
#include "Haptos_BoxMesh.hpp"
#include "Haptos_ExodusReader.hpp"
#include "Haptos_ExodusWriter.hpp"
#include "Haptos_MeshFiles.hpp"
#include "MeshTestTools.hpp"

namespace {

using namespace Haptos;
using namespace HaptosTest;

constexpr TwoBeamsSpec spec{2, 12};  // 55296 elements, 61250 nodes

double elementsOfMesh() { return 4.0 * 24 * 24 * 24; }

/// Arrays of `bytesPerElement`: connectivity, or elements as they are sent.
void requireShares(const std::array<Asked, 2>& asked, double bytesPerElement, Teuchos::FancyOStream& out, bool& success) {
  out << "largest " << asked[0].largest << " -> " << asked[1].largest << ", all " << asked[0].total << " -> " << asked[1].total << "\n";
  for (int i = 0; i < 2; ++i) {
    const double share = bytesPerElement * elementsOfMesh() / (i == 0 ? 2 : 4);
    TEST_COMPARE(asked[i].largest, >, 0.3 * share);  // it was counted
    TEST_COMPARE(asked[i].largest, <, 2.1 * share);  // a vector grows by doubling
  }
  TEST_COMPARE(asked[1].total, <, 1.5 * asked[0].total / 2);
}

}  // namespace

TEUCHOS_UNIT_TEST(ShareMemory, GeneratedMesh) {
  const auto asked = onTwoAndFour([](const auto& comm) { shareTwoBeams(spec, comm->getRank(), comm->getSize()); });
  requireShares(asked, 8 * sizeof(std::int64_t), out, success);
}

TEUCHOS_UNIT_TEST(ShareMemory, OneFile) {
  const TestFolder folder;
  onRoot([&] { writeMesh(folder.file("m.exo"), makeTwoBeams(spec)); });
  const auto asked = onTwoAndFour([&](const auto& comm) { readExodusShare(*comm, folder.file("m.exo")); });
  requireShares(asked, 8 * sizeof(std::int64_t), out, success);
}

TEUCHOS_UNIT_TEST(ShareMemory, SeveralFiles) {
  const TestFolder folder;
  onRoot([&] {
    const Mesh mesh = makeTwoBeams(spec);
    std::vector<int> part(mesh.numElements());
    for (std::size_t e = 0; e < part.size(); ++e) part[e] = int(8 * e / part.size());
    writeFileSet(folder.file("m.exo"), mesh, part, 8);
  });
  const auto asked = onTwoAndFour([&](const auto& comm) { readMeshFiles(*comm, folder.file("m.exo")); });
  requireShares(asked, 10 * sizeof(std::int64_t), out, success);  // an element is sent with its index and number
}

// What rank 0 writes is the whole, but it holds a piece of it.
TEUCHOS_UNIT_TEST(ShareMemory, WritingHoldsShares) {
  const TestFolder folder;
  const auto asked = onTwoAndFour([&](const auto& comm) {
    const MeshShare share = shareTwoBeams(spec, comm->getRank(), comm->getSize());
    ExodusWriter writer(comm, folder.file("m.exo"), share);
    const std::vector<double> nodal(share.part.coordinates.size(), 1.0), element(share.part.numElements(), 2.0);
    writer.writeStep(1.0, {{{"a", nodal}, {"b", nodal}}, {{"c", element}}, {{"d", 3.0}}});
    writer.close();
  });
  for (int i = 0; i < 2; ++i) {
    const double share = 64 * elementsOfMesh() / (i == 0 ? 2 : 4);
    TEST_COMPARE(share, >, 0.8 * double(ExodusWriter::kPieceBytes));
    TEST_COMPARE(asked[std::size_t(i)].largest, <, 2.1 * std::max(share, double(ExodusWriter::kPieceBytes)));
  }
}
