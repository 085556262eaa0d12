// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_BoundEllipseSet.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "Haptos_EllipseProjection.hpp"
#include "Haptos_Error.hpp"

namespace Haptos {
namespace {

using Point = std::array<double, 2>;
using Ellipse = BoundEllipseSet::Ellipse;

Point relativeToCentre(const double* x, const Ellipse& e) {
  return {x[e.rows[0]] - e.centre[0], x[e.rows[1]] - e.centre[1]};
}

bool hasInterior(const Ellipse& e) { return e.semiAxes[0] > 0 && e.semiAxes[1] > 0; }

/// A point that a projection put on the boundary, up to the rounding of its entries (on either side).
bool isStillOnBoundary(const Point& y, const Ellipse& e) {
  long double level = 0;
  for (int k = 0; k < 2; ++k)
    if (e.semiAxes[k] > 0) {
      const long double u = static_cast<long double>(y[k]) / e.semiAxes[k];
      level += u * u;
    }
  // y + centre rounds in the unit of the centre, hence the second term
  double rounding = 8;
  for (int k = 0; k < 2; ++k)
    if (e.semiAxes[k] > 0) rounding += 4 * std::abs(e.centre[k]) / e.semiAxes[k];
  return std::abs(level - 1) <= rounding * std::numeric_limits<double>::epsilon();
}

/// The largest t with |(y - t p) / a| <= 1, entries with a = 0 being fixed.
double largestStepInEllipse(const Point& y, const Point& p, const Ellipse& e) {
  long double qq = 0, uq = 0, room = 1;
  for (int k = 0; k < 2; ++k) {
    if (!(e.semiAxes[k] > 0)) continue;
    const long double u = static_cast<long double>(y[k]) / e.semiAxes[k];
    const long double q = static_cast<long double>(p[k]) / e.semiAxes[k];
    qq += q * q;
    uq += u * q;
    room -= u * u;
  }
  // A step along fixed entries alone, or none: it never leaves.
  if (!(qq > 0)) return std::numeric_limits<double>::infinity();
  room = std::max(room, 0.0L);
  const long double root = std::sqrt(uq * uq + qq * room);
  return double(uq > 0 ? (uq + root) / qq : (root > uq ? room / (root - uq) : 0.0L));  // no cancellation
}

}  // namespace

BoundEllipseSet::BoundEllipseSet(const RCP<const Map>& map, std::vector<Bound> bounds, std::vector<Ellipse> ellipses,
                                 std::vector<int> pinnedRows)
    : map_(map),
      bounds_(std::move(bounds)),
      ellipses_(std::move(ellipses)),
      pinned_(std::move(pinnedRows)),
      boundActive_(bounds_.size(), 0),
      ellipseActive_(ellipses_.size(), 0) {
  std::string message = checkRows();
  for (const Ellipse& e : ellipses_)
    if (message.empty()) message = checkSemiAxes(e.rows, e.semiAxes);
  throwOnAllRanks(*map_->getComm(), message);
}

// Every row is in one bound, ellipse or pin at most: projections of rows are then independent of each other.
std::string BoundEllipseSet::checkRows() const {
  std::vector<int> rows = pinned_;
  for (const Bound& b : bounds_) rows.push_back(b.row);
  for (const Ellipse& e : ellipses_) rows.insert(rows.end(), e.rows.begin(), e.rows.end());
  std::vector<char> seen;
  std::ostringstream os;
  for (const int row : rows) {
    if (row < 0 || !map_->isNodeLocalElement(row))
      os << "BoundEllipseSet: local row " << row << " is not on this rank; rows are numbered from 0 on each rank.";
    else {
      if (seen.size() <= std::size_t(row)) seen.resize(row + 1, 0);
      if (seen[row]++) os << "BoundEllipseSet: local row " << row << " is constrained twice; each row may be in one "
                          << "bound, ellipse or pin only.";
    }
    if (!os.str().empty()) return os.str();
  }
  for (const Bound& b : bounds_)
    if (!(b.lower < std::numeric_limits<double>::infinity())) {
      os << "BoundEllipseSet: the lower bound of local row " << b.row << " is " << b.lower
         << "; it must be a number or -infinity.";
      return os.str();
    }
  return {};
}

// Empty if they are good.
std::string BoundEllipseSet::checkSemiAxes(const std::array<int, 2>& rows, const std::array<double, 2>& semiAxes) {
  for (const double a : semiAxes)
    if (!(a >= 0.0) || std::isinf(a)) {
      std::ostringstream os;
      os << "BoundEllipseSet: semi-axis " << a << " of local rows (" << rows[0] << ", " << rows[1]
         << ") must be finite and >= 0; is the slip bound of the Tresca step negative?";
      return os.str();
    }
  return {};
}

// What is on a boundary stays on it: scaled with its ellipse, axis by axis.
void BoundEllipseSet::setSemiAxes(const std::vector<std::array<double, 2>>& semiAxes, MultiVector* x) {
  std::string message;
  if (semiAxes.size() != ellipses_.size())
    message = "BoundEllipseSet::setSemiAxes: got " + std::to_string(semiAxes.size()) + " pairs for " +
              std::to_string(ellipses_.size()) + " ellipses.";
  for (std::size_t i = 0; i < semiAxes.size() && message.empty(); ++i)
    message = checkSemiAxes(ellipses_[i].rows, semiAxes[i]);
  throwOnAllRanks(*map_->getComm(), message);

  if (x != nullptr) {
    auto view = x->getDataNonConst(0);
    for (std::size_t i = 0; i < ellipses_.size(); ++i) {
      const Ellipse& e = ellipses_[i];
      for (int k = 0; k < 2 && ellipseActive_[i]; ++k)
        if (e.semiAxes[k] > 0)
          view[e.rows[k]] = e.centre[k] + (view[e.rows[k]] - e.centre[k]) * (semiAxes[i][k] / e.semiAxes[k]);
    }
  }
  for (std::size_t i = 0; i < ellipses_.size(); ++i) ellipses_[i].semiAxes = semiAxes[i];
}

// Also notes what is active: decided here and by no distance afterwards.
void BoundEllipseSet::project(MultiVector& x) {
  auto view = x.getDataNonConst(0);
  for (const int row : pinned_) view[row] = 0.0;
  for (std::size_t i = 0; i < bounds_.size(); ++i) {
    double& xi = view[bounds_[i].row];
    boundActive_[i] = xi <= bounds_[i].lower;
    if (boundActive_[i]) xi = bounds_[i].lower;
  }
  for (std::size_t i = 0; i < ellipses_.size(); ++i) {
    const Ellipse& e = ellipses_[i];
    const Point y = relativeToCentre(view.getRawPtr(), e);
    if (ellipseActive_[i] && hasInterior(e) && isStillOnBoundary(y, e)) continue;  // what stays keeps its bits
    bool moved = false;
    const Point p = projectOntoEllipse(y, e.semiAxes, moved);
    ellipseActive_[i] = moved || (ellipseActive_[i] && isStillOnBoundary(y, e));
    for (int k = 0; k < 2; ++k)
      if (p[k] != y[k]) view[e.rows[k]] = e.centre[k] + p[k];
  }
}

// x - t p: active rows move with their face or not at all, so they set no limit.
double BoundEllipseSet::maxFeasibleStep(const MultiVector& x, const MultiVector& p) const {
  const auto xv = x.getData(0), pv = p.getData(0);
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < bounds_.size(); ++i) {
    const int row = bounds_[i].row;
    // x - t p: only a positive p goes down to the bound.
    if (!boundActive_[i] && pv[row] > 0)
      step = std::min(step, std::max(0.0, (xv[row] - bounds_[i].lower) / pv[row]));
  }
  for (std::size_t i = 0; i < ellipses_.size(); ++i) {
    const Ellipse& e = ellipses_[i];
    if (ellipseActive_[i]) continue;
    step = std::min(step, largestStepInEllipse(relativeToCentre(xv.getRawPtr(), e), {pv[e.rows[0]], pv[e.rows[1]]}, e));
  }
  // One step for all ranks: the shortest that anyone allows.
  double global = 0;
  Teuchos::reduceAll(*map_->getComm(), Teuchos::REDUCE_MIN, step, Teuchos::outArg(global));
  return global;
}

