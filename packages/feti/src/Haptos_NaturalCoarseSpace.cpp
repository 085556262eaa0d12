// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NaturalCoarseSpace.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <array>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

constexpr int kModes = 6;

using Values = std::array<double, kModes>;

// One row of G^T restricted to one subdomain, for the rank that owns the row.
struct Piece {
  GlobalOrdinal row;
  int subdomain;
  Values values;
};

// visit(row of the overlap map, subdomain, values) for B R of this rank's subdomains; entries come sorted by subdomain and row.
template <class Visit>
void forEachPiece(const MultiplierMap& multipliers, const LocalSystems& systems, int firstSubdomain, Visit&& visit) {
  const auto& entries = multipliers.overlapEntries();
  for (std::size_t k = 0; k < entries.size();) {
    const int row = entries[k].row, subdomain = entries[k].subdomain;
    const Eigen::MatrixXd& R = systems[subdomain - firstSubdomain].R();
    Values values{};
    for (; k < entries.size() && entries[k].row == row && entries[k].subdomain == subdomain; ++k)
      for (int m = 0; m < kModes; ++m) values[m] += entries[k].value * R(entries[k].dof, m);
    visit(row, subdomain, values);
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

  void announce(int row) { ++next_[std::size_t(row) + 1]; }
  void allocate(CoarseRows& GT) {
    GT_ = &GT;
    for (std::size_t i = 1; i < next_.size(); ++i) next_[i] += next_[i - 1];
    GT.resizeNonZeros(Eigen::Index(kModes) * next_.back());
    for (std::size_t i = 0; i < next_.size(); ++i) GT.outerIndexPtr()[i] = kModes * next_[i];
  }
  // Pieces of a row lie in ascending order of subdomains.
  void add(int row, int subdomain, const Values& values) {
    int at = kModes * next_[std::size_t(row)]++;
    for (; at > GT_->outerIndexPtr()[row] && GT_->innerIndexPtr()[at - kModes] > kModes * subdomain; at -= kModes) {
      std::copy_n(GT_->innerIndexPtr() + at - kModes, kModes, GT_->innerIndexPtr() + at);
      std::copy_n(GT_->valuePtr() + at - kModes, kModes, GT_->valuePtr() + at);
    }
    for (int m = 0; m < kModes; ++m) {
      GT_->innerIndexPtr()[at + m] = kModes * subdomain + m;
      GT_->valuePtr()[at + m] = values[m];
    }
  }

 private:
  CoarseRows* GT_ = nullptr;
  std::vector<int> next_;  // [rows + 1] pieces before a row, later before the next piece of it
};

std::vector<Piece> exchangePieces(const Communicator& comm, const std::vector<std::vector<Piece>>& outgoing) {
  std::vector<Bytes> messages;
  for (const auto& part : outgoing) {
    ByteWriter writer;
    writer.write(part);
    messages.push_back(writer.take());
  }
  std::vector<Piece> result;
  for (const auto& message : exchangeAll(comm, messages)) {
    const auto part = ByteReader(message).readVector<Piece>();
    result.insert(result.end(), part.begin(), part.end());
  }
  return result;
}

}  // namespace

NaturalCoarseSpace::NaturalCoarseSpace(RCP<const JumpOperator> jump, const LocalSystems& systems, int numSubdomains)
    : jump_(std::move(jump)) {
  const auto& multipliers = jump_->multipliers();
  const auto& map = *multipliers.map();
  const auto& overlap = *multipliers.overlapMap();
  const auto& comm = *map.getComm();
  coarseMap_ = Teuchos::rcp(new Map(kModes * std::size_t(numSubdomains), 0, map.getComm(), Tpetra::LocallyReplicated));
  const auto owners = ownersOf(multipliers);
  const auto ownRow = [&](int row) { return map.getLocalElement(overlap.getGlobalElement(row)); };
  const auto forEach = [&](auto&& visit) { forEachPiece(multipliers, systems, jump_->firstSubdomain(), visit); };

  RowBuilder builder(localNumElements(map));
  std::vector<std::vector<Piece>> outgoing(std::size_t(comm.getSize()));
  forEach([&](int row, int subdomain, const Values& values) {
    if (owners[std::size_t(row)] == comm.getRank()) builder.announce(ownRow(row));
    else outgoing[std::size_t(owners[std::size_t(row)])].push_back({overlap.getGlobalElement(row), subdomain, values});
  });
  const auto received = exchangePieces(comm, outgoing);
  for (const auto& piece : received) builder.announce(map.getLocalElement(piece.row));
  GT_.resize(Eigen::Index(localNumElements(map)), kModes * Eigen::Index(numSubdomains));
  builder.allocate(GT_);
  forEach([&](int row, int subdomain, const Values& values) {
    if (owners[std::size_t(row)] == comm.getRank()) builder.add(ownRow(row), subdomain, values);
  });
  for (const auto& piece : received) builder.add(map.getLocalElement(piece.row), piece.subdomain, piece.values);
}

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

Eigen::VectorXd NaturalCoarseSpace::restrictLoad(const MultiVector& f, const LocalSystems& systems) const {
  Eigen::VectorXd mine = Eigen::VectorXd::Zero(dimension()), sum(dimension());
  const auto data = f.getData(0);
  const auto& offsets = jump_->primalOffsets();
  for (int i = 0; i < systems.size(); ++i)
    mine.segment(kModes * (jump_->firstSubdomain() + i), kModes).noalias() =
        systems[i].R().transpose() * Eigen::Map<const Eigen::VectorXd>(data.getRawPtr() + offsets[i], systems[i].R().rows());
  Teuchos::reduceAll(*coarseMap_->getComm(), Teuchos::REDUCE_SUM, dimension(), mine.data(), sum.data());
  return sum;
}

void NaturalCoarseSpace::addRigidMotion(const Eigen::VectorXd& a, const LocalSystems& systems, MultiVector& u) const {
  const auto data = u.getDataNonConst(0);
  const auto& offsets = jump_->primalOffsets();
  for (int i = 0; i < systems.size(); ++i)
    Eigen::Map<Eigen::VectorXd>(data.getRawPtr() + offsets[i], systems[i].R().rows()).noalias() +=
        systems[i].R() * a.segment(kModes * (jump_->firstSubdomain() + i), kModes);
}

}  // namespace Haptos
