// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <vector>

namespace Haptos {

/// \brief Some vectors side by side, row by row in memory, that are zero but in a few rows, which are known: motions of a few subdomains, and what
/// they do to the rows of B.
class RowPanel {
 public:
  static constexpr int kColumns = 32;

  explicit RowPanel(std::size_t rows) : values_(rows * kColumns, 0.0), isFilled_(rows, 0) {}

  std::size_t rows() const { return isFilled_.size(); }
  const double* operator[](std::size_t row) const { return values_.data() + row * kColumns; }
  /// \brief A row to be written, which counts as filled from here on.
  double* fill(std::size_t row) {
    if (!isFilled_[row]) filled_.push_back(int(row)), isFilled_[row] = 1;
    return values_.data() + row * kColumns;
  }
  /// \brief All rows, to be written where `fillIfAny` is called then.
  double* data() { return values_.data(); }
  void fillIfAny(std::size_t row) {
    const double* values = (*this)[row];
    if (!isFilled_[row] && std::any_of(values, values + kColumns, [](double value) { return value != 0; })) fill(row);
  }
  const std::vector<int>& filled() const { return filled_; }  ///< rows, in the order in which they came

  /// \brief Of the columns, [kColumns].
  Eigen::VectorXd squares() const {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(kColumns);
    for (const int row : filled_) sums += Eigen::Map<const Eigen::VectorXd>((*this)[std::size_t(row)], kColumns).cwiseAbs2();
    return sums;
  }

  void clear() {
    for (const int row : filled_) std::fill_n(values_.data() + std::size_t(row) * kColumns, kColumns, 0.0), isFilled_[std::size_t(row)] = 0;
    filled_.clear();
  }

 private:
  std::vector<double> values_;
  std::vector<char> isFilled_;
  std::vector<int> filled_;
};

}  // namespace Haptos