// phi = g on free rows; phi~ there and beta on active ones are (x - P(x - alpha g)) / alpha, for a bound min(g, (x - l) / alpha).
void BoundEllipseSet::splitGradient(const MultiVector& x, const MultiVector& g, double alphaBar, MultiVector& phi,
                                    MultiVector& phiR, MultiVector& beta) const {
  Tpetra::deep_copy(phi, g);
  Tpetra::deep_copy(phiR, g);
  beta.putScalar(0.0);
  const auto xv = x.getData(0), gv = g.getData(0);
  auto phiv = phi.getDataNonConst(0), reducedv = phiR.getDataNonConst(0), betav = beta.getDataNonConst(0);

  for (const int row : pinned_) phiv[row] = reducedv[row] = 0.0;
  for (std::size_t i = 0; i < bounds_.size(); ++i) {
    const int row = bounds_[i].row;
    const double reduced = std::min(gv[row], (xv[row] - bounds_[i].lower) / alphaBar);
    if (!boundActive_[i]) {
      reducedv[row] = reduced;
    } else {
      betav[row] = reduced;
      phiv[row] = reducedv[row] = 0.0;
    }
  }
  for (std::size_t i = 0; i < ellipses_.size(); ++i) {
    const Ellipse& e = ellipses_[i];
    const Point y = relativeToCentre(xv.getRawPtr(), e);
    bool moved = false;
    const Point p = projectOntoEllipse({y[0] - alphaBar * gv[e.rows[0]], y[1] - alphaBar * gv[e.rows[1]]}, e.semiAxes,
                                       moved);
    for (int k = 0; k < 2; ++k) {
      const int row = e.rows[k];
      const double reduced = moved || !hasInterior(e) ? (y[k] - p[k]) / alphaBar : gv[row];
      if (ellipseActive_[i] || !(e.semiAxes[k] > 0)) phiv[row] = 0.0;
      reducedv[row] = ellipseActive_[i] ? 0.0 : reduced;
      betav[row] = ellipseActive_[i] ? reduced : 0.0;
    }
  }
}

}  // namespace Haptos
