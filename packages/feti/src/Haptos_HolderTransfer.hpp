// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <vector>

#include "Haptos_Types_fwd.hpp"

namespace Haptos {

/// \brief Values that go to the ranks that hold factors of them, and back.
class HolderTransfer {
 public:
  /// \brief Global numbers of what is sent here, and of what is held.
  struct Ends {
    std::vector<int> mine;                ///< places among a rank's own values
    std::vector<GlobalOrdinal> from, to;  ///< of `mine`; of what this rank holds, in the order in which it keeps it
  };

  HolderTransfer() = default;
  /// Collective.
  HolderTransfer(const Ends& ends, const RCP<const Communicator>& comm);

  /// \brief [own values x any] to the holders, [held x any].  Collective.
  Eigen::MatrixXd gather(const Eigen::MatrixXd& own) const;
  /// \brief And back: a value may have gone to one holder only, so nothing is added.  Collective.
  void scatter(const Eigen::MatrixXd& values, Eigen::MatrixXd& own) const;

 private:
  std::vector<int> mine_;
  std::vector<int> held_;  // on one rank: where its values are among its own
  RCP<const Map> from_, to_;
  RCP<const Tpetra::Import<>> there_, back_;
};

}  // namespace Haptos
