// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ParameterTree.hpp"

#include <algorithm>

namespace Haptos {

const ParameterSpec* ParameterTree::findParameter(const std::string& parameter) const {
  for (const auto& spec : parameters)
    if (spec.name == parameter) return &spec;
  return nullptr;
}

const ParameterTree* ParameterTree::findSublist(const std::string& sublist) const {
  for (const auto& tree : sublists)
    if (tree.name == sublist) return &tree;
  return userNamed.empty() || findParameter(sublist) ? nullptr : &userNamed.front();
}

bool ParameterTree::isAlternative(const std::string& entry) const {
  for (const auto* groups : {&alternatives, &exclusive})
    for (const auto& group : *groups)
      if (std::find(group.begin(), group.end(), entry) != group.end()) return true;
  return false;
}

std::vector<std::string> ParameterTree::parameterNames() const {
  std::vector<std::string> names;
  for (const auto& spec : parameters) names.push_back(spec.name);
  return names;
}

std::vector<std::string> ParameterTree::sublistNames() const {
  std::vector<std::string> names;
  for (const auto& tree : sublists) names.push_back(tree.name);
  return names;
}

std::vector<std::string> ParameterTree::validNames() const {
  auto names = parameterNames();
  const auto more = sublistNames();
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

// Blanks around names do not count, as in "Solver -> Method".
std::vector<std::string> splitPath(const std::string& path) {
  std::vector<std::string> names;
  std::size_t start = 0;
  while (true) {
    const auto end = path.find(pathSeparator, start);
    names.push_back(trimmed(path.substr(start, end == std::string::npos ? end : end - start)));
    if (end == std::string::npos) return names;
    start = end + pathSeparator.size();
  }
}

}  // namespace Haptos
