// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_DependentUnknowns.hpp"

#include <Eigen/OrderingMethods>
#include <Teuchos_Assert.hpp>
#include <algorithm>
#include <cmath>
#include <map>

#include "Haptos_DenseDecompositions.hpp"

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

  std::size_t met(int i) const { return rows_[std::size_t(i)].size(); }  ///< entries of a row

  /// \brief Between these, [unknowns]^2, in their scale.
  Eigen::MatrixXd dense(const std::vector<int>& unknowns) const {
    Eigen::MatrixXd S = Eigen::MatrixXd::Zero(Eigen::Index(unknowns.size()), Eigen::Index(unknowns.size()));
    std::map<int, Eigen::Index> places;
    for (std::size_t p = 0; p < unknowns.size(); ++p) places.emplace(unknowns[p], Eigen::Index(p));
    for (const int i : unknowns)
      for (const auto& [j, a] : rows_[std::size_t(i)])
        if (!isEmpty(j)) S(places.at(i), places.at(j)) = a / std::sqrt(diagonal_[i] * diagonal_[j]);
    return S;
  }

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

// Once a row meets half of what is left, the rest goes in one piece.
std::vector<int> dependentOfRest(const Remainder& remainder, const std::vector<int>& rest, double tolerance) {
  const PivotedCholesky factor(remainder.dense(rest), tolerance);
  std::vector<char> isKept(rest.size(), 0);
  for (const int pivot : factor.pivots()) isKept[std::size_t(pivot)] = 1;
  std::vector<int> dependent;
  for (std::size_t p = 0; p < rest.size(); ++p)
    if (!isKept[p]) dependent.push_back(rest[p]);
  std::sort(dependent.begin(), dependent.end());
  return dependent;
}

}  // namespace

std::vector<int> dependentUnknowns(const Eigen::SparseMatrix<double>& A, double tolerance) {
  constexpr double kWaits = 0.1;  // of the largest pivot
  TEUCHOS_ASSERT(A.rows() == A.cols());
  Remainder remainder(A);
  std::vector<int> waiting = minimumDegree(A);
  waiting.erase(std::remove_if(waiting.begin(), waiting.end(), [&](int i) { return remainder.isEmpty(i); }), waiting.end());
  while (!waiting.empty()) {
    double largest = 0;
    for (const int i : waiting) largest = std::max(largest, remainder.pivot(i));
    if (largest <= tolerance) break;
    std::vector<int> later;
    for (std::size_t next = 0; next < waiting.size(); ++next) {
      const int i = waiting[next];
      if (remainder.pivot(i) < kWaits * largest) {
        later.push_back(i);
        continue;
      }
      if (2 * remainder.met(i) > later.size() + waiting.size() - next) {
        later.insert(later.end(), waiting.begin() + std::ptrdiff_t(next), waiting.end());
        return dependentOfRest(remainder, later, tolerance);
      }
      remainder.eliminate(i);
    }
    waiting = std::move(later);
  }
  std::sort(waiting.begin(), waiting.end());
  return waiting;
}

}  // namespace Haptos
