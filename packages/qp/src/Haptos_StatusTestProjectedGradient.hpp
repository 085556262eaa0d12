// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
#include <ostream>

#include "Haptos_MpgpIter.hpp"

namespace Haptos {

/// \brief Passes where ||g^P|| <= tolerance (absolute, in the unit of the gradient) or a limit is reached.
///
/// For `MpgpIter` by itself; g^P is the reduced projected gradient, which is continuous in x.
template <class Scalar, class MV, class OP>
class StatusTestProjectedGradient : public Belos::StatusTest<Scalar, MV, OP> {
 public:
  explicit StatusTestProjectedGradient(Scalar tolerance, int maxApplications = 1000000)
      : tolerance_(tolerance), maxApplications_(maxApplications) {}

  Belos::StatusType checkStatus(Belos::Iteration<Scalar, MV, OP>* iteration) override {
    const auto& mpgp = dynamic_cast<const MpgpIter<Scalar, MV, OP>&>(*iteration);
    norm_ = mpgp.projectedGradientNorm();
    const bool limitReached = mpgp.counts().hessianApplications >= maxApplications_;
    return status_ = norm_ <= tolerance_ || limitReached ? Belos::Passed : Belos::Failed;
  }
  Belos::StatusType getStatus() const override { return status_; }
  void reset() override { status_ = Belos::Undefined; }
  void print(std::ostream& os, int indent = 0) const override {
    os << std::string(indent, ' ') << "projected gradient " << norm_ << " (tolerance " << tolerance_ << ")\n";
  }

 private:
  Scalar tolerance_, norm_ = -1;
  int maxApplications_;
  Belos::StatusType status_ = Belos::Undefined;
};

/// \brief The inner test of SMALSE-M: ||g^P|| <= min(M ||Q (x - x0)||, eta), with the ways out below.
template <class Scalar, class MV, class OP>
class StatusTestBalancedGradient : public Belos::StatusTest<Scalar, MV, OP> {
 public:
  using Iteration = MpgpIter<Scalar, MV, OP>;
  enum class Cause {
    none,
    balanced,  ///< the test of SMALSE-M
    accepted,  ///< the outer test passes already
    floor,     ///< ||g^P|| <= floor: nothing more to gain from this multiplier and set
    limit      ///< maxApplications
  };
  Scalar M = 0;      ///< in the unit of A
  Scalar eta = 0;    ///< in the unit of b
  Scalar floor = 0;  ///< in the unit of b
  int maxApplications = 0;
  std::function<bool(const Iteration&)> accept;  ///< the outer test, if it can be asked inside; may be empty

  Belos::StatusType checkStatus(Belos::Iteration<Scalar, MV, OP>* iteration) override {
    const auto& mpgp = dynamic_cast<const Iteration&>(*iteration);
    norm_ = mpgp.projectedGradientNorm();
    cause_ = Cause::none;
    if (accept && accept(mpgp))
      cause_ = Cause::accepted;
    else if (norm_ <= floor)
      cause_ = Cause::floor;
    else if (norm_ <= std::min(M * mpgp.equalityNorm(), eta))
      cause_ = Cause::balanced;
    else if (mpgp.counts().hessianApplications >= maxApplications)
      cause_ = Cause::limit;
    return status_ = cause_ == Cause::none ? Belos::Failed : Belos::Passed;
  }
  Belos::StatusType getStatus() const override { return status_; }
  void reset() override { status_ = Belos::Undefined; }
  void print(std::ostream& os, int indent = 0) const override {
    os << std::string(indent, ' ') << "projected gradient " << norm_ << " (M " << M << ", eta " << eta << ")\n";
  }
  Cause cause() const { return cause_; }

 private:
  Scalar norm_ = -1;
  Cause cause_ = Cause::none;
  Belos::StatusType status_ = Belos::Undefined;
};

}  // namespace Haptos
