// SPDX-License-Identifier: BSD-3-Clause
// Inputs and helpers shared by the tests of core.
#pragma once
#include <Teuchos_ParameterList.hpp>
#include <string>
#include <vector>

#include "Haptos_Error.hpp"
#include "Haptos_Parameters.hpp"

namespace HaptosTest {

/// A complete input; `replace` changes one passage of it, which must be there.
inline std::string fullInput() {
  return R"xml(<?xml version="1.0"?>
<!-- two beams -> one input -->
<ParameterList name="Haptos">
  <Parameter name="Title" type="string" value="two beams"/>
  <ParameterList name="Mesh">
    <Parameter name="File" type="string" value="mesh/two_beams.exo"/>
  </ParameterList>
  <ParameterList name="Decomposition">
    <Parameter name="Method" type="string" value="METIS"/>
    <Parameter name="Subdomains" type="int" value="8"/>
  </ParameterList>
  <ParameterList name="Materials">
    <ParameterList name="steel">
      <Parameter name="Element Blocks" type="Array(string)" value="{upper, 12}"/>
      <Parameter name="Young's Modulus" type="double" value="2.119e5"/>
      <Parameter name="Poisson's Ratio" type="double" value="0.277"/>
    </ParameterList>
  </ParameterList>
  <ParameterList name="Boundary Conditions">
    <ParameterList name="clamp">
      <Parameter name="Type" type="string" value="Displacement"/>
      <Parameter name="Sets" type="Array(string)" value="{lower_clamp, upper_clamp}"/>
      <Parameter name="Components" type="string" value="xz"/>
      <Parameter name="Value" type="Array(double)" value="{1.5, 2.5}"/>
    </ParameterList>
    <ParameterList name="press">
      <Parameter name="Type" type="string" value="Pressure"/>
      <Parameter name="Sets" type="Array(string)" value="{upper_top}"/>
      <Parameter name="Value" type="string" value="100*min(1, max(0, 1.5 - x))"/>
    </ParameterList>
    <ParameterList name="pull">
      <Parameter name="Type" type="string" value="Traction"/>
      <Parameter name="Sets" type="Array(string)" value="{upper_end}"/>
      <Parameter name="Value" type="Array(string)" value="{min(1, x), 20, x &lt; 1 ? 0 : 1}"/>
    </ParameterList>
    <ParameterList name="weight">
      <Parameter name="Type" type="string" value="Body Force"/>
      <Parameter name="Element Blocks" type="Array(string)" value="{upper}"/>
      <Parameter name="Value" type="Array(double)" value="{0, 0, -9.81}"/>
    </ParameterList>
  </ParameterList>
  <ParameterList name="Contact">
    <ParameterList name="interface">
      <Parameter name="Secondary Side Set" type="string" value="upper_contact"/>
      <Parameter name="Primary Side Set" type="string" value="lower_contact"/>
      <ParameterList name="Friction">
        <Parameter name="Law" type="string" value="Coulomb"/>
        <Parameter name="Coefficients" type="Array(double)" value="{0.3, 0.1}"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="ground">
      <Parameter name="Secondary Side Set" type="string" value="bottom"/>
      <ParameterList name="Rigid Plane">
        <Parameter name="Point" type="Array(double)" value="{0.0, 0.0, 0.0}"/>
        <Parameter name="Normal" type="Array(double)" value="{0.0, 0.0, 1.0}"/>
      </ParameterList>
    </ParameterList>
  </ParameterList>
  <ParameterList name="Output">
    <Parameter name="File" type="string" value="/absolute/result.exo"/>
  </ParameterList>
</ParameterList>
)xml";
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  if (at == std::string::npos) throw std::logic_error("the test input does not contain: " + from);
  return text.replace(at, from.size(), to);
}

inline Teuchos::ParameterList read(const std::string& text,
                                   const std::vector<std::pair<std::string, std::string>>& sets = {}) {
  std::vector<std::string> warnings;
  return Haptos::parametersFromXml(text, "folder/input.xml", sets, warnings);
}

/// Message of the InputError that `work` throws; "(nothing thrown)" if it throws none.
template <class Work>
std::string messageOf(Work&& work) {
  try {
    work();
  } catch (const Haptos::InputError& e) {
    return e.what();
  }
  return "(nothing thrown)";
}

inline std::string refusal(const std::string& from, const std::string& to) {
  return messageOf([&] { read(replaced(fullInput(), from, to)); });
}

inline std::string setRefusal(const std::string& path, const std::string& value) {
  return messageOf([&] { read(fullInput(), {{path, value}}); });
}

/// True if `text` contains all parts; the first missing part is printed.
inline bool containsAll(const std::string& text, const std::vector<std::string>& parts, std::ostream& out) {
  for (const auto& part : parts)
    if (text.find(part) == std::string::npos) {
      out << "'" << part << "' is not in: " << text << "\n";
      return false;
    }
  return true;
}

}  // namespace HaptosTest

/// The text contains every one of the parts.
#define TEST_CONTAINS(text, ...) \
  TEST_ASSERT(HaptosTest::containsAll(text, std::vector<std::string>{__VA_ARGS__}, out))
