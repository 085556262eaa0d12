// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DependentUnknowns.hpp"

#include <Eigen/OrderingMethods>
#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <map>

namespace Haptos {
namespace {

// What is left of A while unknowns are eliminated one by one.
class Remainder {
 public:
  explicit Remainder(const Eigen::SparseMatrix<double>& A) : rows_(std::size_t(A.rows())), diagonal_(A.diagonal()) {
    for (int j = 0; j < A.outerSize(); ++j)
      for (Eigen::SparseMatrix<double>::InnerIterator it(A, j); it; ++it) rows_[std::size_t(it.row())][j] = it.value();
  }

  bool isEmpty(int i) const { return !(diagonal_[i] > 0); }
  double pivot(int i) const { return rows_[std::size_t(i)].at(i) / diagonal_[i]; }  // of what it was

  void eliminate(int i) {
    std::map<int, double> row = std::move(rows_[std::size_t(i)]);
    const double inverse = 1 / row.at(i);
    row.erase(i);
    for (const auto& [j, a] : row) {
      auto& other = rows_[std::size_t(j)];
      other.erase(i);
      for (const auto& [k, b] : row) other[k] -= inverse * a * b;
    }
  }

 private:
  std::vector<std::map<int, double>> rows_;
  Eigen::VectorXd diagonal_;
};

std::vector<int> minimumDegree(const Eigen::SparseMatrix<double>& A) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(A, order);
  return {order.indices().data(), order.indices().data() + order.size()};
}

}  // namespace

std::vector<int> dependentUnknowns(const Eigen::SparseMatrix<double>& A, double tolerance) {
  constexpr double kWaits = 0.1;  // of the largest pivot
  TEUCHOS_ASSERT(A.rows() == A.cols());
  Remainder remainder(A);
  std::vector<int> waiting = minimumDegree(A), later;
  waiting.erase(std::remove_if(waiting.begin(), waiting.end(), [&](int i) { return remainder.isEmpty(i); }), waiting.end());
  for (; !waiting.empty(); waiting.swap(later), later.clear()) {
    double largest = 0;
    for (const int i : waiting) largest = std::max(largest, remainder.pivot(i));
    if (largest <= tolerance) break;
    for (const int i : waiting)
      if (remainder.pivot(i) >= kWaits * largest) remainder.eliminate(i);
      else later.push_back(i);
  }
  std::sort(waiting.begin(), waiting.end());
  return waiting;
}

}  // namespace Haptos
