// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

namespace Teuchos {
class ParameterList;
}

namespace Haptos {

/// \brief A number, or a function of the coordinates x, y, z in muParser's syntax: "100*min(1, max(0, 1.5 -
/// x))".
///
/// Beside muParser's functions there are clip(v, low, high) and the constant pi (muParser's own: _pi, _e);
/// min, max, sum and avg take any number of arguments.  The name t is reserved for time.  Numbers are
/// evaluated without muParser.  Copies share their parser: not for several threads at once.
class Expression {
 public:
  Expression(double value = 0.0);  // NOLINT: a number is an expression

  /// \param parameterPath for messages: "Boundary Conditions->press->Value"
  /// \throws InputError with the position and the names that are known, if the text cannot be understood
  Expression(const std::string& text, const std::string& parameterPath);

  /// \brief Value at a point, in the unit of the parameter.
  /// \throws InputError that names parameter and point if the value is not finite or beyond kLargestNumber
  double operator()(double x, double y, double z) const;

  bool isConstant() const { return parser_ == nullptr; }
  const std::string& text() const { return text_; }

 private:
  struct Parser;
  double finite(double value, double x, double y, double z) const;

  double constant_ = 0.0;
  std::string text_, parameterPath_;
  std::shared_ptr<Parser> parser_;
};

/// \brief Three expressions: the x, y and z components.
class VectorExpression {
 public:
  VectorExpression() = default;
  explicit VectorExpression(std::array<Expression, 3> components) : components_(std::move(components)) {}

  std::array<double, 3> operator()(double x, double y, double z) const {
    return {components_[0](x, y, z), components_[1](x, y, z), components_[2](x, y, z)};
  }
  const Expression& component(int axis) const { return components_[std::size_t(axis)]; }
  bool isConstant() const;

 private:
  std::array<Expression, 3> components_;
};

/// \brief The components of a parameter of type double, string, Array(double) or Array(string) (ints too).
/// \param listPath path of `list`, for messages: "Boundary Conditions->pull"
/// \return [numComponents]
/// \throws InputError if the parameter is missing, has another type or another number of components
std::vector<Expression> expressionsFromParameter(const Teuchos::ParameterList& list, const std::string& name,
                                                 const std::string& listPath, std::size_t numComponents);

Expression expressionFromParameter(const Teuchos::ParameterList& list, const std::string& name,
                                   const std::string& listPath);
VectorExpression vectorExpressionFromParameter(const Teuchos::ParameterList& list, const std::string& name,
                                               const std::string& listPath);

}  // namespace Haptos
