// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace Haptos {

/// \brief A file of its own name beside `path`; removed at the end of its life unless it was renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& path) : name_(path + ".XXXXXX") {
    const int descriptor = mkstemp(name_.data());
    if (descriptor >= 0)
      ::close(descriptor);
    else
      name_.clear();
  }
  ~TemporaryFile() {
    std::error_code ignored;
    if (!name_.empty()) std::filesystem::remove(name_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  bool exists() const { return !name_.empty(); }
  const std::string& name() const { return name_; }

  /// \return false if the system refuses.
  bool renameTo(const std::string& path) {
    std::error_code error;
    // mkstemp gives the file to its owner alone; a result has the permissions of any new file.
    const auto mask = ::umask(0);
    ::umask(mask);
    std::filesystem::permissions(name_, std::filesystem::perms(0666 & ~mask), error);
    std::filesystem::rename(name_, path, error);
    if (!error) name_.clear();
    return !error;
  }

 private:
  std::string name_;
};

}  // namespace Haptos
