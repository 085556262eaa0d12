// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>

#include "Haptos_ReferenceElement.hpp"

namespace {

using Haptos::ReferenceElement;
using Haptos::Topology;

// Tables agree with the shape functions written out here in Exodus' node order.
void checkHexTables(const ReferenceElement& rule, Teuchos::FancyOStream& out, bool& success) {
  const double corner[8][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                               {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
  for (int p = 0; p < rule.numPoints(); ++p)
    for (int a = 0; a < 8; ++a) {
      double factor[3];
      for (int k = 0; k < 3; ++k) factor[k] = 0.5 * (1.0 + corner[a][k] * rule.points(k, p));
      TEST_FLOATING_EQUALITY(rule.values(a, p), factor[0] * factor[1] * factor[2], 1e-14);
      for (int k = 0; k < 3; ++k)
        TEST_FLOATING_EQUALITY(rule.gradients(3 * a + k, p),
                               0.5 * corner[a][k] * factor[(k + 1) % 3] * factor[(k + 2) % 3], 1e-14);
    }
}

TEUCHOS_UNIT_TEST(ReferenceElement, HexTablesFollowExodusOrder) {
  const auto& rule = Haptos::stiffnessRule(Topology::Hex8);
  TEST_EQUALITY(rule.numPoints(), 8);
  TEST_EQUALITY(rule.numNodes(), 8);
  checkHexTables(rule, out, success);
  for (int p = 0; p < 8; ++p)  // 2 x 2 x 2 Gauss
    for (int k = 0; k < 3; ++k)
      TEST_FLOATING_EQUALITY(std::abs(rule.points(k, p)), 1.0 / std::sqrt(3.0), 1e-14);
}

TEUCHOS_UNIT_TEST(ReferenceElement, TetTablesFollowExodusOrder) {
  TEST_EQUALITY(Haptos::stiffnessRule(Topology::Tet4).numPoints(), 1);
  const auto& rule = Haptos::bodyLoadRule(Topology::Tet4);
  TEST_EQUALITY(rule.numPoints(), 4);
  for (int p = 0; p < 4; ++p) {
    TEST_FLOATING_EQUALITY(rule.values(0, p), 1.0 - rule.points.col(p).sum(), 1e-14);
    for (int k = 0; k < 3; ++k) {
      TEST_FLOATING_EQUALITY(rule.values(k + 1, p), rule.points(k, p), 1e-14);
      TEST_FLOATING_EQUALITY(rule.gradients(k, p), -1.0, 1e-14);
      for (int l = 0; l < 3; ++l) TEST_EQUALITY(rule.gradients(3 * (k + 1) + l, p), k == l ? 1.0 : 0.0);
    }
  }
}

// Integrals of products of two linear functions over the reference triangle and tetrahedron.
TEUCHOS_UNIT_TEST(ReferenceElement, LoadRulesIntegrateProductsOfLinearFunctions) {
  const auto& tri = Haptos::sideRule(Haptos::SideShape::Triangle3);
  const auto& tet = Haptos::bodyLoadRule(Topology::Tet4);
  TEST_EQUALITY(tri.numPoints(), 3);
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const double mass = (tri.values.row(a).array() * tri.values.row(b).array()).matrix().dot(tri.weights);
      TEST_FLOATING_EQUALITY(mass, a == b ? 1.0 / 12.0 : 1.0 / 24.0, 1e-13);
    }
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) {
      const double mass = (tet.values.row(a).array() * tet.values.row(b).array()).matrix().dot(tet.weights);
      TEST_FLOATING_EQUALITY(mass, a == b ? 1.0 / 60.0 : 1.0 / 120.0, 1e-13);
    }
}

TEUCHOS_UNIT_TEST(ReferenceElement, QuadSideRuleIsTwoByTwo) {
  const auto& quad = Haptos::sideRule(Haptos::SideShape::Quad4);
  TEST_EQUALITY(quad.numPoints(), 4);
  TEST_FLOATING_EQUALITY(quad.weights.sum(), 4.0, 1e-14);
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) {
      const int apart = (b - a + 4) % 4;  // 0 same, 2 opposite corner
      const double mass =
          (quad.values.row(a).array() * quad.values.row(b).array()).matrix().dot(quad.weights);
      TEST_FLOATING_EQUALITY(mass, apart == 0 ? 4.0 / 9 : apart == 2 ? 1.0 / 9 : 2.0 / 9, 1e-13);
    }
}

}  // namespace
