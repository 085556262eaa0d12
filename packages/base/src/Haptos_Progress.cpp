// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Progress.hpp"

#include <unistd.h>

#include <Teuchos_Comm.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>
#include <string>
#include <system_error>

#include "Haptos_RunClock.hpp"

namespace Haptos {

namespace {

// Open MPI's mpirun gives its ranks a pseudo-terminal even where its own output goes to a file: what counts is where that
// goes.  Where another process than mpirun started this rank (on another node) nobody knows, and it is taken for a file.
bool endsOnTerminal() {
  if (isatty(STDOUT_FILENO) != 1) return false;
  if (!std::getenv("OMPI_COMM_WORLD_RANK")) return true;
  std::error_code error;
  const auto target = std::filesystem::read_symlink("/proc/" + std::to_string(getppid()) + "/fd/1", error).string();
  return !error && (target.rfind("/dev/pts/", 0) == 0 || target.rfind("/dev/tty", 0) == 0);
}

Progress::Options programOptions() {
  Progress::Options options;
  options.terminal = endsOnTerminal();
  return options;
}

}  // namespace

Progress::Progress(const Communicator& comm) : Progress(comm, programOptions()) {}

Progress::Progress(const Communicator& comm, Options options)
    : prints_(comm.getRank() == 0), options_(std::move(options)) {
  if (!options_.out) options_.out = &std::cout;
  if (!options_.err) options_.err = &std::cerr;
  if (!options_.now) options_.now = wallSeconds;
  start_ = options_.now();
  lastShown_ = -std::numeric_limits<double>::infinity();
}

Progress::~Progress() { finish(); }

std::string Progress::stamped(const std::string& text) const {
  char stamp[32];
  std::snprintf(stamp, sizeof(stamp), "[%8.1f s] ", options_.now() - start_);
  return stamp + text;
}

// A shorter text leaves the end of the longer one before it: blanks go over that.
void Progress::show(const std::string& text) {
  if (options_.terminal) {
    const std::size_t blanks = openLength_ > text.size() ? openLength_ - text.size() : 0;
    *options_.out << '\r' << text << std::string(blanks, ' ') << std::flush;
    openLength_ = text.size();
  } else {
    *options_.out << text << std::endl;
  }
  lastShown_ = options_.now();
  pending_.clear();
}

// What comes too soon waits, and is shown if nothing newer comes before the next line that stays.
void Progress::update(const std::string& text) {
  if (!prints_) return;
  const double interval = options_.terminal ? options_.terminalInterval : options_.logInterval;
  if (options_.now() - lastShown_ >= interval)
    show(stamped(text));
  else
    pending_ = stamped(text);
}

void Progress::line(const std::string& text) {
  if (!prints_) return;
  finish();
  *options_.out << stamped(text) << std::endl;
}

void Progress::warn(const std::string& text) {
  if (!prints_) return;
  finish();
  *options_.err << "haptos: warning: " << text << std::endl;
}

void Progress::finish() {
  if (!prints_) return;
  if (!pending_.empty()) show(pending_);
  if (openLength_ > 0) *options_.out << std::endl;
  openLength_ = 0;
}

}  // namespace Haptos
