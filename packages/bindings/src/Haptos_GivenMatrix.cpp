// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_GivenMatrix.hpp"

#include <Teuchos_DefaultMpiComm.hpp>
#include <Tpetra_CrsMatrix.hpp>
#include <Tpetra_Map.hpp>
#include <algorithm>

#include "Haptos_Error.hpp"

namespace Haptos {

void require(bool holds, const std::string& otherwise) {
  if (!holds) throw InputError(otherwise);
}

void requireStarts(const std::int64_t* starts, std::int64_t count, const std::string& what) {
  require(starts[0] == 0 && std::is_sorted(starts, starts + count + 1), what + " must begin with 0 and not fall.");
}

void requireArrays(std::int64_t count, bool areThere, const std::string& things, const std::string& arrays) {
  require(count >= 0, things + " come with the count " + std::to_string(count) + "; it must be >= 0.");
  require(count == 0 || areThere, things + " come without " + arrays + " (NULL).");
}

void GivenMatrix::take(const double* values) {
  K->resumeFill();
  // Columns are added by sums: an entry that the caller lists twice counts twice, as in the matrix itself.
  K->setAllToScalar(0.0);
  for (std::size_t row = 0; row + 1 < starts.size(); ++row)
    K->sumIntoLocalValues(LocalOrdinal(row), LocalOrdinal(starts[row + 1] - starts[row]), values + starts[row], columns.data() + starts[row]);
  K->fillComplete();
}

GivenMatrix givenMatrix(const haptos_subdomain& given) {
  const std::int64_t rows = 3 * std::int64_t(given.num_nodes);
  require(given.num_nodes > 0 && given.nodes && given.coordinates && given.row_starts && given.columns && given.values,
          "A subdomain lacks nodes, coordinates or a matrix.");
  requireStarts(given.row_starts, rows, "The row starts of a subdomain's matrix");
  GivenMatrix matrix{{given.row_starts, given.row_starts + rows + 1}, {given.columns, given.columns + given.row_starts[rows]}, {}};
  for (auto column : matrix.columns)
    require(column >= 0 && column < rows, "A subdomain's matrix has column " + std::to_string(column) + "; it has " + std::to_string(rows) +
                                              ", numbered from 0.");
  // Of this rank alone, whatever the system's communicator: a subdomain is never shared.
  const auto map = Teuchos::rcp(new Map(Tpetra::global_size_t(rows), 0, Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF))));
  std::vector<std::size_t> lengths;
  for (std::int64_t row = 0; row < rows; ++row) lengths.push_back(std::size_t(matrix.starts[row + 1] - matrix.starts[row]));
  matrix.K = Teuchos::rcp(new CrsMatrix(map, map, Teuchos::arrayViewFromVector(lengths)));
  for (std::int64_t row = 0; row < rows; ++row)
    matrix.K->insertLocalValues(LocalOrdinal(row), LocalOrdinal(lengths[row]), given.values + matrix.starts[row],
                                matrix.columns.data() + matrix.starts[row]);
  matrix.K->fillComplete();
  return matrix;
}

}  // namespace Haptos
