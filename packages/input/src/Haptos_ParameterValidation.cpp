// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ParameterValidation.hpp"

#include <Teuchos_ParameterList.hpp>
#include <algorithm>
#include <filesystem>

#include "Haptos_Error.hpp"
#include "Haptos_NearestName.hpp"

namespace Haptos {

namespace {

using Teuchos::ParameterList;

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw InputError(path + ": " + what);
}

[[noreturn]] void refuseUnknown(const ParameterTree& tree, const std::string& listPath,
                                const std::string& name, bool isSublist) {
  const std::string path = joinPath(listPath, name);
  if (isSublist && tree.findParameter(name))
    refuse(path, "is given as a sublist; it is a parameter of type " + tree.findParameter(name)->typeText());
  if (!isSublist && tree.findSublist(name) && tree.userNamed.empty())
    refuse(path, "is given as a parameter; it is a sublist (ParameterList)");
  if (!isSublist && !tree.userNamed.empty())
    refuse(path, "a parameter is not valid here; '" + tree.name +
                     "' takes one sublist (ParameterList) for each " + tree.userNamed.front().name);
  const auto valid = tree.validNames();
  auto ofItsKind = isSublist ? tree.sublistNames() : tree.parameterNames();
  if (ofItsKind.empty()) ofItsKind = valid;
  refuse(path, std::string("unknown ") + (isSublist ? "sublist" : "parameter") + suggestion(name, ofItsKind) + " Valid here: " + joinNames(valid));
}

// A name that is not known is never passed over: a misspelt parameter would leave its default in force.
void checkUnknownNames(const ParameterTree& tree, const ParameterList& list, const std::string& listPath) {
  for (auto it = list.begin(); it != list.end(); ++it) {
    const std::string& name = list.name(it);
    const bool isSublist = list.entry(it).isList();
    const bool known = isSublist ? tree.findSublist(name) != nullptr : tree.findParameter(name) != nullptr;
    if (!known) refuseUnknown(tree, listPath, name, isSublist);
  }
}

/// Value of a parameter of words: the given one or its default.
std::string wordOf(const ParameterTree& tree, const ParameterList& list, const std::string& name) {
  if (list.isType<std::string>(name)) return list.get<std::string>(name);
  const auto* spec = tree.findParameter(name);
  return spec && spec->defaultValue ? valueText(*spec->defaultValue) : "";
}

bool holds(const ParameterCondition& condition, const ParameterTree& tree, const ParameterList& list) {
  const std::string word = wordOf(tree, list, condition.parameter);
  return std::find(condition.values.begin(), condition.values.end(), word) != condition.values.end();
}

// A parameter that would be ignored is refused as one that is missing: both are misunderstandings.
void checkPresence(const ParameterSpec& spec, const ParameterTree& tree, const ParameterList& list,
                   const std::string& path) {
  const bool given = list.isParameter(spec.name);
  if (given && spec.validWhen && !holds(*spec.validWhen, tree, list))
    refuse(path, "is valid only where " + spec.validWhen->text() + "; here " + spec.validWhen->parameter +
                     " is " + wordOf(tree, list, spec.validWhen->parameter) + ", so remove it");
  if (given) return;
  const std::string right = "give it (" + spec.typeText() +
                            (spec.rangeText().empty() ? "" : "; " + spec.rangeText()) + "): " + spec.meaning;
  if (spec.required) refuse(path, "is missing; " + right);
  if (spec.requiredWhen && holds(*spec.requiredWhen, tree, list))
    refuse(path, "is missing, and needed because " + spec.requiredWhen->parameter + " is " +
                     wordOf(tree, list, spec.requiredWhen->parameter) + "; " + right);
}

// Of each group one, whichever; a list beside a parameter may be a choice, too.
void checkAlternatives(const ParameterTree& tree, const ParameterList& list, const std::string& listPath) {
  auto groups = tree.alternatives;
  groups.insert(groups.end(), tree.exclusive.begin(), tree.exclusive.end());
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const auto& group = groups[i];
    std::vector<std::string> given;
    for (const auto& name : group)
      if (list.isParameter(name)) given.push_back(name);
    const std::string path = listPath.empty() ? "the input" : listPath;
    if (given.empty() && i < tree.alternatives.size()) refuse(path, "give one of " + joinNames(group, " or ", "'") + "; none is there");
    if (given.size() > 1)
      refuse(path, "only one of " + joinNames(group, " or ", "'") + " is valid; given are " +
                       joinNames(given, " and ", "'"));
  }
}

