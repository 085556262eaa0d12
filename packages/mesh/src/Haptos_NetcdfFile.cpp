// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_NetcdfFile.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "Haptos_Error.hpp"

namespace Haptos {
namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw InputError("Mesh file '" + path + "': " + what);
}

/// \brief The dimensions that a variable of Exodus must have, by its name; '#' is the number behind that, "*" any, {} is not asked for.
///
/// That library reads a variable into the room for its own dimensions, and does not look whether it has those.
std::vector<std::string> dimensionsOf(const std::string& variable) {
  static const std::map<std::string, std::vector<std::string>> wanted = {
      {"coordx", {"num_nodes"}},           {"coordy", {"num_nodes"}},        {"coordz", {"num_nodes"}},
      {"coord", {"num_dim", "num_nodes"}}, {"coor_names", {"num_dim", "*"}}, {"connect", {"num_el_in_blk#", "num_nod_per_el#"}},
      {"eb_prop", {"num_el_blk"}},         {"eb_status", {"num_el_blk"}},    {"eb_names", {"num_el_blk", "*"}},
      {"ss_prop", {"num_side_sets"}},      {"ss_status", {"num_side_sets"}}, {"ss_names", {"num_side_sets", "*"}},
      {"ns_prop", {"num_node_sets"}},      {"ns_status", {"num_node_sets"}}, {"ns_names", {"num_node_sets", "*"}},
      {"elem_ss", {"num_side_ss#"}},       {"side_ss", {"num_side_ss#"}},    {"node_ns", {"num_nod_ns#"}},
      {"node_num_map", {"num_nodes"}},     {"elem_num_map", {"num_elem"}},   {"node_map", {"num_nodes"}},
      {"elem_map", {"num_elem"}}};
  const auto end = variable.find_last_not_of("0123456789") + 1;
  const auto found = wanted.find(variable.substr(0, end));
  if (found == wanted.end()) return {};
  auto names = found->second;
  for (auto& name : names)
    if (name.back() == '#') name.replace(name.size() - 1, 1, variable.substr(end));
  return names;
}

/// Attributes for which the library has room for one value.
bool isOneValue(const std::string& attribute) {
  static const std::set<std::string> names = {"api_version", "version", "floating_point_word_size", "file_size", "maximum_name_length",
                                              "int64_status"};
  return names.count(attribute) > 0;
}

/// \brief Header of a classic netCDF file: how many bytes the file must have at least.
///
/// Source: "The NetCDF Classic Format Specification" (Unidata).  Sizes are doubles, because a hostile
/// header may make their product overflow any integer; they are exact below 2^53.
class ClassicHeader {
 public:
  ClassicHeader(std::istream& in, int version, double fileSize)
      : in_(in), version_(version), fileSize_(fileSize) {}

  /// \brief Least number of bytes, or -1 if the header itself is cut short or makes no sense.
  double leastSize() {
    numRecords_ = count();
    // A count with all bits set means "not known" (a file still being streamed).
    if (numRecords_ == (version_ == 5 ? 18446744073709551615.0 : 4294967295.0)) numRecords_ = 0;
    readDimensions();
    skipAttributes();
    readVariables();
    return in_ && sane_ ? size() : -1.0;
  }

 private:
  struct Variable {
    double bytes;  ///< of one record, or of the whole of a fixed variable
    double begin;
    bool perRecord;
  };

  double integer(int bytes) {
    // Big-endian, whatever this machine is.
    std::array<char, 8> raw{};
    in_.read(raw.data(), bytes);
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i) value = (value << 8) | static_cast<unsigned char>(raw[std::size_t(i)]);
    return in_ ? double(value) : 0.0;
  }
  double count() { return integer(version_ == 5 ? 8 : 4); }

  /// Length of a list; one that the file cannot hold would keep us looping.
  double listLength() {
    integer(4);  // tag
    const double length = count();
    if (length > fileSize_) sane_ = false;
    return sane_ && in_ ? length : 0.0;
  }
  void skipPadded(double bytes) {
    if (bytes > fileSize_) sane_ = false;
    if (sane_) in_.ignore(std::streamsize((std::int64_t(bytes) + 3) / 4 * 4));
  }
  double bytesOfType() {
    constexpr std::array<int, 12> sizes = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};  // NC_BYTE is 1
    const double type = integer(4);
    if (type < 1 || type > 11) sane_ = false;
    return sane_ ? sizes[std::size_t(type)] : 0.0;
  }

  void readDimensions() {
    const double n = listLength();
    for (double i = 0; i < n && in_ && sane_; ++i) {
      auto name = readName();
      dimensions_.emplace_back(std::move(name), count());
    }
  }
  void skipAttributes() {
    const double n = listLength();
    for (double i = 0; i < n && in_ && sane_; ++i) {
      const std::string name = readName();
      const double bytes = bytesOfType(), values = count();
      if (isOneValue(name) && values != 1) sane_ = false;
      skipPadded(bytes * values);
    }
  }
  void readVariables() {
    const double n = listLength();
    for (double i = 0; i < n && in_ && sane_; ++i) readVariable();
  }
  std::string readName() {
    const double bytes = count();
    if (bytes > fileSize_) sane_ = false;
    if (!sane_ || !in_) return {};
    std::string name((std::size_t(bytes) + 3) / 4 * 4, '\0');
    in_.read(name.data(), std::streamsize(name.size()));
    return name.substr(0, std::size_t(bytes));
  }
  void readVariable() {
    const auto wanted = dimensionsOf(readName());
    Variable v{1.0, 0.0, false};
    const double rank = count();
    // The library would write past the end of its own arrays, see decisions/028.
    if (!wanted.empty() && rank != double(wanted.size())) sane_ = false;
    for (double i = 0; i < rank && in_ && sane_; ++i) {
      const double id = count();
      if (id >= double(dimensions_.size())) sane_ = false;
      if (!sane_) return;
      const auto& [name, length] = dimensions_[std::size_t(id)];
      if (!wanted.empty() && wanted[std::size_t(i)] != "*" && wanted[std::size_t(i)] != name) sane_ = false;
      if (i == 0 && length == 0)
        v.perRecord = true;  // length 0 marks the record dimension
      else
        v.bytes *= length;
    }
    skipAttributes();
    v.bytes *= bytesOfType();
    count();  // the stored size: wrong by design for variables above 4 GB
    v.begin = integer(version_ == 1 ? 4 : 8);
    variables_.push_back(v);
  }

  double size() const {
    double record = 0.0, least = 0.0;
    for (const auto& v : variables_)
      if (v.perRecord) record += v.bytes;
    for (const auto& v : variables_) {
      if (!v.perRecord)
        least = std::max(least, v.begin + v.bytes);
      else if (numRecords_ > 0)
        // Records of all variables lie interleaved: the last one begins numRecords - 1 of them further on.
        least = std::max(least, v.begin + (numRecords_ - 1) * record + v.bytes);
    }
    return least;
  }

  std::istream& in_;
  int version_;
  double fileSize_, numRecords_ = 0.0;
  bool sane_ = true;
  std::vector<std::pair<std::string, double>> dimensions_;
  std::vector<Variable> variables_;
};

