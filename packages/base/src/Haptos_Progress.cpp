// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Progress.hpp"

#include <unistd.h>

#include <Teuchos_Comm.hpp>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <limits>

#include "Haptos_RunClock.hpp"

namespace Haptos {

namespace {

Progress::Options programOptions() {
  Progress::Options options;
  // Open MPI's mpirun gives its ranks a pseudo-terminal even where its own output goes to a file.
  options.terminal = isatty(STDOUT_FILENO) == 1 && !std::getenv("OMPI_COMM_WORLD_RANK");
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
