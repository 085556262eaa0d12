// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "Haptos_NodeNeighbours.hpp"
#include "Haptos_PartShape.hpp"
#include "Haptos_StiffnessAssembler.hpp"

namespace Haptos::Testing {

using Place = std::function<Eigen::Vector3d(double, double, double)>;

// A cube of n elements, put in place; on request its ends along the first direction are one.
struct Part {
  Coordinates coordinates;
  std::vector<ElementGroup> groups = std::vector<ElementGroup>(1);

  Part(const std::array<int, 3>& n, const Place& place, bool closes = false) {
    const int columns = closes ? n[0] : n[0] + 1;
    const auto number = [&](int i, int j, int k) { return (i % columns * (n[1] + 1) + j) * (n[2] + 1) + k; };
    for (int i = 0; i < columns; ++i)
      for (int j = 0; j <= n[1]; ++j)
        for (int k = 0; k <= n[2]; ++k) {
          const Eigen::Vector3d x = place(double(i) / n[0], double(j) / n[1], double(k) / n[2]);
          coordinates.push_back({x[0], x[1], x[2]});
        }
    for (int i = 0; i < n[0]; ++i)
      for (int j = 0; j < n[1]; ++j)
        for (int k = 0; k < n[2]; ++k)
          for (const auto& [a, b, c] : {std::array{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}})
            groups[0].connectivity.push_back(number(i + a, j + b, k + c));
  }
  IndexLists neighbours() const { return nodeNeighbours(int(coordinates.size()), groups); }
  double aspect(bool knowsElements = true) const {
    PartVolume volume;
    if (knowsElements) nodalStiffness(coordinates, groups, {1.0}, &volume);
    return aspectOfPart(coordinates, neighbours(), volume);
  }
};

inline Place box(double a, double b, double c) {
  return [=](double u, double v, double w) { return Eigen::Vector3d(a * u, b * v, c * w); };
}

inline Place pipe(double angle, double thickness) {
  return [=](double u, double v, double w) {
    const double r = 1 + thickness * w;
    return Eigen::Vector3d(r * std::cos(angle * u), -0.5 * v, r * std::sin(angle * u));
  };
}

}  // namespace Haptos::Testing
