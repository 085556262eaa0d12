// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_MeshFiles.hpp"

#include <Teuchos_Comm.hpp>
#include <filesystem>
#include <map>

#include "Haptos_Error.hpp"
#include "Haptos_Rendezvous.hpp"
#include "Haptos_ExodusPart.hpp"
#include "Haptos_ExodusReader.hpp"
#include "Haptos_PartJoiner.hpp"

namespace Haptos {
namespace {

namespace fs = std::filesystem;

/// ".16.03" -> {16, 3}; {0, 0} for anything else.
std::pair<int, int> splitSuffix(const std::string& suffix) {
  const auto second = suffix.find('.', 1);
  if (suffix.empty() || suffix[0] != '.' || second == std::string::npos) return {0, 0};
  const std::string count = suffix.substr(1, second - 1), part = suffix.substr(second + 1);
  const auto isNumber = [](const std::string& s) {
    return !s.empty() && s.size() < 9 && s.find_first_not_of("0123456789") == std::string::npos;
  };
  if (!isNumber(count) || !isNumber(part)) return {0, 0};
  return {std::stoi(count), std::stoi(part)};
}

/// By N and then by i, all that looks like a file of a decomposed mesh.
std::map<int, std::map<int, std::string>> findParts(const std::string& path) {
  std::map<int, std::map<int, std::string>> parts;
  const fs::path folder = fs::path(path).has_parent_path() ? fs::path(path).parent_path() : fs::path(".");
  const std::string name = fs::path(path).filename().string();
  std::error_code error;
  if (name.empty()) return parts;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string other = entry.path().filename().string();
    if (other.compare(0, name.size(), name) != 0) continue;
    const auto [count, part] = splitSuffix(other.substr(name.size()));
    if (count > 0 && part < count) parts[count][part] = path + other.substr(name.size());
  }
  return parts;
}

/// Files of another decomposition with the same names would give a mesh, a wrong one.
void requireSameParts(const std::string& path, const std::vector<ExodusPart>& parts, const std::vector<std::string>& files,
                      std::size_t first, std::size_t count) {
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i].numParts != 1 && std::size_t(parts[i].numParts) != count)
      throw InputError("Mesh file '" + files[first + i] + "': it says that the mesh is in " + std::to_string(parts[i].numParts) +
                       " files, but '" + path + "' is in " + std::to_string(count) + "; decompose the mesh anew.");
}

}  // namespace

// NAME itself where it exists; else NAME.N.0 ... NAME.N.(N-1), all of them and of one N.
std::vector<std::string> listMeshFiles(const std::string& path) {
  std::error_code error;
  if (fs::exists(path, error)) return {path};
  const auto found = findParts(path);
  if (found.empty()) return {path};  // its absence is told by the reader
  const auto refuse = [&](const std::string& what) { throw InputError("Mesh file '" + path + "': " + what); };
  const auto& [count, parts] = *found.begin();
  if (found.size() > 1)
    refuse("there are decompositions into " + std::to_string(count) + " and into " + std::to_string(std::next(found.begin())->first) +
           " files; keep one of them.");
  std::vector<std::string> files;
  for (int i = 0; i < count; ++i) {
    if (parts.count(i) == 0)
      refuse("file " + std::to_string(i) + " of " + std::to_string(count) + " is missing, which would be called like '" +
             parts.begin()->second + "' with " + std::to_string(i) + " at the end.");
    files.push_back(parts.at(i));
  }
  return files;
}

// Rank 0 looks at the folder, which all ranks doing at once is hard on a file system, and tells the others what there is.
MeshShare readMeshFiles(const Communicator& comm, const std::string& path, const std::vector<std::string>& fields) {
  std::vector<std::string> files;
  runOnRoot(comm, [&] { files = listMeshFiles(path); });
  files = broadcasted(comm, files);
  if (files.size() == 1 && files[0] == path) return readExodusShare(comm, path, fields);

  const EvenRanges ranges{std::int64_t(files.size()), comm.getSize()};
  const auto first = std::size_t(ranges.begin(comm.getRank()));
  std::vector<ExodusPart> parts;
  runOnAllRanks(comm, [&] {
    for (std::int64_t i = 0; i < ranges.count(comm.getRank()); ++i) parts.push_back(readExodusPart(files[first + std::size_t(i)], fields));
    requireSameParts(path, parts, files, first, files.size());
  });
  return joinParts(comm, path, std::move(parts));
}

}  // namespace Haptos
