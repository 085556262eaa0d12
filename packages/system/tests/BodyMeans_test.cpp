// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BodyMeans.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <cmath>
#include <vector>

namespace {

using namespace Haptos;

// Subdomains of three bodies, dealt in turn; rank 1 may have none.  The last one has no values.
TEUCHOS_UNIT_TEST(BodyMeans, BodiesHaveTheGeometricMean) {
  const auto comm = Tpetra::getDefaultComm();
  const std::vector<int> bodyOf{0, 0, 1, 0, 1, 2};
  const std::vector<std::vector<double>> valuesOf{{1, 0.25, 0.25}, {0.25}, {1, 1}, {}, {1}, {}};
  BodyMeans means(*comm);
  for (std::size_t i = 0; i < bodyOf.size(); ++i) {
    const int rank = comm->getSize() > 2 && int(i) % comm->getSize() == 1 ? 0 : int(i) % comm->getSize();
    if (rank == comm->getRank()) means.add(bodyOf[i], valuesOf[i]);
  }
  means.sum();
  TEST_FLOATING_EQUALITY(means.of(0), std::exp2(-1.5), 1e-14);
  TEST_EQUALITY(means.of(1), 1.0);
  TEST_EQUALITY(means.of(2), 1.0);
}

}  // namespace
