// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Expression.hpp"

#include <muParser.h>

#include <Teuchos_ParameterList.hpp>
#include <algorithm>
#include <cmath>
#include <regex>

#include "Haptos_Error.hpp"
#include "Haptos_NearestName.hpp"
#include "Haptos_ParameterTree.hpp"

namespace Haptos {

namespace {

double clip(double value, double low, double high) { return std::min(std::max(value, low), high); }

/// muParser's functions and our own, sorted.
std::vector<std::string> functionNames(const mu::Parser& parser) {
  std::vector<std::string> names;
  for (const auto& entry : parser.GetFunDef()) names.push_back(entry.first);
  std::sort(names.begin(), names.end());
  return names;
}

/// What a name in an expression can be, for messages.
std::string knownNames(const mu::Parser& parser) {
  return "known are the variables x, y, z, the constants pi, _pi, _e and the functions " +
         joinNames(functionNames(parser));
}

/// Position (0-based) of a '=' that would assign, which muParser allows and we do not; npos if there is none.
std::size_t assignmentPosition(const std::string& text) {
  const std::string comparing = "=<>!";
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    if (i + 1 < text.size() && text[i + 1] == '=') {
      ++i;  // "=="
      continue;
    }
    if (i > 0 && comparing.find(text[i - 1]) != std::string::npos) continue;
    if (i > 0 && std::string("+-*/").find(text[i - 1]) != std::string::npos) return i - 1;
    return i;
  }
  return std::string::npos;
}

/// muParser's message with its position counted from 1; its own text counts from 0.
std::string parserMessage(const mu::ParserError& error, const std::string& text) {
  static const std::regex position("( found)? at position [0-9]+");
  std::string message = std::regex_replace(error.GetMsg(), position, "");
  while (!message.empty() && message.back() == '.') message.pop_back();
  if (error.GetPos() < 0) return message;
  const auto at = std::min(std::size_t(error.GetPos()), text.size());  // muParser appends a blank to the text
  return message + " at position " + std::to_string(at + 1);
}

}  // namespace

struct Expression::Parser {
  double x = 0, y = 0, z = 0, t = 0;
  mu::Parser parser;

  explicit Parser(const std::string& text) {
    parser.DefineVar("x", &x);
    parser.DefineVar("y", &y);
    parser.DefineVar("z", &z);
    parser.DefineVar("t", &t);
    parser.DefineConst("pi", std::acos(-1.0));
    parser.DefineFun("clip", clip);
    parser.SetExpr(text);
  }
  Parser(const Parser&) = delete;  // the parser points to x, y, z

  /// Parses and evaluates once; the value does not matter yet.
  void check() {
    int numResults = 0;
    parser.Eval(numResults);
    if (numResults != 1)
      throw mu::ParserError("It has " + std::to_string(numResults) + " values; one is needed");
    if (parser.GetUsedVar().count("t") > 0) throw mu::ParserError("The name \"t\" is reserved for time");
  }
};

Expression::Expression(double value) : constant_(value), text_(numberText(value)) {}

Expression::Expression(const std::string& text, const std::string& parameterPath)
    : text_(text), parameterPath_(parameterPath) {
  // numbers are read as everywhere in the input, whatever the parser makes of them
  if (const auto number = parseDouble(text)) {
    constant_ = finite(*number, 0, 0, 0);
    return;
  }
  if (trimmed(text).empty())
    throw InputError(parameterPath + ": the expression is empty; give a number or a function of x, y, z");
  constexpr std::size_t kLongest = 19999;  // muParser's own limit, which it tells by repeating the text
  if (text.size() > kLongest)
    throw InputError(parameterPath + ": the expression has " + std::to_string(text.size()) + " characters; at most " +
                     std::to_string(kLongest) + " are read");
  parser_ = std::make_shared<Parser>(text);
  const std::string where = parameterPath + ": the expression '" + text + "' cannot be understood: ";
  const auto assignment = assignmentPosition(text);
  if (assignment != std::string::npos)
    throw InputError(where + "assignment at position " + std::to_string(assignment + 1) +
                     "; compare with ==");
  try {
    parser_->check();
  } catch (const mu::ParserError& e) {
    throw InputError(where + parserMessage(e, text) + "; " + knownNames(parser_->parser));
  }
  // "pi/2" needs no parser for every point
  if (parser_->parser.GetUsedVar().empty()) {
    constant_ = finite(parser_->parser.Eval(), 0, 0, 0);
    parser_.reset();
  }
}

// Where a value is not usable is known only where it is applied: the message names the point.
double Expression::finite(double value, double x, double y, double z) const {
  if (std::abs(value) <= kLargestNumber) return value;
  throw InputError(parameterPath_ + ": the expression '" + text_ + "' gives " + numberText(value) +
                   " at (x, y, z) = (" + numberText(x) + ", " + numberText(y) + ", " + numberText(z) +
                   "); it must be finite, and at most " + numberText(kLargestNumber) + ", wherever it is applied");
}

double Expression::operator()(double x, double y, double z) const {
  if (!parser_) return constant_;
  parser_->x = x;
  parser_->y = y;
  parser_->z = z;
  return finite(parser_->parser.Eval(), x, y, z);
}

bool VectorExpression::isConstant() const {
  return std::all_of(components_.begin(), components_.end(),
                     [](const Expression& e) { return e.isConstant(); });
}

// One number or text, or an array of them: what a user writes for one component, and for three.
std::vector<Expression> expressionsFromParameter(const Teuchos::ParameterList& list, const std::string& name,
                                                 const std::string& listPath, std::size_t numComponents) {
  const std::string path = joinPath(listPath, name);
  const auto* entry = list.getEntryPtr(name);
  if (!entry) throw InputError(path + ": is missing; give a number or an expression of x, y, z");
  const auto given = valueOf(*entry);
  std::vector<Expression> components;
  const auto number = given ? convertValue(*given, ParameterType::Double) : given;
  const auto numbers = given ? convertValue(*given, ParameterType::DoubleArray) : given;
  if (number)
    components = {Expression(numberText(std::get<double>(*number)), path)};
  else if (numbers)
    for (const double value : std::get<std::vector<double>>(*numbers))
      components.emplace_back(numberText(value), path);
  else if (given && std::holds_alternative<std::string>(*given))
    components = {Expression(std::get<std::string>(*given), path)};
  else if (given && std::holds_alternative<std::vector<std::string>>(*given))
    for (const auto& text : std::get<std::vector<std::string>>(*given)) components.emplace_back(text, path);
  else
    throw InputError(path + ": must be double, string, Array(double) or Array(string)");
  if (components.size() != numComponents)
    throw InputError(path + ": has " + std::to_string(components.size()) + " components; " +
                     std::to_string(numComponents) + " are needed");
  return components;
}

Expression expressionFromParameter(const Teuchos::ParameterList& list, const std::string& name,
                                   const std::string& listPath) {
  return expressionsFromParameter(list, name, listPath, 1).front();
}

VectorExpression vectorExpressionFromParameter(const Teuchos::ParameterList& list, const std::string& name,
                                               const std::string& listPath) {
  const auto components = expressionsFromParameter(list, name, listPath, 3);
  return VectorExpression({components[0], components[1], components[2]});
}

}  // namespace Haptos
