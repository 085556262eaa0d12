// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ConePath.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

namespace Haptos {
namespace {

constexpr double kInside = 0.95;  // of the way to the boundary

double determinant(const Eigen::Vector3d& x) { return x[0] * x[0] - x.tail<2>().squaredNorm(); }
Eigen::Vector3d reflected(const Eigen::Vector3d& x) { return {x[0], -x[1], -x[2]}; }

// 2 x x^T - R, where det x = 1
Eigen::Matrix3d representation(const Eigen::Vector3d& x) {
  Eigen::Matrix3d P = 2 * x * x.transpose();
  P.diagonal() -= Eigen::Vector3d(1, -1, -1);
  return P;
}

// x o z = (x . z, x_0 z_T + z_0 x_T)
Eigen::Vector3d productOf(const Eigen::Vector3d& x, const Eigen::Vector3d& z) {
  Eigen::Vector3d product = x[0] * z + z[0] * x;
  product[0] = x.dot(z);
  return product;
}

// z with x o z = c
Eigen::Vector3d divided(const Eigen::Vector3d& c, const Eigen::Vector3d& x) {
  Eigen::Vector3d z;
  z[0] = reflected(x).dot(c) / determinant(x);
  z.tail<2>() = (c.tail<2>() - z[0] * x.tail<2>()) / x[0];
  return z;
}

// Largest t with x + t d in the cone: the smallest positive root of det(x + t d), or where the first component vanishes.
double wayToBoundary(const Eigen::Vector3d& x, const Eigen::Vector3d& d) {
  double t = std::numeric_limits<double>::infinity();
  const auto take = [&](double root) {
    if (root > 0) t = std::min(t, root);  // NaN is not
  };
  const double a = determinant(d), b = 2 * x.dot(reflected(d)), c = determinant(x), discriminant = b * b - 4 * a * c;
  if (discriminant >= 0) {
    const double q = -0.5 * (b + (b < 0 ? -1 : 1) * std::sqrt(discriminant));
    if (a != 0) take(q / a);
    if (q != 0) take(c / q);
  }
  if (d[0] < 0) take(-x[0] / d[0]);
  return t;
}

}  // namespace

bool ConePoint::isInside() const { return l[0] > 0 && y[0] > 0 && determinant(l) > 0 && determinant(y) > 0; }

// W = theta (2 w w^T - R), R = diag(1, -1, -1), theta^2 = det l / det y and w between the directions of l and R y; its root is that of theta
// times the same with (w + e) / sqrt(2 (w_0 + 1)) in the place of w.
void ConePoint::scale() {
  const double detL = std::sqrt(determinant(l)), detY = std::sqrt(determinant(y)), theta = detL / detY;
  const Eigen::Vector3d from = l / detL, to = y / detY;
  const Eigen::Vector3d w = (from + reflected(to)) / (2 * std::sqrt((1 + from.dot(to)) / 2));
  const Eigen::Vector3d v = (w + Eigen::Vector3d(1, 0, 0)) / std::sqrt(2 * (w[0] + 1));
  W = theta * representation(w);
  root = std::sqrt(theta) * representation(v);
  inverseRoot = representation(reflected(v)) / std::sqrt(theta);
}

// rest = - l + target y^-1,  y^-1 = R y / det y.
void ConePoint::aim(double target) { rest = -l + target / determinant(y) * reflected(y); }

// With x = W^1/2 y = W^-1/2 l the equation is  x o (W^-1/2 dl + W^1/2 dy) = target e - x o x - (W^-1/2 dl) o (W^1/2 dy).
void ConePoint::correct() { rest -= root * divided(productOf(inverseRoot * dl, root * dy), root * y); }

double ConePoint::longestStep() const { return std::min(1.0, kInside * std::min(wayToBoundary(l, dl), wayToBoundary(y, dy))); }

PairCones::PairCones(const PairLaw& pair, double force, double length)
    : hasNormal_(!pair.normalPinned), hasBall_(pair.law == FrictionLaw::Tresca && pair.frictional() && pair.slipForce > 0) {
  D_ << double(hasNormal_), 0, 0;
  const bool hasFriction = pair.frictional() && (pair.law == FrictionLaw::Tresca ? hasBall_ : hasNormal_);
  for (int t = 0; t < 2 && hasFriction; ++t) D_[1 + t] = pair.coefficients[t];
  inverseD_ = (D_.array() > 0).select(D_.cwiseInverse(), 0.0);
  normal_.l << force, 0, 0;
  normal_.y << length, 0, 0;
  ball_ = normal_;
  ball_.l[0] = pair.slipForce;
}

double PairCones::product() const { return (hasNormal_ ? normal_.l.dot(normal_.y) : 0.0) + (hasBall_ ? ball_.l.dot(ball_.y) : 0.0); }

// Components outside of the cones: (M d sigma) = - lambda.
void PairCones::linearize(const Eigen::Vector3d& lambda, const Eigen::Vector3d& s, SlipTerm slip) {
  K_.setZero();
  jumpChange_ = (hasBall_ ? Eigen::Vector3d(1, 0, 0) : D_).asDiagonal();
  const Eigen::Vector2d slips = jumpChange_.bottomRightCorner<2, 2>() * s.tail<2>();
  if (slip == SlipTerm::Derivative && slips.norm() > 0)
    jumpChange_.block<1, 2>(0, 1) = -slips.normalized().transpose() * jumpChange_.bottomRightCorner<2, 2>();
  known_ = (D_.array() > 0).select(Eigen::Vector3d::Zero(), -lambda);
  missing_ = jumpMissing_ = Eigen::Vector3d::Zero();
  linearizeCoulomb(lambda, s);
  if (hasBall_) linearizeBall(lambda, s);
}

// dl = D^-1 M dsigma + missing, dy = D' dsigma + jumpMissing: (M + D W D') dsigma = D (rest - missing - W jumpMissing), D' = D but for
// the derivative of |F s_T|.  Under Tresca's law tangential components are those of the ball, and of the normal cone l and y have the first
// one only.
void PairCones::linearizeCoulomb(const Eigen::Vector3d& lambda, const Eigen::Vector3d& s) {
  if (!hasNormal_) return;
  const Eigen::Vector3d D = normalD(), inverse = hasBall_ ? D : inverseD_;
  const Eigen::Vector3d jumps = -D.cwiseProduct(s);
  missing_ = inverse.cwiseProduct(lambda) - normal_.l;
  jumpMissing_ = jumps - normal_.y;
  jumpMissing_[0] += jumps.tail<2>().norm();
  normal_.scale();
  normal_.aim(0);
  K_ = D.asDiagonal() * normal_.W * jumpChange_;
  known_ -= D.cwiseProduct(missing_ + normal_.W * jumpMissing_);
}

// l_0 stays: the first row gives dy_0 = (rest_0 - W_0T dy_T) / W_00, and the others the Schur complement.
void PairCones::linearizeBall(const Eigen::Vector3d& lambda, const Eigen::Vector3d& s) {
  const Eigen::Vector2d D = D_.tail<2>();
  missing_.tail<2>() = inverseD_.tail<2>().cwiseProduct(lambda.tail<2>()) - ball_.l.tail<2>();
  jumpMissing_.tail<2>() = -D.cwiseProduct(s.tail<2>()) - ball_.y.tail<2>();
  ball_.scale();
  ball_.aim(0);
  K_.bottomRightCorner<2, 2>() = D.asDiagonal() * ball_.tangentialW() * D.asDiagonal();
  known_.tail<2>() -= D.cwiseProduct(missing_.tail<2>() + ball_.tangentialW() * jumpMissing_.tail<2>());
}

void PairCones::aim(double target) {
  if (hasNormal_) normal_.aim(target), normal_.correct();
  if (hasBall_) ball_.aim(target), ball_.correct();
}

Eigen::Vector3d PairCones::b() const {
  Eigen::Vector3d b = known_;
  if (hasNormal_) b += normalD().cwiseProduct(normal_.rest);
  if (hasBall_) b.tail<2>() += D_.tail<2>().cwiseProduct(ball_.rest.tail<2>() - ball_.coupling() * ball_.rest[0]);
  return b;
}

// l by W dy, not by M dsigma: what the linear solver leaves stays in the equation for forces, which the next step sees, and not in
// l . y, where a small coefficient would magnify it.
void PairCones::setStep(const Eigen::Vector3d& dSigma) {
  Eigen::Vector3d dy = D_.cwiseProduct(dSigma) + jumpMissing_;
  normal_.dy = hasBall_ ? Eigen::Vector3d(dy[0], 0, 0) : Eigen::Vector3d(jumpChange_ * dSigma + jumpMissing_);
  normal_.dl = normal_.rest - normal_.W * normal_.dy;
  if (!hasBall_) return;
  dy[0] = (ball_.rest[0] - ball_.W.block<1, 2>(0, 1).dot(dy.tail<2>().transpose())) / ball_.W(0, 0);
  ball_.dy = dy;
  ball_.dl = ball_.rest - ball_.W * dy;
  ball_.dl[0] = 0;  // but for round-off
}

double PairCones::longestStep() const {
  return std::min(hasNormal_ ? normal_.longestStep() : 1.0, hasBall_ ? ball_.longestStep() : 1.0);
}

void PairCones::advance(double t) {
  if (hasNormal_) normal_.advance(t);
  if (hasBall_) ball_.advance(t);
}

bool PairCones::isInside() const { return (!hasNormal_ || normal_.isInside()) && (!hasBall_ || ball_.isInside()); }

bool PairCones::hasLawOf(const PairCones& other) const {
  return hasNormal_ == other.hasNormal_ && hasBall_ == other.hasBall_ && D_ == other.D_ && (!hasBall_ || ball_.l[0] == other.ball_.l[0]);
}

namespace {

bool haveSameLaw(const DualVectors& vectors, const std::vector<PairCones>& a, const std::vector<PairCones>& b) {
  double different = 0;
  for (std::size_t i = 0; i < a.size(); ++i) different += !a[i].hasLawOf(b[i]);
  return vectors.sum(different) == 0;
}

// Mean length of forces and jumps over the pairs of all ranks.
Eigen::Vector2d meanSizes(const DualVectors& vectors, const Eigen::VectorXd& lambda, const Eigen::VectorXd& s) {
  Eigen::Vector3d sums(lambda.squaredNorm(), s.squaredNorm(), double(vectors.numPairs()));
  vectors.sum(sums);
  return (sums.head<2>() / std::max(1.0, sums[2])).cwiseSqrt();
}

}  // namespace

// All pairs on the way, at some forces and jumps.
class ConePath::Point {
 public:
  // From no start: every pair in the middle of its cones, of the mean sizes.
  Point(const std::vector<PairLaw>& pairs, const ContactMatrix& M, Eigen::VectorXd lambda, Eigen::VectorXd s)
      : M_(M), lambda_(std::move(lambda)), s_(std::move(s)) {
    const Eigen::Vector2d sizes = meanSizes(M.vectors(), lambda_, s_);
    for (const PairLaw& pair : pairs) cones_.emplace_back(pair, sizes[0] > 0 ? sizes[0] : 1.0, sizes[1] > 0 ? sizes[1] : 1.0);
  }
  Point(std::vector<PairCones> cones, const ContactMatrix& M, Eigen::VectorXd lambda, Eigen::VectorXd s)
      : M_(M), lambda_(std::move(lambda)), s_(std::move(s)), cones_(std::move(cones)) {}

