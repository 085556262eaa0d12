// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ParameterXml.hpp"

#include <Teuchos_ParameterList.hpp>
#include <Teuchos_StringInputSource.hpp>
#include <Teuchos_XMLObject.hpp>
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "Haptos_Error.hpp"
#include "Haptos_NearestName.hpp"
#include "Haptos_ParameterTree.hpp"

namespace Haptos {

namespace {

using Teuchos::ParameterList;
using Teuchos::XMLObject;

constexpr int deepestNesting = 100;  // Teuchos' parser calls itself for every level, until the stack ends
const std::vector<std::string> tagNames = {"ParameterList", "Parameter"};

/// Teuchos puts its own file, line and condition before the message.
std::string parserMessage(const std::string& what) {
  const std::string marker = "XML parse error at ";
  const auto found = what.rfind(marker);
  if (found != std::string::npos) return trimmed(what.substr(found + marker.size()));
  const auto lastLine = trimmed(what).rfind('\n');
  return lastLine == std::string::npos ? what : trimmed(what).substr(lastLine + 1);
}

/// How deep elements lie in each other, by their tags alone; no less than the parser will find.
int nesting(const std::string& text) {
  int depth = 0, deepest = 0;
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + 1)) {
    if (text.compare(at, 2, "</") == 0)
      --depth;
    else if (const std::size_t end = text.find('>', at); end != std::string::npos && text[end - 1] != '/' && std::isalpha(static_cast<unsigned char>(text[at + 1])))
      deepest = std::max(deepest, ++depth);
  }
  return deepest;
}

// Teuchos' parser stumbles over a byte order mark and over an empty text.
XMLObject parseXml(const std::string& text, const std::string& origin) {
  const std::string byteOrderMark = "\xEF\xBB\xBF";
  const bool marked = text.compare(0, byteOrderMark.size(), byteOrderMark) == 0;
  const std::string body = marked ? text.substr(byteOrderMark.size()) : text;
  if (trimmed(body).empty())
    throw InputError(origin + ": the file is empty; a ParameterList named \"Haptos\" is expected");
  if (nesting(body) > deepestNesting)
    throw InputError(origin + ": elements lie more than " + std::to_string(deepestNesting) + " deep in each other; parameters lie five deep");
  try {
    return Teuchos::StringInputSource(body).getObject();
  } catch (const std::exception& e) {
    throw InputError(origin + ": malformed XML: " + parserMessage(e.what()));
  }
}

void checkAttributes(const XMLObject& entry, const std::string& where,
                     const std::vector<std::string>& needed) {
  for (const auto& attribute : needed)
    if (!entry.hasAttribute(attribute))
      throw InputError(where + ": <" + entry.getTag() + "> lacks the attribute '" + attribute + "'");
}

/// Teuchos would pass over it.
void checkContent(const XMLObject& element, const std::string& where) {
  for (int i = 0; i < element.numContentLines(); ++i)
    if (!trimmed(element.getContentLine(i)).empty())
      throw InputError(where + ": text between the tags ('" + trimmed(element.getContentLine(i)) +
                       "') has no meaning; write <Parameter name=\"...\" type=\"...\" value=\"...\"/>");
}

/// Of a list or a parameter; blanks around it are dropped.
std::string nameOf(const XMLObject& entry, const std::string& listPath) {
  const std::string where = listPath.empty() ? "the input" : listPath;
  if (entry.getTag() != tagNames[0] && entry.getTag() != tagNames[1])
    throw InputError(where + ": unknown tag <" + entry.getTag() + ">; valid are <" + joinNames(tagNames, "> and <") + ">");
  checkAttributes(entry, where, {"name"});
  const std::string name = trimmed(entry.getAttribute("name"));
  if (name.empty()) throw InputError(where + ": a <" + entry.getTag() + "> has an empty name");
  if (name.find(pathSeparator) != std::string::npos)
    throw InputError(where + ": the name '" + name + "' must not contain '" + pathSeparator + "'");
  return name;
}

void readParameter(const XMLObject& entry, ParameterList& list, const std::string& name,
                   const std::string& path) {
  checkAttributes(entry, path, {"type", "value"});
  if (entry.numChildren() > 0)
    throw InputError(path + ": a <Parameter> holds nothing; use a <ParameterList>");
  const std::string typeText = entry.getAttribute("type"), valueText = entry.getAttribute("value");
  const auto type = typeFromName(typeText);
  if (!type) {
    const auto& types = typeNames();
    throw InputError(path + ": type '" + typeText + "' is not valid" + suggestion(typeText, types) + " Valid: " + joinNames(types));
  }
  const auto value = parseValue(valueText, *type);
  if (!value) throw InputError(path + ": the value '" + valueText + "' is not of type " + typeName(*type));
  setValue(list, name, *value);
}

// Depth first; a name stands once in a list.
void readList(const XMLObject& element, ParameterList& list, const std::string& listPath) {
  checkContent(element, listPath.empty() ? "the input" : listPath);
  for (int i = 0; i < element.numChildren(); ++i) {
    const XMLObject& entry = element.getChild(i);
    const std::string name = nameOf(entry, listPath);
    const std::string path = joinPath(listPath, name);
    if (list.isParameter(name)) throw InputError(path + ": is given twice; keep one");
    if (entry.getTag() == "ParameterList")
      readList(entry, list.sublist(name), path);
    else
      readParameter(entry, list, name, path);
  }
}

}  // namespace

// Not by Teuchos' own reader: messages are to name a parameter by its path, and nothing is to be taken in silence.
ParameterList parameterListFromXml(const std::string& text, const std::string& origin) {
  const XMLObject root = parseXml(text, origin);
  const std::string right = "; the root must be <ParameterList name=\"Haptos\">";
  if (root.getTag() != "ParameterList")
    throw InputError(origin + ": the root is <" + root.getTag() + ">" + right);
  if (root.hasAttribute("name") && root.getAttribute("name") != "Haptos")
    throw InputError(origin + ": the root list is named \"" + root.getAttribute("name") + "\"" + right);
  ParameterList list("Haptos");
  readList(root, list, "");
  return list;
}

// The whole file at once; what cannot be read is told apart: missing, a folder, no permission.
std::string readTextFile(const std::string& fileName) {
  std::error_code ignored;
  if (!std::filesystem::exists(fileName, ignored))
    throw InputError("input file '" + fileName + "' does not exist; give the path of an XML file");
  if (std::filesystem::is_directory(fileName, ignored))
    throw InputError("input file '" + fileName + "' is a folder; give the path of an XML file");
  if (!std::filesystem::is_regular_file(fileName, ignored))  // a pipe may wait for ever
    throw InputError("input file '" + fileName + "' is not a regular file; give the path of an XML file");
  std::ifstream file(fileName, std::ios::binary);
  std::ostringstream text;
  if (file.peek() != std::ifstream::traits_type::eof()) text << file.rdbuf();
  if (!file.is_open() || file.bad()) throw InputError("input file '" + fileName + "' cannot be read");
  return text.str();
}

}  // namespace Haptos
