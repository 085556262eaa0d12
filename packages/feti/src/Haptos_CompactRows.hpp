// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "Haptos_MultiplierMap.hpp"

namespace Haptos {

/// \brief V B^T between some rows and a compact vector of some unknowns of this rank's subdomains, V diagonal.
class CompactRows {
 public:
  /// \param isKept [overlap rows], the same on all ranks that have a row
  /// \param size of the compact vector
  /// \param place (global subdomain of this rank, local dof) -> position in it, negative: none
  /// \param scale V of an entry.  Collective.
  CompactRows(const MultiplierMap& multipliers, const std::vector<char>& isKept, Eigen::Index size,
              const std::function<Eigen::Index(int subdomain, int dof)>& place,
              const std::function<double(const MultiplierMap::OverlapEntry&)>& scale);

  /// \brief The rank's own kept rows, ascending.
  const std::vector<int>& rows() const { return rows_; }
  Eigen::Index size() const { return size_; }  ///< of the compact vector
  /// \brief t := V B^T x; x [rows()], t [size].  Collective: one Import.
  Eigen::VectorXd spread(const Eigen::VectorXd& x) const;
  /// \brief y := B V t; t [size], y [rows()].  Collective: one Export.
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
