// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BodyShapes.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

namespace {

using namespace Haptos;

// Subdomains of two bodies, dealt in turn; rank 1 may have none.
TEUCHOS_UNIT_TEST(BodyShapes, BodiesHaveTheGeometricMean) {
  const auto comm = Tpetra::getDefaultComm();
  const std::vector<int> bodyOf{0, 0, 1, 0, 1};
  const std::vector<double> stiffnessOf{1, 0.25, 1, 0.0625, 1};
  std::vector<int> bodies;
  std::vector<PartShape> shapes;
  for (std::size_t i = 0; i < bodyOf.size(); ++i) {
    const int rank = comm->getSize() > 2 && int(i) % comm->getSize() == 1 ? 0 : int(i) % comm->getSize();
    if (rank != comm->getRank()) continue;
    bodies.push_back(bodyOf[i]);
    shapes.push_back({20, stiffnessOf[i]});
  }
  averageNodeStiffness(*comm, bodies, shapes);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    TEST_FLOATING_EQUALITY(shapes[i].nodeStiffness, bodies[i] == 0 ? 0.25 : 1.0, 1e-14);
    TEST_EQUALITY(shapes[i].aspect, 20.0);
  }
}

}  // namespace
