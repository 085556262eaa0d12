// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ConjugateDirections.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <algorithm>
#include <cmath>

#include "Haptos_DualVectors.hpp"
#include "Haptos_Reductions.hpp"
#include "Haptos_TpetraCompat.hpp"

namespace Haptos {
namespace {

// x := x + A y
void addTo(Vector& x, const ColumnBlocks& A, const Eigen::VectorXd& y) {
  Eigen::VectorXd values = DualVectors::fromVector(x);
  A.addProduct(y, values);
  const auto data = x.getDataNonConst(0);
  std::copy(values.begin(), values.end(), data.begin());
}

}  // namespace

ConjugateDirections::ConjugateDirections(const Map& map, long most)
    : most_(most), P_(Eigen::Index(localNumElements(map))), FP_(Eigen::Index(localNumElements(map))) {}

void ConjugateDirections::append(const Vector& p, const Vector& Fp, double pFp) {
  P_.append(DualVectors::fromVector(p) / std::sqrt(pFp));
  FP_.append(DualVectors::fromVector(Fp) / std::sqrt(pFp));
}

void ConjugateDirections::makeConjugate(Vector& z) const {
  if (size() == 0) return;
  addTo(z, P_, -sumOfAll(*z.getMap()->getComm(), FP_.transposedTimes(DualVectors::fromVector(z))));
}

void ConjugateDirections::step(Vector& lambda, Vector& r) const {
  if (size() == 0) return;
  const Eigen::VectorXd t = sumOfAll(*r.getMap()->getComm(), P_.transposedTimes(DualVectors::fromVector(r)));
  addTo(lambda, P_, t);
  addTo(r, FP_, -t);
}

}  // namespace Haptos
