// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_HolderTransfer.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>

#include "Haptos_RemoteRows.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {

HolderTransfer::HolderTransfer(const Ends& ends, const RCP<const Communicator>& comm)
    : mine_(ends.mine), from_(mapOf(ends.from, comm)), to_(mapOf(ends.to, comm)), there_(Teuchos::rcp(new Tpetra::Import<>(from_, to_))),
      back_(Teuchos::rcp(new Tpetra::Import<>(to_, from_))) {
  if (comm->getSize() > 1) return;
  for (const GlobalOrdinal value : ends.to) held_.push_back(ends.mine[std::size_t(from_->getLocalElement(value))]);
}

Eigen::MatrixXd HolderTransfer::gather(const Eigen::MatrixXd& own) const {
  if (from_->getComm()->getSize() == 1) return own(held_, Eigen::all);
  MultiVector source(from_, std::size_t(own.cols()), false), target(to_, std::size_t(own.cols()));
  for (Eigen::Index j = 0; j < own.cols(); ++j) {
    const auto data = source.getDataNonConst(std::size_t(j));
    for (std::size_t i = 0; i < mine_.size(); ++i) data[Teuchos_Ordinal(i)] = own(mine_[i], j);
  }
  target.doImport(source, *there_, Tpetra::INSERT);
  Eigen::MatrixXd values(Eigen::Index(target.getLocalLength()), own.cols());
  for (Eigen::Index j = 0; j < own.cols(); ++j) {
    const auto data = target.getData(std::size_t(j));
    std::copy(data.begin(), data.end(), values.col(j).data());
  }
  return values;
}

void HolderTransfer::scatter(const Eigen::MatrixXd& values, Eigen::MatrixXd& own) const {
  if (from_->getComm()->getSize() == 1) {
    own(held_, Eigen::all) = values;
    return;
  }
  MultiVector source(to_, std::size_t(own.cols()), false), target(from_, std::size_t(own.cols()));
  for (Eigen::Index j = 0; j < own.cols(); ++j) {
    const auto data = source.getDataNonConst(std::size_t(j));
    std::copy(values.col(j).data(), values.col(j).data() + values.rows(), data.begin());
  }
  target.doImport(source, *back_, Tpetra::INSERT);
  for (Eigen::Index j = 0; j < own.cols(); ++j) {
    const auto data = target.getData(std::size_t(j));
    for (std::size_t i = 0; i < mine_.size(); ++i) own(mine_[i], j) = data[Teuchos_Ordinal(i)];
  }
}

}  // namespace Haptos
