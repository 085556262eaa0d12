// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "Haptos_Mesh.hpp"

namespace Haptos {

/// \brief Named fields of one load step, in the user's units.
struct ResultFields {
  using Field = std::pair<std::string, std::vector<double>>;
  std::vector<Field> nodal;                            ///< each [numNodes], by node index
  std::vector<Field> element;                          ///< each [numElements], over all blocks in their order
  std::vector<std::pair<std::string, double>> global;  ///< one value each
};

/// \brief Writes a mesh and its results, one time step per load step, as an Exodus II file.
///
/// Names, ids, node numbering and number maps are those of the mesh.  The file is classic netCDF with
/// 64-bit offsets, or, where `Mesh::wideIntegers` says so or a number asks for it, HDF5 with 64-bit
/// integers.  It grows under a temporary name in the same folder and gets its own name in `close()`:
/// an interrupted run leaves no file that could pass for a whole one.  Serial: use it on one rank.
class ExodusWriter {
 public:
  /// Writes the mesh; only its sizes are kept.
  /// \throws InputError         the folder is missing or not writable, or `path` is a folder.
  /// \throws std::runtime_error the file cannot be written (disk full, say).
  ExodusWriter(const std::string& path, const Mesh& mesh);

  /// Removes the temporary file unless `close` was called.
  ~ExodusWriter();
  ExodusWriter(const ExodusWriter&) = delete;
  ExodusWriter& operator=(const ExodusWriter&) = delete;

  /// Appends a step.  The first one fixes the names of the fields and their order.
  /// \throws std::logic_error   other names than in the first step, or an array of the wrong length.
  /// \throws std::runtime_error the file cannot be written.
  void writeStep(double time, const ResultFields& fields);

  /// Finishes the file and gives it its name; an older file of that name is replaced.
  /// \throws std::runtime_error the file cannot be written.
  void close();

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// \brief Writes a mesh without results.  Serial; throws as `ExodusWriter`.
void writeMesh(const std::string& path, const Mesh& mesh);

/// \brief Checks that `file` can be created: its folder exists and takes new files.  For use before the
/// solve.
/// \param parameterName what the user would change, say "Output->File".
/// \throws InputError
void requireWritableFolder(const std::string& file, const std::string& parameterName);

}  // namespace Haptos
