// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "Haptos_Communication.hpp"

namespace Haptos {

/// \brief One step of a method.
struct HistoryEntry {
  long hessianMultiplications;
  double residual;
  long stick, slip, open;
  CommunicationCounts sent = communicationSoFar();  ///< by this rank, from the start of the program to this entry
};

/// \brief Pairs that the method keeps from step to step.
struct SubspaceReport {
  long pairs = 0;        ///< the most at one time
  int compressions = 0;  ///< how often the limit was reached and old pairs were dropped
  double memoryMb = 0;   ///< on the rank with most
};

/// \brief The deflated preconditioner, zeros where there is none.
struct DeflationReport {
  int motions = 0;        ///< its coarse vectors
  long applications = 0;  ///< beside those of the other preconditioner
};

}  // namespace Haptos
