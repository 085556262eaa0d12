// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "Haptos_Communication.hpp"

namespace Haptos {

/// \brief The phases of a run, as the summary names them.
enum class Phase { Read, Decompose, Assemble, Factor, Coarse, Solve, Recover, Write };
inline constexpr std::size_t numPhases = 8;
const char* phaseName(Phase phase);  ///< "read", "decompose", ...

/// \brief A number that every rank has.
struct OverRanks {
  double least = 0, mean = 0, most = 0;
};

/// \brief Reports list numbers rank by rank up to so many ranks; beyond, least, mean and most are all that they hold.
inline constexpr int kMostListedRanks = 256;

/// \brief Wall seconds.
struct PhaseTimes {
  std::array<OverRanks, numPhases> seconds{};  ///< index: Phase
  OverRanks total;                             ///< since the clock was made
  double of(Phase phase) const { return seconds[std::size_t(phase)].most; }
};

/// \brief What the ranks sent.
struct CountsOverRanks {
  std::vector<CommunicationCounts> ofRank;  ///< [ranks]; empty on more than are listed
  std::array<OverRanks, 6> numbers;         ///< as `numbersOf` has them
};

/// \brief Reductions, other collectives, messages, message bytes, collective bytes, all bytes.
std::array<long long, 6> numbersOf(const CommunicationCounts& counts);

/// \brief What was sent, by rank and by phase.
struct CommunicationReport {
  bool isCounted = false;
  CountsOverRanks run;
  std::array<CommunicationCounts, numPhases> largestOfPhase;  ///< entry by entry the largest of the ranks
};

/// \brief Largest resident memory [MB = 2^20 bytes].
struct MemoryReport {
  std::vector<double> ofRank;  ///< [ranks]; empty on more than are listed
  OverRanks peak;
};

/// \brief Seconds of a steady clock, since any fixed moment.
double wallSeconds();

/// \brief Measures how long this rank spends, and what it sends, in every phase.
///
/// A phase that starts inside another one stops the outer one until it ends, so no second counts twice and
/// the phases add up to at most the total.
class RunClock {
 public:
  using Now = std::function<double()>;  ///< seconds since any fixed moment, never decreasing

  RunClock();
  explicit RunClock(Now now);

  /// \brief Ends its phase when it goes out of scope.
  class Scope {
   public:
    Scope(Scope&& other) noexcept : clock_(other.clock_) { other.clock_ = nullptr; }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    Scope& operator=(Scope&&) = delete;
    ~Scope();

   private:
    friend class RunClock;
    explicit Scope(RunClock& clock) : clock_(&clock) {}
    RunClock* clock_;
  };

  [[nodiscard]] Scope time(Phase phase);

  double seconds(Phase phase) const;  ///< [s] on this rank, a running phase included
  double total() const;               ///< [s] since construction

  /// \brief What this rank sent in a phase, without its running part.
  const CommunicationCounts& sent(Phase phase) const { return sent_[std::size_t(phase)]; }

  /// \brief The same on all ranks.  Collective.
  PhaseTimes overRanks(const Communicator& comm) const;

  /// \brief The same on all ranks; what it sends itself is not in it.  Collective.
  CommunicationReport communication(const Communicator& comm) const;

 private:
  void credit();  ///< gives the time and the messages since the last change to the innermost running phase
  void stop();

  Now now_;
  double start_, lastChange_;
  std::vector<Phase> running_;
  std::array<double, numPhases> seconds_{};
  CommunicationCounts sentBefore_;  // at the last change
  std::array<CommunicationCounts, numPhases> sent_;
};

/// \brief `mine` of every rank, the same on all.  Collective.
CountsOverRanks gatherCommunication(const Communicator& comm, const CommunicationCounts& mine, int listedUpTo = kMostListedRanks);

/// \brief Largest resident memory of this process so far [MB = 2^20 bytes].
double peakMemoryMb();

/// \brief Memory of this machine [bytes].
double physicalMemoryBytes();

/// \brief `peakMemoryMb` of every rank, the same on all.  Collective.
MemoryReport gatherPeakMemoryMb(const Communicator& comm, int listedUpTo = kMostListedRanks);

}  // namespace Haptos
