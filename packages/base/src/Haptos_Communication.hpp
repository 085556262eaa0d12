// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Teuchos {
template <class Ordinal>
class Comm;
}  // namespace Teuchos

namespace Haptos {

using Communicator = Teuchos::Comm<int>;

/// \brief What this rank has sent, as handed to MPI; calls among one rank alone are not counted.
///
/// A collective call's bytes are the payload that this rank contributes, once: what MPI makes of it inside
/// (a tree sends it about log2(ranks) times) depends on the MPI library and is not counted.
struct CommunicationCounts {
  long reductions = 0;           ///< calls in which something of all ranks is combined or gathered
  long collectives = 0;          ///< other collective calls: broadcasts, scatters, all-to-all, barriers
  long messages = 0;             ///< point-to-point, to other ranks
  long long messageBytes = 0;    ///< of `messages`
  long long collectiveBytes = 0; ///< of `reductions` and `collectives`

  long long bytesSent() const { return messageBytes + collectiveBytes; }
  CommunicationCounts& operator+=(const CommunicationCounts& other);
};

/// \brief What was sent between two moments.
CommunicationCounts operator-(CommunicationCounts later, const CommunicationCounts& earlier);

/// \brief Where the counts come from.  A program that counts sets it; without it nothing is counted.
///
/// The library does not come between an application and its MPI; a program of its own does (drivers/Haptos_MpiCounter).
void setCommunicationSource(CommunicationCounts (*source)());

bool isCommunicationCounted();
CommunicationCounts communicationSoFar();  ///< zeros if nothing counts

}  // namespace Haptos
