// SPDX-License-Identifier: BSD-3-Clause
// Times of one factor and its solves on bricks of p^3 hexahedra.  Usage: bench_feti_local_solver [p ...]
#include <Tpetra_Core.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <vector>

#include "Haptos_SurfaceSchur.hpp"
#include "Haptos_LocalSolver.hpp"
#include "TestSubdomain.hpp"

using namespace Haptos;
using namespace Haptos::Testing;

namespace {

/// Seconds per call, over at least 0.2 s.
template <class Work>
double seconds(Work&& work) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  int calls = 0;
  double elapsed = 0;
  do {
    work();
    ++calls;
    elapsed = std::chrono::duration<double>(Clock::now() - start).count();
  } while (elapsed < 0.2);
  return elapsed / calls;
}

// A solve with one right-hand side where the factors of many subdomains take turns and none stays in the cache.
double coldSolve(const TestSubdomain& s, LocalSolverMethod method, std::size_t entries) {
  constexpr std::size_t kBytes = 200u << 20;
  const std::size_t count = std::max<std::size_t>(2, kBytes / (8 * entries));
  std::vector<std::unique_ptr<LocalSolver>> solvers;
  for (std::size_t i = 0; i < count; ++i) {
    solvers.push_back(std::make_unique<LocalSolver>(s.K, s.kernel, s.coordinates, method));
    solvers.back()->releaseMatrix();
  }
  const Dense b = Dense::Random(s.K.rows(), 1);
  Dense x(b.rows(), 1);
  return seconds([&] {
           for (const auto& solver : solvers) solver->solve(b, x);
         }) /
         double(count);
}

void benchmark(int p, LocalSolverMethod method) {
  const auto mesh = boxMesh({p, p, p}, {1, 1, 1}, 0.1);
  const auto s = makeSubdomain(mesh, allElements(mesh), 2e11, 0.3);
  const auto n = s.K.rows();
  const double factor = seconds([&] { LocalSolver(s.K, s.kernel, s.coordinates, method); });
  const LocalSolver solver(s.K, s.kernel, s.coordinates, method);
  const LocalSolverFactor bare(Sparse(solver.regularized()), method);

  const Dense B = Dense::Random(n, 300);
  Dense X(n, 300);
  const double one = seconds([&] { solver.solve(B.leftCols(1), X.leftCols(1)); });
  const double oneBare = seconds([&] { bare.solve(B.leftCols(1), X.leftCols(1)); });
  const double many = seconds([&] { solver.solve(B, X); });
  const double cold = coldSolve(s, method, solver.factorEntries());
  std::printf("%2d %6d  %-8s factor %9.2e  solve %9.2e (without projections %9.2e, cold %9.2e)  300 columns %9.2e  entries %9zu",
              p, int(n), solver.methodName(), factor, one, oneBare, cold, many, solver.factorEntries());

  std::vector<int> boundary;
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node) {
    const int q = p + 1, i = int(node) % q, j = int(node) / q % q, k = int(node) / q / q;
    if (i * j * k == 0 || i == p || j == p || k == p)
      for (int c = 0; c < 3; ++c) boundary.push_back(3 * int(node) + c);
  }
  const double schurFactor = seconds([&] { SurfaceSchur(s.K, s.kernel, boundary, method); });
  const SurfaceSchur schur(s.K, s.kernel, boundary, method);
  const Dense x = Dense::Random(schur.size(), 1);
  Dense y(schur.size(), 1);
  std::printf("  Schur: factor %9.2e  apply %9.2e", schurFactor, seconds([&] { schur.apply(x, y); }));
  if (p <= 8) std::printf("  dense %9.2e", seconds([&] { schur.dense(); }));
  std::printf("\n");
}

}  // namespace

int main(int argc, char* argv[]) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  for (int a = 1; a < argc; ++a) {
    const int p = std::atoi(argv[a]);
    if (hasCholmod()) benchmark(p, LocalSolverMethod::Cholmod);
    if (p <= 12) benchmark(p, LocalSolverMethod::Klu2);
  }
}