void checkList(const ParameterTree& tree, ParameterList& list, const std::string& listPath);

// Names are taken first, since checking a list changes it.
void checkSublists(const ParameterTree& tree, ParameterList& list, const std::string& listPath) {
  std::size_t numUserNamed = 0;
  std::vector<std::string> names;
  for (auto it = list.begin(); it != list.end(); ++it)
    if (list.entry(it).isList()) names.push_back(list.name(it));
  for (const auto& name : names) {
    const auto* sublist = tree.findSublist(name);
    if (!tree.userNamed.empty() && sublist == &tree.userNamed.front()) ++numUserNamed;
    checkList(*sublist, list.sublist(name), joinPath(listPath, name));
  }
  for (const auto& sublist : tree.sublists)  // a list that is not there may still miss required parameters
    if (!list.isSublist(sublist.name) && !tree.isAlternative(sublist.name)) {
      ParameterList empty(sublist.name);
      checkList(sublist, empty, joinPath(listPath, sublist.name));
    }
  if (numUserNamed < tree.minUserNamed)
    refuse(listPath,
           "needs at least " + std::to_string(tree.minUserNamed) +
               " sublist (ParameterList) with a name of your choice: " + tree.userNamed.front().meaning);
}

// Names, then values one by one, then what they must be to each other: the first mistake is told in that order.
void checkList(const ParameterTree& tree, ParameterList& list, const std::string& listPath) {
  checkUnknownNames(tree, list, listPath);
  for (const auto& spec : tree.parameters) {
    if (!list.isParameter(spec.name)) continue;
    const std::string path = joinPath(listPath, spec.name);
    setValue(list, spec.name, checkedValue(spec, path, list.getEntry(spec.name)));
  }
  checkAlternatives(tree, list, listPath);
  for (const auto& spec : tree.parameters) checkPresence(spec, tree, list, joinPath(listPath, spec.name));
  checkSublists(tree, list, listPath);
  for (const auto& rule : tree.rules) {
    const std::string broken = rule.broken(list);
    if (!broken.empty()) throw InputError(joinPath(listPath, broken));
  }
}

// Preparers see what was given, normalisers what will be used.
void fillList(const ParameterTree& tree, ParameterList& list) {
  for (const auto& sublist : tree.sublists)
    if (list.isSublist(sublist.name) || !tree.isAlternative(sublist.name)) list.sublist(sublist.name);
  for (const auto& prepare : tree.preparers) prepare(list);
  for (const auto& spec : tree.parameters) {
    if (!spec.defaultValue || list.isParameter(spec.name)) continue;
    if (spec.validWhen && !holds(*spec.validWhen, tree, list)) continue;
    setValue(list, spec.name, *spec.defaultValue);
  }
  for (auto it = list.begin(); it != list.end(); ++it)
    if (list.entry(it).isList()) {
      const std::string name = list.name(it);
      fillList(*tree.findSublist(name), list.sublist(name));
    }
  for (const auto& normalise : tree.normalisers) normalise(list);
}

// A list first, then what is in it: sublists are looked for under their new names.
void resolveAliasesAt(const ParameterTree& tree, ParameterList& list, const std::string& listPath,
                      std::vector<std::string>& warnings) {
  for (const auto& warning : resolveAliases(tree.aliases, list, listPath)) warnings.push_back(warning);
  std::vector<std::string> names;
  for (auto it = list.begin(); it != list.end(); ++it)
    if (list.entry(it).isList() && tree.findSublist(list.name(it))) names.push_back(list.name(it));
  for (const auto& name : names)
    resolveAliasesAt(*tree.findSublist(name), list.sublist(name), joinPath(listPath, name), warnings);
}

std::string currentName(const ParameterTree& tree, const std::string& name, const std::string& listPath,
                        std::vector<std::string>& warnings) {
  for (const auto& alias : tree.aliases)
    if (alias.oldName == name) {
      warnings.push_back(joinPath(listPath, name) + ": this name is outdated; write '" + alias.newName + "'");
      return alias.newName;
    }
  return name;
}

