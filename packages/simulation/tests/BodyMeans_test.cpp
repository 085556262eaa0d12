// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BodyMeans.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>

namespace {

using namespace Haptos;

// Subdomains of two bodies, dealt in turn; rank 1 may have none.
TEUCHOS_UNIT_TEST(BodyMeans, BodiesHaveTheGeometricMean) {
  const auto comm = Tpetra::getDefaultComm();
  const std::vector<int> bodyOf{0, 0, 1, 0, 1};
  const std::vector<double> valueOf{1, 0.25, 1, 0.0625, 1};
  std::vector<int> bodies;
  std::vector<double> values;
  for (std::size_t i = 0; i < bodyOf.size(); ++i) {
    const int rank = comm->getSize() > 2 && int(i) % comm->getSize() == 1 ? 0 : int(i) % comm->getSize();
    if (rank != comm->getRank()) continue;
    bodies.push_back(bodyOf[i]);
    values.push_back(valueOf[i]);
  }
  takeMeansOfBodies(*comm, bodies, values);
  for (std::size_t i = 0; i < values.size(); ++i) TEST_FLOATING_EQUALITY(values[i], bodies[i] == 0 ? 0.25 : 1.0, 1e-14);
}

}  // namespace
