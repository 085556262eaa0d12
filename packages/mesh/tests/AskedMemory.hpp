// SPDX-License-Identifier: BSD-3-Clause
// What operator new is asked for on two and on four ranks.  Replaces it: in one unit of a program.
#pragma once
#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultComm.hpp>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <new>

#include "MeshTestTools.hpp"

namespace HaptosTest {

inline std::size_t largest = 0, total = 0;

inline void* countedNew(std::size_t size) noexcept {
  largest = std::max(largest, size);
  total += size;
  return std::malloc(size);
}

inline void* countedNewOrThrow(std::size_t size) {
  if (void* p = countedNew(size)) return p;
  throw std::bad_alloc();
}

}  // namespace HaptosTest

void* operator new(std::size_t size) { return HaptosTest::countedNewOrThrow(size); }
void* operator new[](std::size_t size) { return HaptosTest::countedNewOrThrow(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return HaptosTest::countedNew(size); }  // temporary buffers of std::stable_sort
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return HaptosTest::countedNew(size); }
void operator delete(void* p) noexcept { std::free(p); }
void operator delete[](void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }
void operator delete[](void* p, std::size_t) noexcept { std::free(p); }

namespace HaptosTest {

/// [bytes], the most of any rank.
struct Asked {
  double largest, total;
};

inline Asked count(const Haptos::Communicator& comm, const std::function<void()>& work) {
  comm.barrier();
  largest = total = 0;
  work();
  const double mine[2] = {double(largest), double(total)};
  double most[2];
  Teuchos::reduceAll(comm, Teuchos::REDUCE_MAX, 2, mine, most);
  return {most[0], most[1]};
}

/// `work` on the first two ranks and on all four.
inline std::array<Asked, 2> onTwoAndFour(const std::function<void(const Teuchos::RCP<const Haptos::Communicator>&)>& work) {
  const auto half = world().split(world().getRank() < 2 ? 0 : -1, world().getRank());
  std::array<Asked, 2> asked{};
  if (world().getRank() < 2) asked[0] = count(*half, [&] { work(half); });
  const Teuchos::RCP<const Haptos::Communicator> all = Teuchos::DefaultComm<int>::getComm();
  asked[1] = count(*all, [&] { work(all); });
  double two[2] = {asked[0].largest, asked[0].total};
  Teuchos::broadcast(world(), 0, 2, two);
  asked[0] = {two[0], two[1]};
  return asked;
}

}  // namespace HaptosTest
