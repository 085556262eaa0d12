// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <vector>

namespace Haptos {

/// \brief A supernodal Cholesky factor as a direct solver hands it over: A(perm, perm) = L L^T.
///
/// Supernode k has the columns [super[k], super[k+1]) and, in its dense column-major block at x + px[k], the rows
/// s[pi[k]] ... s[pi[k+1]], of which the first are its own columns.
struct SupernodeView {
  int n, supernodes;
  const int *super, *pi, *px, *s, *perm;
  const double* x;
};

/// \brief Where a supernode's parts begin in the arrays of a SupernodalFactor.
///
/// The triangle is stored by columns from the diagonal down, the diagonal as its reciprocal; then the rectangle by columns of
/// `storedRows`, those beyond `rowsBelow` being zeros that fill the last register.
struct Supernode {
  int first, columns, rowsBelow, storedRows;
  std::size_t triangle, rectangle, rows;
};

/// \brief Its own copy of such a factor, without the zeros above the diagonal, for solves at the speed of the memory.
///
/// One right-hand side reads L once forward and finds it in the cache on the way back where a subdomain's factor fits;
/// many go through BLAS 3.  In single precision half the bytes; entries and right-hand sides are scaled, so that the range
/// does not depend on the units.  Solving needs no workspace kept between calls: threads may solve at once.
template <class Scalar>
class SupernodalFactor {
 public:
  SupernodalFactor() = default;
  explicit SupernodalFactor(const SupernodeView& view);

  /// \brief X := A^-1 B, both [n x m].  They must not overlap.
  void solve(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::Ref<Eigen::MatrixXd> X) const;

  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
  static constexpr int kPadding = 32 / int(sizeof(Scalar));  ///< rows of zeros that the halves want behind their vectors

  /// \name The halves of a solve, X [n + kPadding x m] in the order of L.
  ///
  /// L may lack its last columns: those unknowns are then only taken off or put in.
  /// @{
  void forward(Matrix& X) const;   ///< X := L^-1 X
  void backward(Matrix& X) const;  ///< X := L^-T X
  /// @}

  /// \brief Lower triangle of S := S - B^T A^-1 B, B [n x m], S [m x m]: half a solve, of a column only where it is not zero.
  void subtractGram(const Eigen::SparseMatrix<double>& B, Eigen::MatrixXd& S) const;

  Eigen::Index rows() const { return Eigen::Index(perm_.size()); }
  std::size_t entries() const { return std::size_t(entries_.size()); }

 private:
  std::vector<Scalar> workspace() const { return std::vector<Scalar>(std::size_t(largest_) + 1); }
  Matrix triangleOf(const Supernode& node) const;
  void append(const Supernode& node, const double* block);
  void solveTriangle(const Supernode& node, Scalar* X, int leading, int m) const;
  void multiplyRectangle(const Supernode& node, const Scalar* X, int leading, int m, Scalar* below, int leadingBelow) const;
  class Gram;

  std::vector<int> perm_;
  std::vector<Supernode> nodes_;
  std::vector<int> rowsBelow_;
  Eigen::Array<Scalar, Eigen::Dynamic, 1> entries_;  // of all supernodes, in the order of a solve
  int largest_ = 0;  // stored rows of any supernode
  double scale_ = 1;  // of L
};

extern template class SupernodalFactor<double>;
extern template class SupernodalFactor<float>;

}  // namespace Haptos
