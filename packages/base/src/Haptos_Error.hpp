// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <new>
#include <stdexcept>
#include <string>

#include "Haptos_Communication.hpp"

namespace Haptos {

/// \brief The user's mistake (XML, mesh, physics): which parameter or entity, what is wrong, what would be right.
///
/// The driver prints the message once and ends with exit status 1.
class InputError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// \brief The problem has no solution, or the model is insufficient (a body that nothing holds).
///
/// The message names the body and the rigid motion; the driver ends with exit status 3.
class InsufficientModel : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// \brief Our own error, or one of the system, that was thrown on every rank: it is told once.
class CollectiveError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// \brief What is asked for has no room in memory.  No `std::runtime_error`: who gives up a matrix as singular must not take this for it.
class OutOfMemory : public std::bad_alloc {
 public:
  explicit OutOfMemory(const std::string& message) : message_(message) {}
  const char* what() const noexcept override { return message_.what(); }

 private:
  std::runtime_error message_;  // can be copied without throwing
};

/// \brief Throws `InputError` on every rank if any rank's `message` is not empty.  Collective.
///
/// The message thrown everywhere is that of the lowest rank that has one, so no rank throws alone
/// before a collective call.
void throwOnAllRanks(const Communicator& comm, const std::string& message);

/// \brief Rank of the caller in `comm` (spares users of this header the Teuchos communicator).
int commRank(const Communicator& comm);

/// \brief What `runOnRoot` caught, in a form that can be sent.  kind 0: nothing.
struct CaughtError {
  int kind = 0;  ///< 0 none, 1 InputError, 2 InsufficientModel, 3 other, 4 no memory
  std::string message;
};

/// \brief Turns the exception in flight into a `CaughtError`; call inside a catch block.
CaughtError describeCurrentException();

/// \brief Broadcasts `error` from `root`; if its kind is not 0 every rank throws it.  Collective.
void broadcastAndThrow(const Communicator& comm, CaughtError error, int root);

/// \brief Throws on every rank what the lowest rank with an `error` (kind not 0) has.  Collective.
void throwOnAllRanks(const Communicator& comm, const CaughtError& error);

/// \brief Runs `work`, which does not communicate, on all ranks; what it throws on any of them all throw.  Collective.
template <class Work>
void runOnAllRanks(const Communicator& comm, Work&& work) {
  CaughtError error;
  try {
    work();
  } catch (...) {
    error = describeCurrentException();
  }
  throwOnAllRanks(comm, error);
}

/// \brief Runs `work` on rank `root` only and rethrows there and everywhere what it threw.  Collective.
///
/// `InputError` and `InsufficientModel` keep their type, `std::bad_alloc` becomes an `OutOfMemory`, any other
/// exception a `CollectiveError` with the same text.
template <class Work>
void runOnRoot(const Communicator& comm, Work&& work, int root = 0) {
  CaughtError error;
  try {
    if (commRank(comm) == root) work();
  } catch (...) {
    error = describeCurrentException();
  }
  broadcastAndThrow(comm, error, root);
}

}  // namespace Haptos
