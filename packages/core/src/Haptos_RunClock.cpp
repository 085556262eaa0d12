// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RunClock.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <Teuchos_CommHelpers.hpp>
#include <chrono>

namespace Haptos {

namespace {

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

const char* phaseName(Phase phase) {
  static const char* const names[numPhases] = {"read",   "decompose", "assemble", "factor",
                                               "coarse", "solve",     "recover",  "write"};
  return names[std::size_t(phase)];
}

RunClock::RunClock() : RunClock(wallSeconds) {}

RunClock::RunClock(Now now) : now_(std::move(now)), start_(now_()), lastChange_(start_) {}

RunClock::Scope::~Scope() {
  if (clock_) clock_->stop();
}

RunClock::Scope RunClock::time(Phase phase) {
  credit();
  running_.push_back(phase);
  return Scope(*this);
}

void RunClock::credit() {
  const double now = now_();
  if (!running_.empty()) seconds_[std::size_t(running_.back())] += now - lastChange_;
  lastChange_ = now;
}

void RunClock::stop() {
  credit();
  running_.pop_back();
}

double RunClock::seconds(Phase phase) const {
  const bool isRunning = !running_.empty() && running_.back() == phase;
  return seconds_[std::size_t(phase)] + (isRunning ? now_() - lastChange_ : 0.0);
}

double RunClock::total() const { return now_() - start_; }

PhaseTimes RunClock::slowest(const Communicator& comm) const {
  std::array<double, numPhases + 1> mine, largest;
  for (std::size_t i = 0; i < numPhases; ++i) mine[i] = seconds(Phase(i));
  mine[numPhases] = total();
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, int(mine.size()), mine.data(), largest.data());
  PhaseTimes times;
  for (std::size_t i = 0; i < numPhases; ++i) times.seconds[i] = largest[i];
  times.total = largest[numPhases];
  return times;
}

double peakMemoryMb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
#ifdef __APPLE__
  return double(usage.ru_maxrss) / (1024.0 * 1024.0);  // bytes there, kilobytes elsewhere
#else
  return double(usage.ru_maxrss) / 1024.0;
#endif
}

double physicalMemoryBytes() { return double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE)); }

std::vector<double> gatherPeakMemoryMb(const Communicator& comm) {
  const double mine = peakMemoryMb();
  std::vector<double> all(std::size_t(comm.getSize()), 0.0);
  Teuchos::gatherAll(comm, 1, &mine, int(all.size()), all.data());
  return all;
}

}  // namespace Haptos