  const std::vector<PairCones>& cones() const { return cones_; }
  const Eigen::VectorXd& s() const { return s_; }

  // mean of l . y
  double meanProduct() const {
    Eigen::Vector2d sums(0, 0);
    for (const PairCones& cones : cones_) sums += Eigen::Vector2d(cones.product(), cones.count());
    M_.vectors().sum(sums);
    return sums[0] / std::max(1.0, sums[1]);
  }

  // One step of Newton's method, the length of it that was taken, 0 where digits end: a first one to l . y = 0, which tells how far to go and
  // what the linear equations leave out (predictor and corrector [mehrotra-1992]), for one matrix.
  double step(Eigen::VectorXd& sigma, SlipTerm slip, const SubspaceNewtonOptions::Condensed& options) {
    if (!isInside()) return 0;
    const auto solve = solver(slip, options.pathLinearTolerance);
    takeStep(solve);
    const double part = std::max(options.pathFar, std::pow(1 - longestStep(), 3)), target = part * meanProduct();
    for (PairCones& cones : cones_) cones.aim(target);
    const Eigen::VectorXd d = takeStep(solve);
    const double t = longestStep();
    for (PairCones& cones : cones_) cones.advance(t);
    sigma += t * d;
    lambda_ += t * M_.multiply(d);
    s_ -= t * d;
    return t;
  }