// On the command line there is no type beside the value: the types of the parameter are tried in turn.
ParameterValue valueFromText(const ParameterSpec& spec, const std::string& path, const std::string& text) {
  const bool looksLikeArray = trimmed(text).substr(0, 1) == "{" || splitArray(text).size() > 1;
  // Numbers before strings: every text is a string.
  std::vector<ParameterType> scalars, arrays;
  for (const auto type : spec.types) (isArray(type) ? arrays : scalars).push_back(type);
  std::sort(scalars.begin(), scalars.end());
  std::sort(arrays.begin(), arrays.end());
  auto order = looksLikeArray ? arrays : scalars;
  const auto& others = looksLikeArray ? scalars : arrays;
  order.insert(order.end(), others.begin(), others.end());
  for (const auto type : order)
    if (const auto value = parseValue(text, type)) return *value;
  refuse(path, "'" + text + "' cannot be read as " + spec.typeText() +
                   (spec.rangeText().empty() ? "" : "; valid: " + spec.rangeText()));
}

}  // namespace

ParameterList validatedList(const ParameterTree& tree, ParameterList given,
                            std::vector<std::string>& warnings) {
  resolveAliases(tree, given, warnings);
  checkList(tree, given, "");
  fillList(tree, given);
  return given;
}

void resolveAliases(const ParameterTree& tree, ParameterList& list, std::vector<std::string>& warnings) {
  resolveAliasesAt(tree, list, "", warnings);
}

void setFromText(const ParameterTree& tree, ParameterList& list, const std::string& path,
                 const std::string& value, std::vector<std::string>& warnings) {
  auto names = splitPath(path);
  if (std::find(names.begin(), names.end(), "") != names.end())
    refuse(path, "the path has an empty name; write it as \"Solver->Relative Tolerance\"");
  const std::string last = names.back();
  names.pop_back();
  const ParameterTree* level = &tree;
  ParameterList* target = &list;
  std::string listPath;
  for (const auto& given : names) {
    const std::string name = currentName(*level, given, listPath, warnings);
    const auto* next = level->findSublist(name);
    if (!next) refuseUnknown(*level, listPath, name, true);
    if (target->isParameter(name) && !target->isSublist(name)) refuseUnknown(*level, listPath, name, false);
    target = &target->sublist(name);
    level = next;
    listPath = joinPath(listPath, name);
  }
  const std::string name = currentName(*level, last, listPath, warnings);
  const auto* spec = level->findParameter(name);
  if (!spec && level->findSublist(name) && (level->userNamed.empty() || target->isSublist(name)))
    refuse(joinPath(listPath, name),
           "is a sublist; name one of its parameters: " + joinNames(level->findSublist(name)->validNames()));
  if (!spec) refuseUnknown(*level, listPath, name, false);
  target->remove(name, false);  // the old value may have another type
  setValue(*target, name, valueFromText(*spec, joinPath(listPath, name), value));
}

// Names in the file are seen from its folder, those of the command line from the current one.
void resolveFileNames(const ParameterTree& tree, ParameterList& list, const std::string& folder) {
  for (const auto& spec : tree.parameters)
    if (spec.fileName && list.isType<std::string>(spec.name))
      list.set(spec.name, resolvePath(folder, list.get<std::string>(spec.name)));
  for (const auto& sublist : tree.sublists)
    if (list.isSublist(sublist.name)) resolveFileNames(sublist, list.sublist(sublist.name), folder);
}

std::string resolvePath(const std::string& folder, const std::string& name) {
  const std::filesystem::path path(name);
  if (name.empty() || folder.empty() || path.is_absolute()) return name;
  return (std::filesystem::path(folder) / path).lexically_normal().string();
}

void requireOtherFile(const std::string& what, const std::string& file, const std::string& otherWhat, const std::string& other) {
  if (file.empty() || other.empty()) return;
  namespace fs = std::filesystem;
  std::error_code error;
  bool same = fs::equivalent(file, other, error);  // false where one of them is not there yet
  if (!same) same = fs::weakly_canonical(fs::absolute(file), error) == fs::weakly_canonical(fs::absolute(other), error) && !error;
  if (same) refuse(what, "'" + file + "' is the file of " + otherWhat + " ('" + other + "'), which would be lost; give another name");
}

}  // namespace Haptos
