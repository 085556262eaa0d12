// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ParameterDocumentation.hpp"

#include <algorithm>
#include <sstream>

#include "Haptos_NearestName.hpp"

namespace Haptos {

namespace {

std::string meaningWithUnit(const ParameterSpec& spec) {
  return spec.unit.empty() ? spec.meaning : spec.meaning + " [" + spec.unit + "]";
}

void writeText(std::ostream& out, const ParameterSpec& spec, const std::string& path) {
  out << path << "\n    type     " << spec.typeText() << "\n    default  " << spec.defaultText() << "\n";
  if (!spec.rangeText().empty()) out << "    valid    " << spec.rangeText() << "\n";
  if (spec.validWhen) out << "    only     where " << spec.validWhen->text() << "\n";
  out << "    meaning  " << meaningWithUnit(spec) << "\n";
}

void writeText(std::ostream& out, const ParameterTree& tree, const std::string& listPath) {
  for (const auto& spec : tree.parameters) {
    writeText(out, spec, joinPath(listPath, spec.name));
    for (const auto& group : tree.alternatives)
      if (std::find(group.begin(), group.end(), spec.name) != group.end())
        out << "    note     exactly one of " << joinNames(group, ", ", "'") << " is given\n";
    for (const auto& group : tree.exclusive)
      if (std::find(group.begin(), group.end(), spec.name) != group.end())
        out << "    note     at most one of " << joinNames(group, ", ", "'") << " is given\n";
  }
  for (const auto& sublist : tree.sublists) writeText(out, sublist, joinPath(listPath, sublist.name));
  for (const auto& child : tree.userNamed) writeText(out, child, joinPath(listPath, child.name));
}

/// A cell of a markdown table: '|' would end it and '<' may start a tag.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    if (c == '<')
      escaped += "&lt;";
    else
      escaped += c;
  }
  return escaped.empty() ? " " : escaped;
}

// One row a parameter; the text of --print-parameters has the same in lines.
void writeTable(std::ostream& out, const ParameterTree& tree) {
  if (tree.parameters.empty()) return;
  out << "| parameter | type | default | valid | meaning |\n|---|---|---|---|---|\n";
  for (const auto& spec : tree.parameters) {
    const std::string condition = spec.validWhen ? "Only where " + spec.validWhen->text() + ". " : "";
    out << "| " << cell(spec.name) << " | " << cell(spec.typeText()) << " | " << cell(spec.defaultText())
        << " | " << cell(spec.rangeText()) << " | " << cell(condition + meaningWithUnit(spec)) << " |\n";
  }
  out << "\n";
}

// List by list, lists within lists one heading deeper.
void writeMarkdown(std::ostream& out, const ParameterTree& tree, const std::string& path, int level) {
  out << std::string(std::size_t(std::min(level, 6)), '#') << " " << cell(path.empty() ? tree.name : path)
      << "\n\n"
      << tree.meaning << "\n\n";
  writeTable(out, tree);
  for (const auto& group : tree.alternatives)
    out << "- Exactly one of " << joinNames(group, ", ", "`") << " is given.\n";
  for (const auto& group : tree.exclusive) out << "- At most one of " << joinNames(group, ", ", "`") << " is given.\n";
  for (const auto& rule : tree.rules) out << "- " << rule.text << "\n";
  for (const auto& alias : tree.aliases)
    out << "- `" << alias.oldName << "` is an outdated name of `" << alias.newName << "`.\n";
  if (!tree.alternatives.empty() || !tree.exclusive.empty() || !tree.rules.empty() || !tree.aliases.empty()) out << "\n";
  for (const auto& sublist : tree.sublists)
    writeMarkdown(out, sublist, joinPath(path, sublist.name), level + 1);
  for (const auto& child : tree.userNamed) writeMarkdown(out, child, joinPath(path, child.name), level + 1);
}

}  // namespace

std::string parametersAsText(const ParameterTree& tree) {
  std::ostringstream out;
  writeText(out, tree, "");
  return out.str();
}

std::string parametersAsMarkdown(const ParameterTree& tree, int headingLevel) {
  std::ostringstream out;
  writeMarkdown(out, tree, "", headingLevel);
  return out.str();
}

}  // namespace Haptos
