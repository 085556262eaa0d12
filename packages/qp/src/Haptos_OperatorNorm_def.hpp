// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <type_traits>
#include <utility>
#include <vector>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_OperatorNorm.hpp"
#include "Haptos_VectorDetails.hpp"

namespace Haptos {
namespace Details {

template <class Scalar, class MV>
void fillStartVector(MV& v) {
  if constexpr (std::is_same_v<MV, MultiVector>)
    fillFromGlobalIndices(v);
  else
    Belos::MultiVecTraits<Scalar, MV>::MvRandom(v);
}

/// Largest Ritz value and the norm of its residual, from the Lanczos coefficients.
inline std::pair<double, double> largestRitzValue(const std::vector<double>& alpha, const std::vector<double>& beta) {
  const Eigen::Index k = Eigen::Index(alpha.size());
  Eigen::MatrixXd t = Eigen::MatrixXd::Zero(k, k);
  for (Eigen::Index i = 0; i < k; ++i) {
    t(i, i) = alpha[i];
    if (i + 1 < k) t(i, i + 1) = t(i + 1, i) = beta[i];
  }
  const SymmetricEigen eigen(t);
  return {eigen.values[k - 1], std::abs(beta[k - 1] * eigen.vectors(k - 1, k - 1))};
}

}  // namespace Details

template <class Scalar, class MV, class OP>
OperatorNorm estimateOperatorNorm(const QuadraticProgram<Scalar, MV, OP>& problem, int maxApplications) {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  const RCP<const MV> like = problem.getRHS();
  const RCP<MV> w = MVT::Clone(*like, 1), q = MVT::Clone(*like, 1);
  std::vector<RCP<MV>> v{MVT::Clone(*like, 1)};
  std::vector<double> alpha, beta;
  OperatorNorm result;

  Details::fillStartVector<Scalar>(*v[0]);
  Scalar length = Details::norm<Scalar>(*v[0]);
  while (result.applications < maxApplications && length > 0) {
    MVT::MvScale(*v.back(), 1 / length);
    problem.applyHessian(*v.back(), *w, *q);
    if (result.applications++ == 0 && problem.hasEquality()) {
      problem.applyEqualityProjector(*w, *q);
      result.decoupled = Details::norm<Scalar>(*q) <= 1e-8 * Details::norm<Scalar>(*w);
    }
    const Scalar size = Details::norm<Scalar>(*w);
    alpha.push_back(Details::dot<Scalar>(*v.back(), *w));
    for (int pass = 0; pass < 2; ++pass)
      for (const RCP<MV>& u : v) Details::add<Scalar>(*w, -Details::dot<Scalar>(*u, *w), *u);
    length = Details::norm<Scalar>(*w);
    if (length <= 1e-12 * size) length = 0;  // the Krylov space is exhausted: theta is exact
    beta.push_back(length);
    const auto [theta, residual] = Details::largestRitzValue(alpha, beta);
    result.value = theta + residual;
    if (residual <= 0.02 * theta) break;
    v.push_back(MVT::CloneCopy(*w));
  }
  return result;
}

}  // namespace Haptos
