// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "Haptos_MeshShare.hpp"
#include "Haptos_PlainTypes.hpp"

namespace Haptos {

/// \brief Named fields of one load step, in the user's units: what one rank has of them.
struct ResultFields {
  using Field = std::pair<std::string, std::vector<double>>;
  std::vector<Field> nodal;                            ///< each [nodes of this rank's range]
  std::vector<Field> element;                          ///< each [elements of this rank's range]
  std::vector<std::pair<std::string, double>> global;  ///< one value each; those of rank 0 are written
};

/// \brief Writes a mesh and its results, one time step per load step, as an Exodus II file.
///
/// Names, ids, node numbering and number maps are those of the mesh.  The file is classic netCDF with
/// 64-bit offsets, or, where `Mesh::wideIntegers` says so or a number asks for it, HDF5 with 64-bit
/// integers.  It grows under a temporary name in the same folder and gets its own name in `close()`:
/// an interrupted run leaves no file that could pass for a whole one.  Rank 0 writes; what the others have comes to it
/// in pieces, and it holds one of them at a time.  All methods are Collective, and what they throw they throw on all ranks.
class ExodusWriter {
 public:
  static constexpr std::size_t kPieceBytes = std::size_t(1) << 20;  ///< at most; a piece holds whole nodes or elements

  /// Writes the mesh; only its sizes are kept.
  /// \throws InputError      the folder is missing or not writable, or `path` is a folder.
  /// \throws InputError the file cannot be written (disk full, say).
  ExodusWriter(RCP<const Communicator> comm, const std::string& path, const MeshShare& mesh);

  /// Removes the temporary file unless `close` was called.
  ~ExodusWriter();
  ExodusWriter(const ExodusWriter&) = delete;
  ExodusWriter& operator=(const ExodusWriter&) = delete;

  /// Appends a step.  The first one fixes the names of the fields and their order.
  /// \throws CollectiveError other names than in the first step, an array of the wrong length; InputError the file cannot be written.
  void writeStep(double time, const ResultFields& fields);

  /// Finishes the file and gives it its name; an older file of that name is replaced.
  /// \throws InputError the file cannot be written.
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
