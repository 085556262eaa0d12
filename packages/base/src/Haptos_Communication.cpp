// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Communication.hpp"

namespace Haptos {

namespace {

CommunicationCounts (*countsOf)() = nullptr;

}  // namespace

CommunicationCounts& CommunicationCounts::operator+=(const CommunicationCounts& other) {
  reductions += other.reductions;
  collectives += other.collectives;
  messages += other.messages;
  messageBytes += other.messageBytes;
  collectiveBytes += other.collectiveBytes;
  return *this;
}

// What happened between two looks at the counters.
CommunicationCounts operator-(CommunicationCounts later, const CommunicationCounts& earlier) {
  later.reductions -= earlier.reductions;
  later.collectives -= earlier.collectives;
  later.messages -= earlier.messages;
  later.messageBytes -= earlier.messageBytes;
  later.collectiveBytes -= earlier.collectiveBytes;
  return later;
}

void setCommunicationSource(CommunicationCounts (*source)()) { countsOf = source; }

bool isCommunicationCounted() { return countsOf != nullptr; }

// Zeros where nobody counts: a library must not define MPI_* for its users (decisions/013).
CommunicationCounts communicationSoFar() { return countsOf ? countsOf() : CommunicationCounts{}; }

}  // namespace Haptos
