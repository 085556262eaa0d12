// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <BelosMultiVecTraits.hpp>
#include <cmath>
#include <vector>

namespace Haptos {
namespace Details {

/// \brief a^T b of the only columns of two vectors.  Collective.
template <class Scalar, class MV>
Scalar dot(const MV& a, const MV& b) {
  std::vector<Scalar> result(1);
  Belos::MultiVecTraits<Scalar, MV>::MvDot(a, b, result);
  return result[0];
}

/// \brief Euclidean norm of the only column.  Collective.
template <class Scalar, class MV>
Scalar norm(const MV& a) {
  return std::sqrt(dot<Scalar>(a, a));
}

/// \brief y := y + s a.
template <class Scalar, class MV>
void add(MV& y, Scalar s, const MV& a) {
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1, y, s, a, y);
}

/// \brief y := a.
template <class Scalar, class MV>
void copy(const MV& a, MV& y) {
  Belos::MultiVecTraits<Scalar, MV>::MvAddMv(1, a, 0, a, y);
}

}  // namespace Details
}  // namespace Haptos