 private:
  using Solver = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

  // Round-off puts points that have no digits left on the boundary of their cones, where there is no scaling.
  bool isInside() const {
    double outside = 0;
    for (const PairCones& cones : cones_) outside += !cones.isInside();
    return M_.vectors().sum(outside) == 0;
  }

  // d sigma for b: the matrix at these forces and jumps
  Solver solver(SlipTerm slip, double tolerance) {
    ContactMatrix::Blocks K;
    for (std::size_t i = 0; i < cones_.size(); ++i) {
      const Eigen::Index at = 3 * Eigen::Index(i);
      cones_[i].linearize(lambda_.segment<3>(at), s_.segment<3>(at), slip);
      K.push_back(cones_[i].K());
    }
    if (slip == SlipTerm::Value) return [system = std::make_shared<ContactMatrix::Symmetric>(M_, std::move(K))](const auto& b) { return system->solve(b); };
    const ContactMatrix::Blocks one(K.size(), Eigen::Matrix3d::Identity());
    return [this, tolerance, one, K = std::move(K)](const auto& b) { return M_.solve(one, K, b, tolerance); };
  }

  Eigen::VectorXd takeStep(const Solver& solve) {
    Eigen::VectorXd b(lambda_.size());
    for (std::size_t i = 0; i < cones_.size(); ++i) b.segment<3>(3 * Eigen::Index(i)) = cones_[i].b();
    const Eigen::VectorXd d = solve(b);
    for (std::size_t i = 0; i < cones_.size(); ++i) cones_[i].setStep(d.segment<3>(3 * Eigen::Index(i)));
    return d;
  }

