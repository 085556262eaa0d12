// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>

namespace Haptos {

/// \brief Checks that `path` is a readable, whole netCDF file, as far as that shows without the library.
///
/// The netCDF library gives zeros for what lies beyond the end of a classic file, so that half a mesh
/// would be read as a mesh with its nodes at the origin; here the sizes in the header (classic, 64-bit
/// offset and 64-bit data variants of the format) are compared with the size of the file.  For files
/// based on HDF5 only the signature is checked, since that library finds missing bytes by itself.
/// \throws InputError  no such file, a folder, not readable, not netCDF, or cut short.
void requireWholeNetcdfFile(const std::string& path);

}  // namespace Haptos
