// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <exodusII.h>

namespace Haptos {

/// \brief An open Exodus file; closed at the end of its life.  For this package's .cpp files only.
class ExodusHandle {
 public:
  explicit ExodusHandle(int id) : id_(id) {}
  ~ExodusHandle() { close(); }
  ExodusHandle(const ExodusHandle&) = delete;
  ExodusHandle& operator=(const ExodusHandle&) = delete;

  bool isOpen() const { return id_ >= 0; }
  int id() const { return id_; }

  /// \return false if the library could not write the last of it.
  bool close() {
    const bool fine = id_ < 0 || ex_close(id_) >= 0;
    id_ = -1;
    return fine;
  }

 private:
  int id_;
};

}  // namespace Haptos
