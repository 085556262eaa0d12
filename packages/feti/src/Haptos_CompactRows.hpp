// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// \brief W B^T between some rows and a compact vector of some unknowns of this rank's subdomains.
class CompactRows {
 public:
  /// \param isKept [overlap rows], the same on all ranks that have a row
  /// \param size of the compact vector
  /// \param place (global subdomain of this rank, local dof) -> position in it, negative: none.  Collective.
  CompactRows(const MultiplierMap& multipliers, const std::vector<char>& isKept, Eigen::Index size,
              const std::function<Eigen::Index(int subdomain, int dof)>& place);

  /// \brief The rank's own kept rows, ascending.
  const std::vector<int>& rows() const { return rows_; }
  /// \brief t := W B^T x; x [rows()], t [size].  Collective: one Import.
  Eigen::VectorXd spread(const Eigen::VectorXd& x) const;
  /// \brief y := B W t; t [size], y [rows()].  Collective: one Export.
  Eigen::VectorXd collect(const Eigen::VectorXd& t) const;

 private:
  // One nonzero: the rank's own rows come first.
  struct Entry {
    int row;
    int position;
    double value;
  };

  std::vector<int> rows_;
  std::unique_ptr<const RemoteRows> remote_;
  std::vector<Entry> entries_;
  Eigen::Index size_;
};

}  // namespace Haptos
