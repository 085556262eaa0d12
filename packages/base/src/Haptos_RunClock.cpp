// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RunClock.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <Teuchos_CommHelpers.hpp>
#include <algorithm>
#include <chrono>

namespace Haptos {

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

const char* phaseName(Phase phase) {
  static const char* const names[numPhases] = {"read",   "decompose", "assemble", "factor",
                                               "coarse", "solve",     "recover",  "write"};
  return names[std::size_t(phase)];
}

RunClock::RunClock() : RunClock(wallSeconds) {}

RunClock::RunClock(Now now) : now_(std::move(now)), start_(now_()), lastChange_(start_), sentBefore_(communicationSoFar()) {}

RunClock::Scope::~Scope() {
  if (clock_) clock_->stop();
}

// A phase within another stops that one's clock until it ends.
RunClock::Scope RunClock::time(Phase phase) {
  credit();
  running_.push_back(phase);
  return Scope(*this);
}

// Since the last change the innermost phase ran: phases may be nested, no second counts twice.
void RunClock::credit() {
  const double now = now_();
  const CommunicationCounts sent = communicationSoFar();
  if (!running_.empty()) {
    seconds_[std::size_t(running_.back())] += now - lastChange_;
    sent_[std::size_t(running_.back())] += sent - sentBefore_;
  }
  lastChange_ = now;
  sentBefore_ = sent;
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

// The slowest rank of each phase: their sum is more than the total where ranks wait for each other in different phases.
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

namespace {

constexpr int kNumbers = 5;  // of one CommunicationCounts

std::array<long long, kNumbers> packed(const CommunicationCounts& c) {
  return {c.reductions, c.collectives, c.messages, c.messageBytes, c.collectiveBytes};
}

CommunicationCounts unpacked(const long long* n) { return {long(n[0]), long(n[1]), long(n[2]), n[3], n[4]}; }

}  // namespace

// The counts so far come first: what this call itself sends is not in them.
std::vector<CommunicationCounts> gatherCommunication(const Communicator& comm, const CommunicationCounts& mine) {
  const auto numbers = packed(mine);
  std::vector<long long> all(kNumbers * std::size_t(comm.getSize()));
  Teuchos::gatherAll(comm, kNumbers, numbers.data(), int(all.size()), all.data());
  std::vector<CommunicationCounts> ofRank;
  for (int r = 0; r < comm.getSize(); ++r) ofRank.push_back(unpacked(all.data() + kNumbers * r));
  return ofRank;
}

// Ranks one by one for the whole run; for a phase the largest of them is enough, and one reduction for all.
CommunicationReport RunClock::communication(const Communicator& comm) const {
  CommunicationReport report;
  report.isCounted = isCommunicationCounted();
  report.ofRank = gatherCommunication(comm, communicationSoFar());
  std::array<long long, kNumbers * numPhases> mine{}, largest{};
  for (std::size_t i = 0; i < numPhases; ++i) {
    const auto numbers = packed(sent_[i]);
    std::copy(numbers.begin(), numbers.end(), mine.begin() + kNumbers * i);
  }
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, int(mine.size()), mine.data(), largest.data());
  for (std::size_t i = 0; i < numPhases; ++i) report.largestOfPhase[i] = unpacked(largest.data() + kNumbers * i);
  return report;
}

// Of this process since its start; memory that is let go does not lower it.
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
