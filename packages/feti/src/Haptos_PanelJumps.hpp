// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "Haptos_RowPanel.hpp"
#include "Haptos_SubdomainColumns.hpp"
#include "Haptos_Types_fwd.hpp"

namespace Haptos {

class DualPreconditioner;

/// \brief B_D of a `DualPreconditioner` on vectors of the boundaries of a few subdomains: the price is that of the rows that they touch, where
/// `DualPreconditioner` takes all.
///
/// A panel of primal vectors has the boundary unknowns of this rank's subdomains one after another, in the order of `SurfaceOperators::boundary`.
/// Its columns are the same on all ranks.  What is done to them is Collective: rows that ranks share are sent, all columns together.
class PanelJumps {
 public:
  explicit PanelJumps(const DualPreconditioner& M);

  std::size_t first(std::size_t subdomain) const { return first_[subdomain]; }  ///< of a local subdomain's unknowns; [local subdomains + 1]
  std::size_t size() const { return first_.back(); }

  /// \brief What is filled of the first `width` columns, subdomain by subdomain; nothing communicates.
  std::vector<SubdomainColumns::Piece> piecesOf(const RowPanel& t, int width) const;

  /// \brief t := t - B_D^T B t, as `DualPreconditioner::average`.
  void average(RowPanel& t);
  /// \brief t := B_D^T of unit vectors, t empty before; (owned row, column), of this rank.
  void spread(const std::vector<std::array<int, 2>>& units, RowPanel& t);
  /// \brief y := B_D t on some owned rows, y [rows x any], the first columns of the panel.
  void collect(const RowPanel& t, const std::vector<int>& rows, Eigen::Ref<Eigen::MatrixXd> y);

 private:
  // One nonzero of B, beside others of its unknown, or of its row.
  struct Entry {
    int at;  // row of `overlapMap`, or unknown
    double value;
  };
  enum class Weighted { Yes, No };
  void takeJumps(const RowPanel& t, Weighted weighted);
  void addSpread(double factor, RowPanel& t) const;
  void toOwners();
  void fromOwners();
  void solveGram();

  const DualPreconditioner& M_;
  std::vector<std::size_t> first_;
  std::vector<double> weights_;                       // [boundary unknowns] W, 0 where B has no entry
  std::vector<std::size_t> firstOfUnknown_, firstOfRow_;  // CSR both ways
  std::vector<Entry> ofUnknowns_, ofRows_;
  RowPanel y_;                                        // [overlap rows]
  RCP<MultiVector> own_, remote_;                     // of rows that ranks share; null on a rank alone
};

}  // namespace Haptos
