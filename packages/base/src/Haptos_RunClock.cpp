// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_RunClock.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <Teuchos_CommHelpers.hpp>
#include <algorithm>
#include <chrono>

#include "Haptos_Reductions.hpp"

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

std::array<long long, 6> numbersOf(const CommunicationCounts& c) {
  return {c.reductions, c.collectives, c.messages, c.messageBytes, c.collectiveBytes, c.bytesSent()};
}

namespace {

// Back from the first five.
CommunicationCounts countsOf(const long long* n) { return {long(n[0]), long(n[1]), long(n[2]), n[3], n[4]}; }

// Of every entry, in two reductions.
template <std::size_t n>
std::array<OverRanks, n> entriesOverRanks(const Communicator& comm, const std::array<double, n>& mine) {
  std::array<double, 2 * n> ends;  // the least is minus the largest of the negative ones
  for (std::size_t i = 0; i < n; ++i) ends[i] = mine[i], ends[n + i] = -mine[i];
  ends = largestOfAll(comm, ends);
  const auto sum = sumOfAll(comm, mine);
  std::array<OverRanks, n> entries;
  for (std::size_t i = 0; i < n; ++i) entries[i] = {-ends[n + i], sum[i] / comm.getSize(), ends[i]};
  return entries;
}

}  // namespace

// The slowest ranks of the phases may add up to more than the total, where ranks wait for each other in different phases.
PhaseTimes RunClock::overRanks(const Communicator& comm) const {
  std::array<double, numPhases + 1> mine;
  for (std::size_t i = 0; i < numPhases; ++i) mine[i] = seconds(Phase(i));
  mine[numPhases] = total();
  const auto entries = entriesOverRanks(comm, mine);
  PhaseTimes times;
  std::copy_n(entries.begin(), numPhases, times.seconds.begin());
  times.total = entries.back();
  return times;
}

// The counts so far come first: what this call itself sends is not in them.
CountsOverRanks gatherCommunication(const Communicator& comm, const CommunicationCounts& mine, int listedUpTo) {
  CountsOverRanks report;
  const auto numbers = numbersOf(mine);
  std::array<double, numbers.size()> values;
  std::copy(numbers.begin(), numbers.end(), values.begin());
  report.numbers = entriesOverRanks(comm, values);
  if (comm.getSize() > listedUpTo) return report;
  std::vector<long long> all(numbers.size() * std::size_t(comm.getSize()));
  Teuchos::gatherAll(comm, int(numbers.size()), numbers.data(), int(all.size()), all.data());
  for (auto n = all.begin(); n != all.end(); n += numbers.size()) report.ofRank.push_back(countsOf(&*n));
  return report;
}

// For a phase the largest of the ranks is enough, and one reduction for all.
CommunicationReport RunClock::communication(const Communicator& comm) const {
  CommunicationReport report;
  report.isCounted = isCommunicationCounted();
  report.run = gatherCommunication(comm, communicationSoFar());
  constexpr std::size_t size = std::tuple_size_v<decltype(numbersOf({}))>;
  std::array<long long, size * numPhases> mine;
  for (std::size_t i = 0; i < numPhases; ++i) {
    const auto numbers = numbersOf(sent_[i]);
    std::copy(numbers.begin(), numbers.end(), mine.begin() + size * i);
  }
  const auto largest = largestOfAll(comm, mine);
  for (std::size_t i = 0; i < numPhases; ++i) report.largestOfPhase[i] = countsOf(largest.data() + size * i);
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

MemoryReport gatherPeakMemoryMb(const Communicator& comm, int listedUpTo) {
  const std::array<double, 1> mine = {peakMemoryMb()};
  MemoryReport report{{}, entriesOverRanks(comm, mine)[0]};
  if (comm.getSize() > listedUpTo) return report;
  report.ofRank.resize(std::size_t(comm.getSize()));
  Teuchos::gatherAll(comm, 1, mine.data(), comm.getSize(), report.ofRank.data());
  return report;
}

}  // namespace Haptos