/// Of data, beyond what this process has; in pages behind the fifth number of statm, see proc(5).
void limitMemory(double bytes) {
  std::ifstream statm("/proc/self/statm");
  double pages = 0;
  for (int i = 0; i < 6; ++i) statm >> pages;
  if (!statm) return;  // not Linux
  const auto most = rlim_t(pages * double(sysconf(_SC_PAGESIZE)) + bytes);
  const rlimit data{most, most};
  setrlimit(RLIMIT_DATA, &data);
}

// Before anything is opened: a folder or a device would be read until something breaks.
void checkKind(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const auto status = fs::status(path, error);
  if (path.empty() || !fs::exists(status)) refuse(path, "there is no such file.");
  if (fs::is_directory(status)) refuse(path, "this is a folder; an Exodus II file is wanted.");
  if (!fs::is_regular_file(status)) refuse(path, "this is not a regular file.");
}

/// In the copy: a trial.  What is wrong with the input is written to `messages`.
[[noreturn]] void readAndExit(const std::function<void()>& read, const TrialLimits& limits, int messages) {
  // MPI and Kokkos may have handlers that print, or wait for a debugger; a child dies in silence, and leaves no core.
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM, SIGPIPE}) std::signal(signal, SIG_DFL);
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  dup2(::open("/dev/null", O_WRONLY), STDERR_FILENO);
  alarm(limits.seconds);
  limitMemory(limits.bytes);
  int status = 0;
  try {
    read();
  } catch (const InputError& e) {
    const std::string what = e.what();
    if (write(messages, what.data(), what.size()) != ssize_t(what.size())) status = 1;
  } catch (const std::exception&) {
    status = 1;
  }
  // Not exit: handlers of MPI and of open files belong to the parent.
  _exit(status);
}

std::string textFrom(int descriptor) {
  std::string text;
  std::array<char, 4096> part{};
  for (ssize_t n = 0; (n = ::read(descriptor, part.data(), part.size())) > 0 || (n < 0 && errno == EINTR);)
    if (n > 0) text.append(part.data(), std::size_t(n));
  return text;
}

}  // namespace

bool isHdf5(const std::string& path) {
  std::array<char, 8> magic{};
  return bool(std::ifstream(path, std::ios::binary).read(magic.data(), 8)) && std::string(magic.data(), 8) == "\x89HDF\r\n\x1a\n";
}

bool survivesInChild(const std::function<void()>& read, const TrialLimits& limits) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return true;
  const pid_t child = fork();
  if (child == 0) readAndExit(read, limits, ends[1]);
  close(ends[1]);
  const std::string message = child < 0 ? "" : textFrom(ends[0]);
  close(ends[0]);
  if (child < 0) return true;  // no room for a copy: then without a trial
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!message.empty()) throw InputError(message);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// By what the header of a classic file asks for; HDF5 files know their length themselves.
void requireWholeNetcdfFile(const std::string& path) {
  checkKind(path);
  std::ifstream in(path, std::ios::binary);
  if (!in) refuse(path, "the file cannot be opened for reading; are its permissions right?");
  const double fileSize = double(std::filesystem::file_size(path));
  if (fileSize == 0) refuse(path, "the file is empty.");

  std::array<char, 8> magic{};
  in.read(magic.data(), 4);
  const int version = magic[3];
  const bool classic =
      std::string(magic.data(), 3) == "CDF" && (version == 1 || version == 2 || version == 5);
  if (!classic) {
    if (isHdf5(path)) return;
    refuse(path, "this is not an Exodus II file (neither netCDF nor HDF5 by its first bytes).");
  }
  const double least = ClassicHeader(in, version, fileSize).leastSize();
  if (least < 0) refuse(path, "the netCDF header is cut short or damaged.");
  if (fileSize < least)
    refuse(path, "the file is cut short: it has " + std::to_string(std::int64_t(fileSize)) +
                     " bytes where its header asks for " +
                     (least < 9e15 ? std::to_string(std::int64_t(least)) : std::string("more than 9e15")) +
                     ".");
}

}  // namespace Haptos
