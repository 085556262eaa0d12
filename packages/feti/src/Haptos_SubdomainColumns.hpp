// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <memory>
#include <vector>

#include "Haptos_RowPanel.hpp"

namespace Haptos {

/// \brief A matrix A [local primal unknowns x n] whose columns are motions or forces of a few subdomains each, on their boundaries: dense
/// blocks of unknowns of one subdomain and of columns that are not zero there.
///
/// A sparse matrix takes four times as long for a product where subdomains are slender, and tens of times for a Gram matrix.
/// Columns are numbered alike on all ranks, rows are this rank's.  No function communicates.
class SubdomainColumns {
 public:
  using Values = Eigen::Ref<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;             ///< [local primal unknowns x any]
  using ConstValues = Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

  /// \param unknowns [local subdomains] local primal unknowns of the boundary, ascending
  explicit SubdomainColumns(std::vector<std::vector<Eigen::Index>> unknowns);
  SubdomainColumns(const SubdomainColumns&) = delete;

  /// \brief What some columns are on one local subdomain.
  struct Piece {
    std::size_t subdomain;
    std::vector<Eigen::Index> rows;     ///< among its unknowns, ascending
    std::vector<Eigen::Index> columns;  ///< of those that are appended, ascending
    Eigen::MatrixXd values;             ///< [rows x columns]
  };
  /// \brief Appends `width` columns, which are 0 but in these pieces, one a subdomain.
  void append(Eigen::Index width, const std::vector<Piece>& pieces);
  /// \brief On a local subdomain this matrix is the other one, now and later: what is appended to it there is not looked at.
  void share(std::size_t subdomain, const SubdomainColumns& other) { parts_[subdomain] = other.parts_[subdomain], isShared_[subdomain] = 1; }

  Eigen::Index cols() const { return cols_; }
  std::size_t numBlocks(std::size_t subdomain) const { return parts_[subdomain]->size(); }  ///< that products take one after the other
  /// \brief t := A(:, first + 0, 1, ...), `width` of them; t is empty before, and has the subdomains' unknowns one after another.
  void copyTo(Eigen::Index first, Eigen::Index width, RowPanel& t) const;
  /// \brief A^T t [n x columns of t]
  Eigen::MatrixXd transposedTimes(const ConstValues& t) const;
  /// \brief t := t - A a, a [n x columns of t]
  void subtractProduct(const Eigen::MatrixXd& a, Values t) const;
  /// \brief A^T C [n x columns of C], this rank's part of it
  Eigen::MatrixXd gram(const SubdomainColumns& C) const;
  /// \brief The unknowns of one local subdomain of X - A a [boundary unknowns x columns of X], a [n x columns of X].
  Eigen::MatrixXd rest(std::size_t subdomain, const SubdomainColumns& X, const Eigen::MatrixXd& a) const;
  /// \brief M := M + T^T C T of one local subdomain, T = X - A a, with C symmetric there; C A, C X and a [n x columns of X] given, M of X's columns.
  ///
  /// Where X is 0 only the columns of A that reach the subdomain count, not its unknowns.
  void addEnergy(std::size_t subdomain, const SubdomainColumns& CA, const SubdomainColumns& X, const SubdomainColumns& CX, const Eigen::MatrixXd& a,
                 Eigen::MatrixXd& M) const;

 private:
  // Motions of one subdomain reach the same unknowns of a neighbour: they make one block.
  struct Block {
    std::vector<Eigen::Index> rows;     // among the subdomain's unknowns, ascending
    std::vector<Eigen::Index> columns;  // ascending
    std::vector<double> values;         // [rows x columns], column after column: it grows
    bool take(const std::vector<Eigen::Index>& more);
    Eigen::Map<const Eigen::MatrixXd> matrix() const { return {values.data(), Eigen::Index(rows.size()), Eigen::Index(columns.size())}; }
  };
  using Part = std::vector<Block>;
  std::vector<Eigen::Index> columnsOf(std::size_t subdomain) const;
  Eigen::MatrixXd dense(std::size_t subdomain, const std::vector<Eigen::Index>& columns) const;

  void appendColumn(const Piece& piece, Eigen::Index j, double negligible);

  std::vector<std::vector<Eigen::Index>> unknowns_;
  std::vector<std::shared_ptr<Part>> parts_;  // [local subdomains]
  std::vector<char> isShared_;                // [local subdomains] belongs to another matrix
  Eigen::Index cols_ = 0;
};

}  // namespace Haptos
