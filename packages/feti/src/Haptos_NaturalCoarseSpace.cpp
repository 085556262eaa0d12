// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NaturalCoarseSpace.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_LocalSystems.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

// A row of G^T restricted to one subdomain.
struct Piece {
  GlobalOrdinal row;
  int column, count;  // the subdomain's coarse unknowns
};

// Pieces for another rank, or from one, and their values one behind the other.
struct Pieces {
  std::vector<Piece> list;
  std::vector<double> values;
};

// visit(row of the overlap map, column, values) for B R of this rank's subdomains; entries come sorted by subdomain and row.
template <class Visit>
void forEachPiece(const MultiplierMap& multipliers, const LocalSystems& systems, const std::vector<int>& columns, int firstSubdomain,
                  Visit&& visit) {
  const auto& entries = multipliers.overlapEntries();
  std::vector<double> values;
  for (std::size_t k = 0; k < entries.size();) {
    const int row = entries[k].row, subdomain = entries[k].subdomain;
    const Eigen::MatrixXd& R = systems[subdomain - firstSubdomain].R();
    values.assign(std::size_t(R.cols()), 0.0);
    for (; k < entries.size() && entries[k].row == row && entries[k].subdomain == subdomain; ++k)
      for (std::size_t m = 0; m < values.size(); ++m) values[m] += entries[k].value * R(entries[k].dof, Eigen::Index(m));
    visit(row, columns[std::size_t(subdomain - firstSubdomain)], values);
  }
}

// Ranks that own the rows of the overlap map.
std::vector<int> ownersOf(const MultiplierMap& multipliers) {
  // Every row once: Tpetra 13.2's directory leaves the second of two equal indices without an answer.
  const auto rows = localElementList(*multipliers.overlapMap());
  std::vector<int> ranks(rows.size());
  multipliers.map()->getRemoteIndexList(rows, Teuchos::ArrayView<int>(ranks.data(), ranks.size()));
  return ranks;
}

// G^T row by row from pieces that are announced first and added after: nothing is copied or sorted as a whole, which on large
// meshes would cost more memory than G itself.
class RowBuilder {
 public:
  explicit RowBuilder(std::size_t rows) : next_(rows + 1, 0) {}

  void announce(int row, int count) { next_[std::size_t(row) + 1] += count; }
  void allocate(CoarseRows& GT) {
    GT_ = &GT;
    for (std::size_t i = 1; i < next_.size(); ++i) next_[i] += next_[i - 1];
    GT.resizeNonZeros(next_.back());
    std::copy(next_.begin(), next_.end(), GT.outerIndexPtr());
  }
  // Pieces of a row lie in ascending order of columns.
  void add(int row, int column, int count, const double* values) {
    int at = next_[std::size_t(row)];
    next_[std::size_t(row)] += count;
    int *inner = GT_->innerIndexPtr(), *begin = inner + GT_->outerIndexPtr()[row];
    const int* place = inner + at;
    while (place > begin && place[-1] > column) --place;
    const auto moved = inner + at - place;
    std::copy_backward(inner + at - moved, inner + at, inner + at + count);
    std::copy_backward(GT_->valuePtr() + at - moved, GT_->valuePtr() + at, GT_->valuePtr() + at + count);
    at -= int(moved);
    for (int m = 0; m < count; ++m) inner[at + m] = column + m;
    std::copy_n(values, count, GT_->valuePtr() + at);
  }

 private:
  CoarseRows* GT_ = nullptr;
  std::vector<int> next_;  // [rows + 1] entries before a row, later before its next piece
};

// Pieces of rows that other ranks own, all values one after the other.
Pieces exchangePieces(const Communicator& comm, const std::vector<Pieces>& outgoing) {
  std::vector<Bytes> messages;
  for (const auto& part : outgoing) {
    ByteWriter writer;
    writer.write(part.list);
    writer.write(part.values);
    messages.push_back(writer.take());
  }
  Pieces result;
  for (const auto& message : exchangeAll(comm, messages)) {
    ByteReader reader(message);
    const auto list = reader.readVector<Piece>();
    const auto values = reader.readVector<double>();
    result.list.insert(result.list.end(), list.begin(), list.end());
    result.values.insert(result.values.end(), values.begin(), values.end());
  }
  return result;
}

// First coarse unknown of every subdomain of this rank, and the end; kernels are numbered subdomain after subdomain.  Collective.
std::vector<int> numberKernels(const Communicator& comm, const LocalSystems& systems, int& total) {
  int mine = 0, end = 0;
  for (int i = 0; i < systems.size(); ++i) mine += int(systems[i].R().cols());
  Teuchos::scan(comm, Teuchos::REDUCE_SUM, mine, Teuchos::outArg(end));
  Teuchos::reduceAll(comm, Teuchos::REDUCE_SUM, mine, Teuchos::outArg(total));
  std::vector<int> columns{end - mine};
  for (int i = 0; i < systems.size(); ++i) columns.push_back(columns.back() + int(systems[i].R().cols()));
  return columns;
}

}  // namespace