  double longestStep() const {
    double mine = 1, t = 1;
    for (const PairCones& cones : cones_) mine = std::min(mine, cones.longestStep());
    Teuchos::reduceAll(M_.vectors().comm(), Teuchos::REDUCE_MIN, mine, Teuchos::outArg(t));
    return t;
  }

  const ContactMatrix& M_;
  Eigen::VectorXd lambda_, s_;  // of the day
  std::vector<PairCones> cones_;
};

// The last stage whose jumps leave no more of today's law than twice what it left of its own; -1: none.
int ConePath::lastStage(const Start& start, const Residual& residual) const {
  const Point today(start.pairs, start.M, start.lambda, start.s);
  if (stages_.empty() || !haveSameLaw(start.M.vectors(), today.cones(), stages_.front().cones)) return -1;
  int k = int(stages_.size()) - 1;
  while (k >= 0 && !(residual(start.s - stages_[std::size_t(k)].s) <= options_.stageGrowth * stages_[std::size_t(k)].norm)) --k;
  return k;
}

// From no start, how far bodies were moved, which M does not feel, is left behind: it would be no measure of jumps.
Eigen::VectorXd ConePath::follow(const Start& start, const Residual& residual, double target, bool fromStages) {
  const int k = fromStages ? lastStage(start, residual) : -1;
  const Eigen::VectorXd sigma = k < 0 ? start.M.kernelPart(start.s) : Eigen::VectorXd(start.s - stages_[std::size_t(k)].s);
  std::vector<PairCones> cones = k < 0 ? Point(start.pairs, start.M, start.lambda, start.s - sigma).cones() : std::move(stages_[std::size_t(k)].cones);
  stages_.resize(std::size_t(std::max(k, 0)));
  const Point point(std::move(cones), start.M, k < 0 ? start.lambda : start.lambda + start.M.multiply(sigma), start.s - sigma);
  return walk(point, sigma, start, residual, {target, k < 0 ? options_.pathSteps : options_.stagePatience});
}

// Where steps are short a stage was no good start for this model.  Where long ones leave much of the law it is |F s_T| that lags behind: from
// there with its derivative, for which the matrix is not symmetric.
Eigen::VectorXd ConePath::walk(Point point, Eigen::VectorXd sigma, const Start& start, const Residual& residual, const End& end) {
  Eigen::VectorXd best = sigma;
  SlipTerm slip = start.slip;
  int creeping = 0, lagging = 0;
  double norm = residual(sigma), least = norm;
  std::vector<double> leasts;
  for (int step = 0; step < options_.pathSteps && least > end.target; ++step) {
    stages_.push_back({point.cones(), point.s(), norm});
    const double t = point.step(sigma, slip, options_), before = std::exchange(norm, residual(sigma));
    if (!std::isfinite(norm) || t < options_.pathShortest) break;
    if (norm < least) least = norm, best = sigma;
    leasts.push_back(least);
    if (step >= options_.pathStall && least > options_.pathStalls * leasts[std::size_t(step - options_.pathStall)]) break;
    creeping = t < options_.pathCreeps ? creeping + 1 : 0;
    if (creeping >= end.patience) break;
    lagging = t > options_.pathLong && norm > options_.pathLags * before ? lagging + 1 : 0;
    if (lagging >= options_.pathPatience) slip = SlipTerm::Derivative;
  }
  return best;
}

}  // namespace Haptos
