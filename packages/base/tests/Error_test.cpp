// SPDX-License-Identifier: BSD-3-Clause
// What one rank throws all throw: of the same kind, with the same words.
#include "Haptos_Error.hpp"

#include <Teuchos_Comm.hpp>
#include <Teuchos_UnitTestHarness.hpp>
#include <Tpetra_Core.hpp>
#include <type_traits>

namespace {

using namespace Haptos;

/// The words of the `Kind` that all ranks get where the last one alone throws `error`; empty where they get another.
template <class Kind, class Thrown>
std::string wordsOnAll(const Thrown& error) {
  const Communicator& comm = *Tpetra::getDefaultComm();
  try {
    runOnAllRanks(comm, [&] {
      if (comm.getRank() == comm.getSize() - 1) throw error;
    });
  } catch (const Kind& e) {
    return e.what();
  } catch (...) {
  }
  return "";
}

}  // namespace

TEUCHOS_UNIT_TEST(Error, KeepsItsKindOnAllRanks) {
  TEST_EQUALITY(wordsOnAll<InputError>(InputError("the mesh has no nodes")), std::string("the mesh has no nodes"));
  TEST_EQUALITY(wordsOnAll<InsufficientModel>(InsufficientModel("body 2 is loose")), std::string("body 2 is loose"));
  TEST_EQUALITY(wordsOnAll<CollectiveError>(std::logic_error("a step is missing")), std::string("a step is missing"));
  TEST_EQUALITY(wordsOnAll<OutOfMemory>(OutOfMemory("a factor has no room")), std::string("a factor has no room"));
  TEST_EQUALITY(wordsOnAll<OutOfMemory>(std::bad_alloc()), std::string("out of memory"));
  TEST_NOTHROW(runOnAllRanks(*Tpetra::getDefaultComm(), [] {}));
}

// Who gives up a matrix that cannot be factored catches runtime errors: no memory is no singular matrix.
TEUCHOS_UNIT_TEST(Error, NoMemoryIsNoRuntimeError) {
  TEST_ASSERT(!(std::is_base_of_v<std::runtime_error, OutOfMemory>));
  TEST_ASSERT((std::is_base_of_v<std::bad_alloc, OutOfMemory>));
  TEST_EQUALITY(wordsOnAll<std::runtime_error>(std::bad_alloc()), std::string());
}
