// SPDX-License-Identifier: BSD-3-Clause
// No rank holds an array of the whole mesh, and what a rank touches falls with the number of ranks: by counting what
// operator new is asked for, on two and on four ranks.
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <new>

#include "FileSetTools.hpp"
#include "Haptos_BoxMesh.hpp"
#include "Haptos_ExodusReader.hpp"
#include "Haptos_ExodusWriter.hpp"
#include "Haptos_MeshFiles.hpp"
#include "MeshTestTools.hpp"

namespace {

std::size_t largest = 0, total = 0;

void* countedNew(std::size_t size) {
  largest = std::max(largest, size);
  total += size;
  if (void* p = std::malloc(size)) return p;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return countedNew(size); }
void* operator new[](std::size_t size) { return countedNew(size); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }

namespace {

using namespace Haptos;
using namespace HaptosTest;

constexpr TwoBeamsSpec spec{2, 12};  // 55296 elements, 61250 nodes

double elementsOfMesh() { return 4.0 * 24 * 24 * 24; }

/// [bytes], the most of any rank.
struct Asked {
  double largest, total;
};

Asked count(const Communicator& comm, const std::function<void()>& work) {
  comm.barrier();
  largest = total = 0;
  work();
  const double mine[2] = {double(largest), double(total)};
  double most[2];
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, 2, mine, most);
  return {most[0], most[1]};
}

/// `work` on the first two ranks and on all four.
std::array<Asked, 2> onTwoAndFour(const std::function<void(const RCP<const Communicator>&)>& work) {
  const auto half = world().split(world().getRank() < 2 ? 0 : -1, world().getRank());
  std::array<Asked, 2> asked{};
  if (world().getRank() < 2) asked[0] = count(*half, [&] { work(half); });
  const RCP<const Communicator> all = Teuchos::DefaultComm<int>::getComm();
  asked[1] = count(*all, [&] { work(all); });
  double two[2] = {asked[0].largest, asked[0].total};
  Teuchos::broadcast(world(), 0, 2, two);
  asked[0] = {two[0], two[1]};
  return asked;
}

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
