// SPDX-License-Identifier: BSD-3-Clause
#include <Teuchos_Array.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <cmath>

#include "Haptos_Expression.hpp"
#include "TestInput.hpp"

namespace {

using namespace HaptosTest;
using namespace Haptos;

const std::string path = "Boundary Conditions->press->Value";

std::string textRefusal(const std::string& text) {
  return messageOf([&] { Expression(text, path); });
}

TEUCHOS_UNIT_TEST(Expression, FollowsTheCoordinates) {
  const Expression squeeze("100*min(1, max(0, 1.5 - x))", path);
  TEST_ASSERT(!squeeze.isConstant());
  TEST_EQUALITY(squeeze(0.2, 0, 0), 100.0);
  TEST_EQUALITY(squeeze(1.25, 0, 0), 25.0);
  TEST_EQUALITY(squeeze(1.75, 0, 0), 0.0);
  const Expression clipped("100*clip(1.5 - x, 0, 1)", path);
  for (const double x : {0.0, 0.7, 1.3, 1.9}) TEST_EQUALITY(clipped(x, 0, 0), squeeze(x, 0, 0));
  const Expression all("x + 10*y + 100*z + max(1, 2, 3, x)", path);
  TEST_EQUALITY(all(1, 2, 3), 324.0);
  const Expression copy = all;  // copies share the parser and still see their own point
  TEST_EQUALITY(copy(0, 0, 0), 3.0);
  TEST_EQUALITY(all(1, 0, 0), 4.0);
  TEST_EQUALITY(Expression("x <= 1 && y != 2 ? 5 : 6", path)(1, 2, 0), 6.0);
}

TEUCHOS_UNIT_TEST(Expression, ConstantsNeedNoParser) {
  TEST_ASSERT(Expression(2.5).isConstant() && Expression("2.5", path).isConstant());
  TEST_ASSERT(Expression("2*pi", path).isConstant());
  TEST_FLOATING_EQUALITY(Expression("2*pi", path)(1, 2, 3), 6.283185307179586, 1e-15);
  TEST_EQUALITY(Expression("-1e-3", path)(1, 2, 3), -1e-3);
  TEST_EQUALITY(Expression()(1, 1, 1), 0.0);
}

TEUCHOS_UNIT_TEST(Expression, MistakesAreRefusedWithTheirPosition) {
  TEST_CONTAINS(textRefusal("100*(1 - q)"), path, "'100*(1 - q)'", "position 10", "x, y, z", "sqrt", "clip");
  TEST_ASSERT(textRefusal("100*(1 - q)").find("position 9") == std::string::npos);  // counted from 1
  TEST_CONTAINS(textRefusal("1 +"), path, "cannot be understood", "position 4");
  TEST_CONTAINS(textRefusal("min(1, x"), path, "parenthesis");
  TEST_CONTAINS(textRefusal("cosinus(x)"), path, "cosinus", "cos");
  TEST_CONTAINS(textRefusal(" "), path, "is empty");
  TEST_CONTAINS(textRefusal("x = 3"), path, "assignment at position 3", "==");
  TEST_CONTAINS(textRefusal("x += 3"), path, "assignment at position 3");
  TEST_CONTAINS(textRefusal("x, y"), path, "2 values");
  TEST_CONTAINS(textRefusal("t*x"), path, "reserved for time");
  TEST_CONTAINS(textRefusal("nan"), path);
  TEST_CONTAINS(textRefusal("1/0"), path, "inf", "must be finite");
  TEST_CONTAINS(textRefusal("1e99*20"), path, "2e+100", "at most 1e+100");
  TEST_EQUALITY(textRefusal("-1e100"), "(nothing thrown)");
  TEST_EQUALITY(textRefusal("x >= 1 || x == 0"), "(nothing thrown)");
}

TEUCHOS_UNIT_TEST(Expression, ValuesThatAreNotFiniteNameThePoint) {
  const Expression root("sqrt(x - 1)", path);
  TEST_EQUALITY(root(5, 0, 0), 2.0);
  TEST_CONTAINS(messageOf([&] { root(0.5, 2, 3); }), path, "sqrt(x - 1)", "nan", "(0.5, 2, 3)");
  const Expression inverse("1/(x - y)", path);
  TEST_CONTAINS(messageOf([&] { inverse(2, 2, 0); }), path, "inf", "(2, 2, 0)");
}

TEUCHOS_UNIT_TEST(Expression, ComesFromEveryTypeOfParameter) {
  Teuchos::ParameterList list;
  list.set("double", 2.0).set("int", 3).set("text", std::string("x*y"));
  list.set("doubles", Teuchos::Array<double>(std::vector<double>{1.0, 2.0, 3.0}));
  list.set("ints", Teuchos::Array<int>(std::vector<int>{4, 5, 6}));
  list.set("texts", Teuchos::Array<std::string>(std::vector<std::string>{"x", "2", "z"}));
  TEST_EQUALITY(expressionFromParameter(list, "double", "L")(0, 0, 0), 2.0);
  TEST_EQUALITY(expressionFromParameter(list, "int", "L")(0, 0, 0), 3.0);
  TEST_EQUALITY(expressionFromParameter(list, "text", "L")(2, 3, 0), 6.0);
  const auto numbers = vectorExpressionFromParameter(list, "doubles", "L");
  TEST_ASSERT(numbers.isConstant());
  TEST_EQUALITY(numbers(0, 0, 0)[2], 3.0);
  TEST_EQUALITY(vectorExpressionFromParameter(list, "ints", "L")(0, 0, 0)[1], 5.0);
  const auto field = vectorExpressionFromParameter(list, "texts", "L");
  TEST_ASSERT(!field.isConstant() && field.component(1).isConstant());
  TEST_EQUALITY(field(7, 8, 9)[0], 7.0);
  TEST_EQUALITY(field(7, 8, 9)[2], 9.0);

  TEST_CONTAINS(messageOf([&] { vectorExpressionFromParameter(list, "double", "L"); }), "L->double",
                "1 components", "3 are needed");
  TEST_CONTAINS(messageOf([&] { expressionFromParameter(list, "doubles", "L"); }), "L->doubles",
                "1 are needed");
  TEST_CONTAINS(messageOf([&] { expressionFromParameter(list, "none", "L"); }), "L->none", "is missing");
  list.set("flag", true).set("bad", std::string("x +"));
  TEST_CONTAINS(messageOf([&] { expressionFromParameter(list, "flag", "L"); }), "L->flag", "must be double");
  TEST_CONTAINS(messageOf([&] { expressionFromParameter(list, "bad", "L"); }), "L->bad",
                "cannot be understood");
}

}  // namespace
