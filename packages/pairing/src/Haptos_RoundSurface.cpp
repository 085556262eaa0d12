// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RoundSurface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "Haptos_DenseDecompositions.hpp"
#include "Haptos_InputCheck.hpp"

namespace Haptos {
namespace {

using Eigen::Matrix3d, Eigen::MatrixXd, Eigen::Vector3d, Eigen::VectorXd;

Vector3d vectorOf(const std::array<double, 3>& a) { return {a[0], a[1], a[2]}; }
std::array<double, 3> arrayOf(const Vector3d& a) { return {a[0], a[1], a[2]}; }

// Nodes about their mean, in units of the largest distance from it.
struct Cloud {
  MatrixXd points;  // [n x 3]
  Vector3d mean;
  double size;
};

Cloud cloudOf(const ContactSurface& surface) {
  Cloud cloud{MatrixXd(surface.numNodes(), 3), Vector3d::Zero(), 0};
  for (std::size_t i = 0; i < surface.numNodes(); ++i) cloud.points.row(Eigen::Index(i)) = vectorOf(surface.coordinates[i]).transpose();
  cloud.mean = cloud.points.colwise().mean().transpose();
  cloud.points.rowwise() -= cloud.mean.transpose();
  cloud.size = cloud.points.rowwise().norm().maxCoeff();
  cloud.points /= cloud.size;
  return cloud;
}

Vector3d leastOrthogonal(const ContactSurface& surface) {
  Matrix3d sum = Matrix3d::Zero();
  for (std::size_t i = 0; i < surface.numNodes(); ++i) sum += surface.areas[i] * vectorOf(surface.normals[i]) * vectorOf(surface.normals[i]).transpose();
  return SymmetricEigen3(sum).vectors.col(0);
}

// What moves in a fit: centre, axis (of a cylinder) and radius, each step orthogonal to the axis.
struct Shape {
  bool isCylinder;
  Vector3d centre = Vector3d::Zero(), axis = Vector3d::Zero();
  double radius = 0;

  Vector3d fromAxis(const Vector3d& x) const { return x - centre - axis * axis.dot(x - centre); }
  MatrixXd basis() const {  // [3 x 2 or 3] directions in which the centre moves
    if (!isCylinder) return Matrix3d::Identity();
    const Vector3d e = axis.unitOrthogonal();
    MatrixXd E(3, 2);
    E << e, axis.cross(e);
    return E;
  }
};

// |x|^2 = 2 x . p + (R^2 - p^2), linear in p and the bracket.
void startFrom(const MatrixXd& points, Shape& shape) {
  const MatrixXd E = shape.basis(), y = points * E;
  MatrixXd A(points.rows(), E.cols() + 1);
  A << 2 * y, VectorXd::Ones(points.rows());
  const VectorXd solution = solveByPivotedQr(A, y.rowwise().squaredNorm());
  const VectorXd p = solution.head(E.cols());
  shape.centre = E * p;
  shape.radius = std::sqrt(std::max(0.0, solution[E.cols()] + p.squaredNorm()));
}

VectorXd distancesFrom(const MatrixXd& points, const Shape& shape) {
  VectorXd r(points.rows());
  for (Eigen::Index i = 0; i < points.rows(); ++i) r[i] = shape.fromAxis(points.row(i).transpose()).norm() - shape.radius;
  return r;
}

// r = |w| - R, w = (1 - a a^T) (x - p):  dr = - u . dp - (u . da) (a . (x - p)) - dR,  u = w / |w|.
void improve(const MatrixXd& points, Shape& shape) {
  constexpr int kMostSteps = 100;
  constexpr double kSettled = 1e-15;
  for (int step = 0; step < kMostSteps; ++step) {
    const MatrixXd E = shape.basis();
    const Eigen::Index m = E.cols(), turns = shape.isCylinder ? 2 : 0;
    MatrixXd J(points.rows(), m + turns + 1);
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      const Vector3d x = points.row(i).transpose(), u = shape.fromAxis(x).normalized();
      J.row(i).head(m) = -u.transpose() * E;
      if (turns > 0) J.row(i).segment(m, turns) = -shape.axis.dot(x - shape.centre) * u.transpose() * E;
      J(i, m + turns) = -1;
    }
    const VectorXd move = -solveByPivotedQr(J, distancesFrom(points, shape));
    if (!move.allFinite()) return;
    shape.centre += E * move.head(m);
    if (turns > 0) shape.axis = (shape.axis + E * move.segment(m, turns)).normalized();
    shape.radius += move[m + turns];
    if (move.norm() < kSettled * (1 + shape.radius)) return;
  }
}

RoundSurface fit(const ContactSurface& surface, Shape shape) {
  constexpr double kFlat = 1e4;      // radius in the size of the surface
  constexpr double kFarthest = 0.25;  // of the element size
  const Cloud cloud = cloudOf(surface);
  startFrom(cloud.points, shape);
  improve(cloud.points, shape);
  const double misfit = cloud.size * distancesFrom(cloud.points, shape).cwiseAbs().maxCoeff();
  const double size = std::accumulate(surface.sizes.begin(), surface.sizes.end(), 0.0) / double(surface.numNodes());
  const std::string what = shape.isCylinder ? "cylinder" : "sphere";
  HAPTOS_REFUSE_IF(!(shape.radius > 0 && shape.radius < kFlat), "Side set '" << surface.name << "': Primary Smoothing cannot fit a " << what
                                                                             << " to it, as it is flat; take None.");
  HAPTOS_REFUSE_IF(!(misfit <= kFarthest * size), "Side set '" << surface.name << "': its nodes lie off the " << what << " that fits them best, of radius "
                                                               << cloud.size * shape.radius << ", by up to " << misfit
                                                               << ", more than a quarter of the element size; take Primary Smoothing None or Nagata.");
  RoundSurface round{arrayOf(cloud.mean + cloud.size * shape.centre), {}, cloud.size * shape.radius, misfit};
  if (shape.isCylinder) round.axis = arrayOf(shape.axis);
  return round;
}

}  // namespace

RoundSurface fitCylinder(const ContactSurface& surface) {
  Shape shape{true};
  shape.axis = leastOrthogonal(surface);
  return fit(surface, shape);
}

RoundSurface fitSphere(const ContactSurface& surface) { return fit(surface, Shape{false}); }

// |w + g m| = R, w and m the parts of x - centre and n across the axis.
std::optional<double> distanceAlong(const RoundSurface& round, const std::array<double, 3>& x, const std::array<double, 3>& n, double guess) {
  Vector3d w = vectorOf(x) - vectorOf(round.centre), m = vectorOf(n);
  if (round.axis) {
    const Vector3d a = vectorOf(*round.axis);
    w -= a * a.dot(w);
    m -= a * a.dot(m);
  }
  const double A = m.squaredNorm(), B = w.dot(m), C = (w.norm() - round.radius) * (w.norm() + round.radius);
  const double root = B * B - A * C;
  if (!(root >= 0 && A > 0)) return {};
  const double q = -(B + std::copysign(std::sqrt(root), B));
  const double first = q / A, second = q == 0 ? first : C / q;
  return std::abs(first - guess) < std::abs(second - guess) ? first : second;
}

}  // namespace Haptos
