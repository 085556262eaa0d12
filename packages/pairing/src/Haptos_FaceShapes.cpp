// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_FaceShapes.hpp"

#include <algorithm>
#include <cmath>

namespace Haptos {
namespace {

// Where the nodes of squares are, as -1, 0, 1.
constexpr std::array<std::array<int, 2>, 9> kPlaces = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, 0}}};

struct Value {
  double f, slope;
};

Value linear(int place, double s) { return {0.5 * (1 + place * s), 0.5 * place}; }
Value quadratic(int place, double s) {
  return place == 0 ? Value{1 - s * s, -2 * s} : Value{0.5 * s * (s + place), s + 0.5 * place};
}

template <class Line>
FaceValues products(int numNodes, const Point2& at, Line&& line) {
  FaceValues v;
  for (std::size_t i = 0; i < std::size_t(numNodes); ++i) {
    const Value a = line(kPlaces[i][0], at[0]), b = line(kPlaces[i][1], at[1]);
    v.N[i] = a.f * b.f;
    v.dXi[i] = a.slope * b.f;
    v.dEta[i] = a.f * b.slope;
  }
  return v;
}

// Serendipity: at the centre  -1/4 sum of corners + 1/2 sum of middles.
FaceValues serendipity(const Point2& at) {
  FaceValues v = products(9, at, quadratic);
  for (auto* f : {&v.N, &v.dXi, &v.dEta}) {
    for (std::size_t i = 0; i < 8; ++i) (*f)[i] += (i < 4 ? -0.25 : 0.5) * (*f)[8];
    (*f)[8] = 0;
  }
  return v;
}

FaceValues triangle(int numNodes, const Point2& at) {
  const std::array<double, 3> L = {1 - at[0] - at[1], at[0], at[1]};
  constexpr std::array<double, 3> dXi = {-1, 1, 0}, dEta = {-1, 0, 1};
  if (numNodes == 3) return {{L[0], L[1], L[2]}, {-1, 1, 0}, {-1, 0, 1}};
  FaceValues v;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, m = 3 + i;
    v.N[i] = L[i] * (2 * L[i] - 1);
    v.dXi[i] = (4 * L[i] - 1) * dXi[i];
    v.dEta[i] = (4 * L[i] - 1) * dEta[i];
    v.N[m] = 4 * L[i] * L[j];
    v.dXi[m] = 4 * (dXi[i] * L[j] + L[i] * dXi[j]);
    v.dEta[m] = 4 * (dEta[i] * L[j] + L[i] * dEta[j]);
  }
  return v;
}

}  // namespace

Point2 nodeOfFace(int numNodes, int node) {
  constexpr std::array<Point2, 6> kOfTriangle = {{{0, 0}, {1, 0}, {0, 1}, {0.5, 0}, {0.5, 0.5}, {0, 0.5}}};
  const auto i = std::size_t(node);
  return isTriangle(numNodes) ? kOfTriangle[i] : Point2{double(kPlaces[i][0]), double(kPlaces[i][1])};
}

FaceValues faceValues(int numNodes, const Point2& at) {
  if (isTriangle(numNodes)) return triangle(numNodes, at);
  if (numNodes == 8) return serendipity(at);
  return numNodes == 4 ? products(4, at, linear) : products(9, at, quadratic);
}

double distanceOutside(int numNodes, const Point2& at) {
  if (isTriangle(numNodes)) return std::max({-at[0], -at[1], at[0] + at[1] - 1});
  return 0.5 * (std::max(std::abs(at[0]), std::abs(at[1])) - 1);
}

std::optional<Point2> referencePoint(int numNodes, const std::array<Point2, 9>& x, const Point2& target) {
  constexpr int kMostSteps = 40;
  constexpr double kSettled = 1e-9;  // the step after it would be of its square
  const double low = isTriangle(numNodes) ? -0.3 : -1.3, high = 1.3;
  Point2 at = isTriangle(numNodes) ? Point2{1.0 / 3, 1.0 / 3} : Point2{0, 0};
  for (int step = 0; step < kMostSteps; ++step) {
    const FaceValues v = faceValues(numNodes, at);
    Point2 r = target, a{}, b{};
    for (std::size_t i = 0; i < std::size_t(numNodes); ++i)
      for (std::size_t c = 0; c < 2; ++c) {
        r[c] -= v.N[i] * x[i][c];
        a[c] += v.dXi[i] * x[i][c];
        b[c] += v.dEta[i] * x[i][c];
      }
    const double det = a[0] * b[1] - a[1] * b[0];
    if (!(std::abs(det) > 0)) return {};
    const Point2 move = {(r[0] * b[1] - r[1] * b[0]) / det, (a[0] * r[1] - a[1] * r[0]) / det};
    const Point2 from = at;
    for (std::size_t c = 0; c < 2; ++c) at[c] = std::min(high, std::max(low, at[c] + move[c]));
    if (std::max(std::abs(move[0]), std::abs(move[1])) < kSettled) return at;
    if (at == from) return {};  // beyond the limits
  }
  return {};
}

}  // namespace Haptos
