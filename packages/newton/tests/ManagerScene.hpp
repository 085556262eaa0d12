// SPDX-License-Identifier: BSD-3-Clause
// What the manager's answers are measured by, apart from its own code.
#pragma once
#include <Teuchos_ParameterList.hpp>
#include <Teuchos_RCP.hpp>
#include <algorithm>
#include <cmath>

#include "../../law/tests/PlainLaw.hpp"
#include "DenseContact.hpp"
#include "Haptos_SubspaceNewtonSolMgr.hpp"

namespace HaptosTest {

struct Kkt {
  double error = 0;  // with lambda and s of the size 1
  int open = 0, slip = 0, stick = 0;
};

/// All conditions, by dense algebra and a plain projection.
inline Kkt measure(const Setup& t, const SubspaceNewtonSolMgr& manager, double unitLength = 1, double unitForce = 1) {
  using Testing::Pair2;
  const DenseContact& d = t.d;
  const DenseVector x = gather(*t.lambda) / unitForce, s = gather(*manager.jumps()) / unitLength;
  Kkt kkt;
  const DenseVector rigid = s * unitLength - d.h + d.F * x * unitForce;
  const DenseMatrix GT = d.GT;
  kkt.error = std::max(kkt.error, (rigid - GT * Testing::qrSolve(GT, rigid)).norm() / unitLength);
  kkt.error = std::max(kkt.error, (GT.transpose() * x - d.e / unitForce).norm());
  kkt.error = std::max(kkt.error, s.tail(s.size() - 3 * d.layout.groups).norm());
  for (int i = 0; i < d.layout.groups; ++i) {
    const double N = x[3 * i];
    kkt.error = std::max({kkt.error, std::abs(N - std::max(0.0, N + s[3 * i]))});
    const Pair2 axes{d.friction[0] * std::max(0.0, N), d.friction[1] * std::max(0.0, N)};
    const Pair2 P = Testing::nearestOnEllipse({x[3 * i + 1] + s[3 * i + 1], x[3 * i + 2] + s[3 * i + 2]}, axes);
    kkt.error = std::max(kkt.error, std::hypot(x[3 * i + 1] - P[0], x[3 * i + 2] - P[1]));
    const double slip = std::hypot(s[3 * i + 1], s[3 * i + 2]);
    ++(N <= 1e-9 ? kkt.open : slip > 1e-6 ? kkt.slip : kkt.stick);
  }
  return kkt;
}

inline RCP<Teuchos::ParameterList> withTolerance(double tolerance) {
  const auto p = rcp(new Teuchos::ParameterList);
  p->set("Convergence Tolerance", tolerance);
  return p;
}

}  // namespace HaptosTest
