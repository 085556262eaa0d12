// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NaturalCoarseSpace.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

#include "Haptos_ByteBuffer.hpp"
#include "Haptos_Exchange.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

constexpr int kModes = 6;

// One row of G^T restricted to one subdomain.
struct Piece {
  GlobalOrdinal row;
  int subdomain;
  double values[kModes];
};

// B R of this rank's subdomains, row by row (entries come sorted by subdomain and row).
std::vector<Piece> localPieces(const MultiplierMap& multipliers, const LocalSystems& systems, int firstSubdomain) {
  std::vector<Piece> pieces;
  for (const auto& entry : multipliers.overlapEntries()) {
    const GlobalOrdinal row = multipliers.overlapMap()->getGlobalElement(entry.row);
    if (pieces.empty() || pieces.back().row != row || pieces.back().subdomain != entry.subdomain)
      pieces.push_back({row, entry.subdomain, {}});
    const Eigen::MatrixXd& R = systems[entry.subdomain - firstSubdomain].R;
    for (int m = 0; m < kModes; ++m) pieces.back().values[m] += entry.value * R(entry.dof, m);
  }
  return pieces;
}

std::vector<Piece> sendToOwners(const MultiplierMap& multipliers, const std::vector<Piece>& pieces) {
  const auto comm = multipliers.map()->getComm();
  // Every row once: Tpetra 13.2's directory leaves the second of two equal indices without an answer.
  const auto rows = localElementList(*multipliers.overlapMap());
  std::vector<int> ranks(rows.size());
  multipliers.map()->getRemoteIndexList(rows, Teuchos::ArrayView<int>(ranks.data(), ranks.size()));
  std::vector<std::vector<Piece>> outgoing(comm->getSize());
  for (const auto& piece : pieces) outgoing[ranks[multipliers.overlapMap()->getLocalElement(piece.row)]].push_back(piece);
  std::vector<Bytes> messages;
  for (const auto& part : outgoing) {
    ByteWriter writer;
    writer.write(part);
    messages.push_back(writer.take());
  }
  std::vector<Piece> result;
  for (const auto& message : exchangeAll(*comm, messages)) {
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
  coarseMap_ = Teuchos::rcp(new Map(kModes * std::size_t(numSubdomains), 0, map.getComm(), Tpetra::LocallyReplicated));
  std::vector<Eigen::Triplet<double>> triplets;
  for (const auto& piece : sendToOwners(multipliers, localPieces(multipliers, systems, jump_->firstSubdomain())))
    for (int m = 0; m < kModes; ++m)
      triplets.emplace_back(map.getLocalElement(piece.row), kModes * piece.subdomain + m, piece.values[m]);
  GT_.resize(Eigen::Index(localNumElements(map)), kModes * Eigen::Index(numSubdomains));
  GT_.setFromTriplets(triplets.begin(), triplets.end());
}

Eigen::MatrixXd NaturalCoarseSpace::partOfG(const MultiVector& x) const {
  Eigen::MatrixXd mine(GT_.cols(), Eigen::Index(x.getNumVectors()));
  for (std::size_t v = 0; v < x.getNumVectors(); ++v) {
    const auto data = x.getData(v);
    mine.col(Eigen::Index(v)).noalias() = GT_.transpose() * Eigen::Map<const Eigen::VectorXd>(data.getRawPtr(), data.size());
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
    Eigen::Map<Eigen::VectorXd>(data.getRawPtr(), data.size()).noalias() += alpha * (GT_ * a.col(Eigen::Index(v)));
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
        systems[i].R.transpose() * Eigen::Map<const Eigen::VectorXd>(data.getRawPtr() + offsets[i], systems[i].R.rows());
  Teuchos::reduceAll(*coarseMap_->getComm(), Teuchos::REDUCE_SUM, dimension(), mine.data(), sum.data());
  return sum;
}

void NaturalCoarseSpace::addRigidMotion(const Eigen::VectorXd& a, const LocalSystems& systems, MultiVector& u) const {
  const auto data = u.getDataNonConst(0);
  const auto& offsets = jump_->primalOffsets();
  for (int i = 0; i < systems.size(); ++i)
    Eigen::Map<Eigen::VectorXd>(data.getRawPtr() + offsets[i], systems[i].R.rows()).noalias() +=
        systems[i].R * a.segment(kModes * (jump_->firstSubdomain() + i), kModes);
}

}  // namespace Haptos