// Rows of G^T = B R at their owners: B's entries of a row in a subdomain times R of it, a piece.  Pieces are counted, then made
// once more and put in their places: rows of growing length would be moved about.
NaturalCoarseSpace::NaturalCoarseSpace(RCP<const JumpOperator> jump, const LocalSystems& systems) : jump_(std::move(jump)) {
  const MultiplierMap& multipliers = jump_->multipliers();
  const auto& map = *multipliers.map();
  const auto& overlap = *multipliers.overlapMap();
  const auto& comm = *map.getComm();
  int l = 0;
  columns_ = numberKernels(comm, systems, l);
  coarseMap_ = Teuchos::rcp(new Map(std::size_t(l), 0, map.getComm(), Tpetra::LocallyReplicated));
  const auto owners = ownersOf(multipliers);
  const auto ownRow = [&](int row) { return map.getLocalElement(overlap.getGlobalElement(row)); };
  const auto forEach = [&](auto&& visit) { forEachPiece(multipliers, systems, columns_, jump_->firstSubdomain(), visit); };

  RowBuilder builder(localNumElements(map));
  std::vector<Pieces> outgoing(std::size_t(comm.getSize()));
  forEach([&](int row, int column, const std::vector<double>& values) {
    const int owner = owners[std::size_t(row)], count = int(values.size());
    if (owner == comm.getRank()) {
      builder.announce(ownRow(row), count);
      return;
    }
    Pieces& part = outgoing[std::size_t(owner)];
    part.list.push_back({overlap.getGlobalElement(row), column, count});
    part.values.insert(part.values.end(), values.begin(), values.end());
  });
  const Pieces received = exchangePieces(comm, outgoing);
  for (const auto& piece : received.list) builder.announce(map.getLocalElement(piece.row), piece.count);
  GT_.resize(Eigen::Index(localNumElements(map)), l);
  builder.allocate(GT_);
  forEach([&](int row, int column, const std::vector<double>& values) {
    if (owners[std::size_t(row)] == comm.getRank()) builder.add(ownRow(row), column, int(values.size()), values.data());
  });
  const double* values = received.values.data();
  for (const auto& piece : received.list) {
    builder.add(map.getLocalElement(piece.row), piece.column, piece.count, values);
    values += piece.count;
  }
}

// This rank's rows of x in G x; what sums up is the caller's.
Eigen::MatrixXd NaturalCoarseSpace::partOfG(const MultiVector& x) const {
  Eigen::MatrixXd mine(GT_.cols(), Eigen::Index(x.getNumVectors()));
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    const auto data = x.getData(v);
    mine.col(Eigen::Index(v)) = multiplyTransposed(GT_, Eigen::Map<const Eigen::VectorXd>(data.getRawPtr(), data.size()));
  }
  return mine;
}

Eigen::MatrixXd NaturalCoarseSpace::applyG(const MultiVector& x) const {
  const Eigen::MatrixXd mine = partOfG(x);
  Eigen::MatrixXd sum(mine.rows(), mine.cols());
  Teuchos::reduceAll(*coarseMap_->getComm(), Teuchos::REDUCE_SUM, int(mine.size()), mine.data(), sum.data());
  return sum;
}

// y := alpha G^T a + beta y, on own rows: nothing is sent.
void NaturalCoarseSpace::applyGT(const Eigen::MatrixXd& a, MultiVector& y, double alpha, double beta) const {
  if (beta == 0.0) y.putScalar(0.0);
  else if (beta != 1.0) y.scale(beta);
  for (std::size_t v = 0; v < y.getNumVectors(); ++v) {
    const auto data = y.getDataNonConst(v);
    Eigen::Map<Eigen::VectorXd>(data.getRawPtr(), data.size()) += alpha * multiply(GT_, a.col(Eigen::Index(v)));
  }
}

void NaturalCoarseSpace::apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode, double alpha, double beta) const {
  const std::size_t columns = x.getNumVectors();
  if (mode == Teuchos::NO_TRANS) {
    const Eigen::MatrixXd g = applyG(x);
    if (beta == 0.0) y.putScalar(0.0);
    else y.scale(beta);
    for (std::size_t v = 0; v < columns; ++v) {
      const auto data = y.getDataNonConst(v);
      Eigen::Map<Eigen::VectorXd>(data.getRawPtr(), data.size()) += alpha * g.col(Eigen::Index(v));
    }
    return;
  }
  Eigen::MatrixXd a(GT_.cols(), Eigen::Index(columns));
  for (std::size_t v = 0; v < columns; ++v) {
    const auto data = x.getData(v);
    a.col(Eigen::Index(v)) = Eigen::Map<const Eigen::VectorXd>(data.getRawPtr(), data.size());
  }
  applyGT(a, y, alpha, beta);
}

// e = R^T f
Eigen::VectorXd NaturalCoarseSpace::restrictLoad(const MultiVector& f, const LocalSystems& systems) const {
  Eigen::VectorXd mine = Eigen::VectorXd::Zero(dimension()), sum(dimension());
  const auto data = f.getData(0);
  const auto& offsets = jump_->primalOffsets();
  for (int i = 0; i < systems.size(); ++i)
    mine.segment(columns_[std::size_t(i)], systems[i].R().cols()).noalias() =
        systems[i].R().transpose() * Eigen::Map<const Eigen::VectorXd>(data.getRawPtr() + offsets[i], systems[i].R().rows());
  Teuchos::reduceAll(*coarseMap_->getComm(), Teuchos::REDUCE_SUM, dimension(), mine.data(), sum.data());
  return sum;
}

// u += R a
void NaturalCoarseSpace::addRigidMotion(const Eigen::VectorXd& a, const LocalSystems& systems, MultiVector& u) const {
  const auto data = u.getDataNonConst(0);
  const auto& offsets = jump_->primalOffsets();
  for (int i = 0; i < systems.size(); ++i)
    Eigen::Map<Eigen::VectorXd>(data.getRawPtr() + offsets[i], systems[i].R().rows()).noalias() +=
        systems[i].R() * a.segment(columns_[std::size_t(i)], systems[i].R().cols());
}

}  // namespace Haptos
