// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_ExodusFields.hpp"

#include <exodusII.h>

#include <algorithm>

#include "Haptos_Error.hpp"

namespace Haptos {
namespace {

// That there is a value beyond the last node is the only sign the library gives of an array that is too long.
bool readValues(int file, int field, int step, const ExodusNodes& nodes, std::vector<double>& values) {
  double beyond = 0;
  values.assign(std::size_t(nodes.count), 0.0);
  const auto read = [&](std::int64_t first, std::int64_t count, double* to) {
    return ex_get_partial_var(file, step, EX_NODAL, field + 1, 1, first + 1, count, to) >= 0;
  };
  return read(nodes.total - 1, 1, &beyond) && !read(nodes.total, 1, &beyond) && (values.empty() || read(nodes.first, nodes.count, values.data()));
}

}  // namespace

// Names longer than the library's default of 32 characters come whole only when asked for.
int readTexts(int file, std::int64_t count, const std::function<int(char**)>& get, std::vector<std::string>& texts) {
  texts.assign(std::size_t(count), std::string{});
  if (count == 0) return 0;
  const auto stored = ex_inquire_int(file, EX_INQ_DB_MAX_ALLOWED_NAME_LENGTH);
  const int length = int(std::clamp<std::int64_t>(stored, MAX_STR_LENGTH, 4096));
  ex_set_max_name_length(file, length);
  std::vector<std::vector<char>> buffers(texts.size(), std::vector<char>(std::size_t(length) + 2, '\0'));
  std::vector<char*> pointers;
  for (auto& buffer : buffers) pointers.push_back(buffer.data());
  const int status = get(pointers.data());
  for (std::size_t i = 0; i < texts.size(); ++i) {
    texts[i] = pointers[i];
    texts[i].erase(texts[i].find_last_not_of(' ') + 1);
  }
  return status;
}

std::vector<NodalField> readNodalFields(int file, const std::string& path, const ExodusNodes& nodes, const std::vector<std::string>& wanted) {
  const auto refuse = [&](const std::string& what) { throw InputError("Mesh file '" + path + "': " + what); };
  constexpr int kMost = 1000000;
  int count = 0;
  std::vector<std::string> names;
  if (ex_get_variable_param(file, EX_NODAL, &count) < 0 || count < 0 || count > kMost ||
      readTexts(file, count, [&](char** texts) { return ex_get_variable_names(file, EX_NODAL, count, texts); }, names) < 0)
    refuse("cannot read the names of the nodal fields; the file is damaged.");
  const int steps = int(ex_inquire_int(file, EX_INQ_TIME));
  std::vector<NodalField> fields;
  for (const auto& name : names) {
    NodalField& field = fields.emplace_back(NodalField{name, {}});
    if (std::find(wanted.begin(), wanted.end(), name) == wanted.end()) continue;
    if (steps < 1) refuse("its nodal field '" + name + "' has no values, as there is no time step.");
    if (!readValues(file, int(fields.size()) - 1, steps, nodes, field.values))
      refuse("its nodal field '" + name + "' does not have one value for each of the " + std::to_string(nodes.total) + " nodes.");
  }
  return fields;
}

}  // namespace Haptos
