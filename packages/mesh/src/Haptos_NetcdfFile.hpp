// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <functional>
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

/// \brief Whether a file begins as one of the HDF5 library does.
bool isHdf5(const std::string& path);

/// \brief What a trial may take beyond what the process has.
struct TrialLimits {
  unsigned seconds;
  double bytes;  ///< of memory
};

/// \brief Whether `read` comes to its end in a copy of this process, within the limits.
///
/// A damaged file may end in a fault of the HDF5 library, or keep it looping: that shall be the copy's fate, not the run's.  The
/// copy uses neither MPI nor what this process has open, writes nothing and ends without the exit functions.
/// \throws InputError  that `read` threw there
bool survivesInChild(const std::function<void()>& read, const TrialLimits& limits);

}  // namespace Haptos
