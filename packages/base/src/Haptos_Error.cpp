// SPDX-License-Identifier: BSD-3-Clause
#include "Haptos_Error.hpp"

#include <Teuchos_CommHelpers.hpp>

namespace Haptos {

int commRank(const Communicator& comm) { return comm.getRank(); }

// An exception as numbers and text, so that it can be sent: which of the kinds it was decides what the others throw.
CaughtError describeCurrentException() {
  try {
    throw;
  } catch (const InputError& e) {
    return {1, e.what()};
  } catch (const InsufficientModel& e) {
    return {2, e.what()};
  } catch (const OutOfMemory& e) {
    return {4, e.what()};
  } catch (const std::bad_alloc&) {
    return {4, "out of memory"};
  } catch (const std::exception& e) {
    return {3, e.what()};
  } catch (...) {
    return {3, "unknown exception"};
  }
}

// The root's error is thrown on all ranks as what it was, so that the program's exit status is the same everywhere.
void broadcastAndThrow(const Communicator& comm, CaughtError error, int root) {
  int header[2] = {error.kind, int(error.message.size())};
  Teuchos::broadcast(comm, root, 2, header);
  if (header[0] == 0) return;
  error.message.resize(header[1]);
  if (header[1] > 0) Teuchos::broadcast(comm, root, header[1], error.message.data());
  if (header[0] == 1) throw InputError(error.message);
  if (header[0] == 2) throw InsufficientModel(error.message);
  if (header[0] == 4) throw OutOfMemory(error.message);
  throw CollectiveError(error.message);
}

// The lowest rank with an error is the one that speaks.
void throwOnAllRanks(const Communicator& comm, const CaughtError& error) {
  const int mine = error.kind == 0 ? comm.getSize() : comm.getRank();
  int first = 0;
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MIN, mine, Teuchos::outArg(first));
  if (first < comm.getSize()) broadcastAndThrow(comm, error, first);
}

void throwOnAllRanks(const Communicator& comm, const std::string& message) {
  throwOnAllRanks(comm, CaughtError{message.empty() ? 0 : 1, message});
}

}  // namespace Haptos
