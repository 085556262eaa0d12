// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ConjugateDirections.hpp"

#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_Vector.hpp>
#include <cmath>
#include <vector>

namespace {

using namespace Haptos;

constexpr int kRows = 23;

// F = diag(1, 4, 9, ...) + 1 1^T
void multiply(const Vector& x, Vector& y) {
  const Vector one = [&] {
    Vector v(x.getMap());
    v.putScalar(1.0);
    return v;
  }();
  const double sum = one.dot(x);
  const auto from = x.getData(0);
  const auto to = y.getDataNonConst(0);
  for (Teuchos::Ordinal i = 0; i < from.size(); ++i) {
    const double k = double(x.getMap()->getGlobalElement(int(i)) + 1);
    to[i] = k * k * from[i] + sum;
  }
}

Vector numbers(const RCP<const Map>& map, int seed) {
  Vector v(map);
  const auto data = v.getDataNonConst(0);
  for (Teuchos::Ordinal i = 0; i < data.size(); ++i) data[i] = std::sin(1.0 + 1.7 * double(map->getGlobalElement(int(i))) * double(seed + 1) + double(seed));
  return v;
}

// As many as there are rows solve F lambda = b at once; those that are beyond what is kept are the caller's.
TEUCHOS_UNIT_TEST(ConjugateDirections, AreConjugateAndKnowTheAnswer) {
  const auto map = Teuchos::rcp(new Map(Tpetra::global_size_t(kRows), 0, Tpetra::getDefaultComm()));
  ConjugateDirections directions(*map, kRows);
  std::vector<RCP<Vector>> p, Fp;
  for (int k = 0; k < kRows; ++k) {
    TEST_EQUALITY(directions.isFull(), false);
    p.push_back(Teuchos::rcp(new Vector(numbers(map, k), Teuchos::Copy)));
    Fp.push_back(Teuchos::rcp(new Vector(map)));
    for (int pass = 0; pass < 2; ++pass) directions.makeConjugate(*p.back());
    multiply(*p.back(), *Fp.back());
    directions.append(*p.back(), *Fp.back(), p.back()->dot(*Fp.back()));
  }
  TEST_ASSERT(directions.isFull());
  for (int i = 0; i < kRows; ++i)
    for (int j = 0; j < i; ++j)
      TEST_COMPARE(std::abs(p[std::size_t(i)]->dot(*Fp[std::size_t(j)])), <,
                   1e-9 * std::sqrt(p[std::size_t(i)]->dot(*Fp[std::size_t(i)]) * p[std::size_t(j)]->dot(*Fp[std::size_t(j)])));
  Vector lambda(map), r = numbers(map, kRows), product(map);
  const Vector b(r, Teuchos::Copy);
  directions.step(lambda, r);
  multiply(lambda, product);
  product.update(-1.0, b, 1.0);
  TEST_COMPARE(product.norm2(), <, 1e-9 * b.norm2());
  TEST_COMPARE(r.norm2(), <, 1e-9 * b.norm2());
}

// None change nothing.
TEUCHOS_UNIT_TEST(ConjugateDirections, NoneLeaveVectorsAsTheyAre) {
  const auto map = Teuchos::rcp(new Map(Tpetra::global_size_t(kRows), 0, Tpetra::getDefaultComm()));
  const ConjugateDirections none(*map, 0);
  TEST_ASSERT(none.isFull());
  Vector z = numbers(map, 1), lambda(map), r = numbers(map, 2);
  none.makeConjugate(z);
  none.step(lambda, r);
  z.update(-1.0, numbers(map, 1), 1.0);
  r.update(-1.0, numbers(map, 2), 1.0);
  TEST_EQUALITY(z.norm2() + r.norm2() + lambda.norm2(), 0.0);
}

}  // namespace
