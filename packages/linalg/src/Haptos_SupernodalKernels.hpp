// SPDX-License-Identifier: BSD-3-Clause
// Substitution with the supernodes of L for one right-hand side.  For SupernodalFactor only.
#pragma once
#include <cstring>
#include <vector>

#include "Haptos_Clones.hpp"
#include "Haptos_SupernodalFactor.hpp"

namespace Haptos {

constexpr int kRegister = 32;      // bytes

// Bytes of L between what is used and what is fetched.  L comes from memory once a solve: first to the second level, which
// has room for far more requests on their way than the first one, to which near bytes are fetched from there.
constexpr int kFar = 16384, kNear = 4096;

template <class Scalar>
struct Lanes {
  typedef Scalar Type __attribute__((vector_size(kRegister)));
  static constexpr int kCount = kRegister / int(sizeof(Scalar));
};

template <class Scalar>
HAPTOS_INLINE void storeSome(const typename Lanes<Scalar>::Type& v, int count, Scalar* to) {
  for (int lane = 0; lane < Lanes<Scalar>::kCount; ++lane)
    if (lane < count) to[lane] = v[lane];
}

/// The first lanes, zeros behind.
template <class Scalar>
HAPTOS_INLINE void loadSome(typename Lanes<Scalar>::Type& v, int count, const Scalar* from) {
  for (int lane = 0; lane < Lanes<Scalar>::kCount; ++lane) v[lane] = lane < count ? from[lane] : Scalar(0);
}

template <class Scalar>
HAPTOS_INLINE Scalar total(const typename Lanes<Scalar>::Type& v) {
  Scalar pairs[Lanes<Scalar>::kCount / 2];
  for (int i = 0; i < Lanes<Scalar>::kCount / 2; ++i) pairs[i] = v[i] + v[i + Lanes<Scalar>::kCount / 2];
  Scalar sum = 0;
  for (Scalar pair : pairs) sum += pair;
  return sum;
}

/// W columns of L at the same rows.
template <class Scalar, int W>
struct ColumnBlock {
  const Scalar* column[W];
};

/// \param next where the processor is, \param direction 1 or -1: that of the sweep
template <class Scalar, int W>
HAPTOS_INLINE void fetchAhead(const Scalar* next, int direction) {
  constexpr int kReading = 0, kSecondLevel = 2, kFirstLevel = 3;
  const char* at = reinterpret_cast<const char*>(next);
  for (int line = 0; line < W * kRegister; line += 64) {
    __builtin_prefetch(at + direction * kFar + line, kReading, kSecondLevel);
    __builtin_prefetch(at + direction * kNear + line, kReading, kFirstLevel);
  }
}

/// y -= A x, y [m], x [W].  Reads A and y to the end of a register, beyond their rows.
template <class Scalar, int W>
HAPTOS_INLINE void subtractProduct(int m, const ColumnBlock<Scalar, W>& A, const Scalar* x, Scalar* __restrict y) {
  using V = typename Lanes<Scalar>::Type;
  constexpr int kCount = Lanes<Scalar>::kCount;
  Scalar own[W];
  for (int k = 0; k < W; ++k) own[k] = x[k];
  for (int i = 0; i < m; i += kCount) {
    V sum, a;
    std::memcpy(&sum, y + i, sizeof sum);
    for (int k = 0; k < W; ++k) {
      std::memcpy(&a, A.column[k] + i, sizeof a);
      sum -= a * own[k];
    }
    fetchAhead<Scalar, W>(A.column[0] + W * i, 1);
    if (i + kCount <= m) std::memcpy(y + i, &sum, sizeof sum);
    else storeSome<Scalar>(sum, m - i, y + i);
  }
}

/// z -= A^T w, z [W], w [m].  Reads A to the end of a register.
template <class Scalar, int W>
HAPTOS_INLINE void subtractTransposed(int m, const ColumnBlock<Scalar, W>& A, const Scalar* w, Scalar* __restrict z) {
  using V = typename Lanes<Scalar>::Type;
  constexpr int kCount = Lanes<Scalar>::kCount;
  V sums[W] = {};
  for (int i = 0; i < m; i += kCount) {
    V a, b;
    if (i + kCount <= m) std::memcpy(&b, w + i, sizeof b);
    else loadSome<Scalar>(b, m - i, w + i);
    for (int k = 0; k < W; ++k) {
      std::memcpy(&a, A.column[k] + i, sizeof a);
      sums[k] += a * b;
    }
    fetchAhead<Scalar, W>(A.column[0] + W * i, -1);
  }
  for (int k = 0; k < W; ++k) z[k] -= total<Scalar>(sums[k]);
}

/// Columns j ... j + W of a triangle stored by columns from the diagonal down: the part on the diagonal, and what is below.
template <class Scalar, int W>
struct TriangleBlock {
  ColumnBlock<Scalar, W> corner, below;
  int rowsBelow;

  HAPTOS_INLINE TriangleBlock(int n, int j, const Scalar* T) : rowsBelow(n - j - W) {
    const Scalar* column = T + std::size_t(j) * std::size_t(2 * n - j + 1) / 2;
    for (int k = 0; k < W; ++k) {
      corner.column[k] = column;
      below.column[k] = column + (W - k);
      column += n - j - k;
    }
  }
};

template <class Scalar, int W>
HAPTOS_INLINE void forwardBlock(int n, int j, const Scalar* T, Scalar* x) {
  const TriangleBlock<Scalar, W> block(n, j, T);
  Scalar own[W];
  for (int k = 0; k < W; ++k) own[k] = x[j + k];
#pragma GCC unroll 6
  for (int k = 0; k < W; ++k) {
    own[k] *= block.corner.column[k][0];
#pragma GCC unroll 6
    for (int l = k + 1; l < W; ++l) own[l] -= block.corner.column[k][l - k] * own[k];
  }
  for (int k = 0; k < W; ++k) x[j + k] = own[k];
  subtractProduct<Scalar, W>(block.rowsBelow, block.below, own, x + j + W);
}

template <class Scalar, int W>
HAPTOS_INLINE void backwardBlock(int n, int j, const Scalar* T, Scalar* x) {
  const TriangleBlock<Scalar, W> block(n, j, T);
  Scalar own[W];
  for (int k = 0; k < W; ++k) own[k] = x[j + k];
  subtractTransposed<Scalar, W>(block.rowsBelow, block.below, x + j + W, own);
#pragma GCC unroll 6
  for (int k = W - 1; k >= 0; --k) {
#pragma GCC unroll 6
    for (int l = k + 1; l < W; ++l) own[k] -= block.corner.column[k][l - k] * own[l];
    own[k] *= block.corner.column[k][0];
  }
  for (int k = 0; k < W; ++k) x[j + k] = own[k];
}

template <class Scalar, int W>
HAPTOS_INLINE ColumnBlock<Scalar, W> rectangleBlock(const Scalar* R, int rows, int j) {
  ColumnBlock<Scalar, W> block;
  for (int k = 0; k < W; ++k) block.column[k] = R + std::size_t(rows) * std::size_t(j + k);
  return block;
}

/// Where blocks of six columns (two nodes), of three, and single columns end.
struct Blocks {
  int six, three;
  HAPTOS_INLINE explicit Blocks(int n) : six(n - n % 6), three(n - n % 3) {}
};

template <class Scalar>
struct FactorView {
  const std::vector<Supernode>& nodes;
  const Scalar* entries;
  const int* rowsBelow;
};

/// A supernode's parts: n columns with the triangle T and the rectangle R of m rows, and its own entries of x.
template <class Scalar>
struct NodeParts {
  const int n, m;
  const Blocks end;
  const Scalar *T, *R;
  const int* rows;
  Scalar* own;

  HAPTOS_INLINE NodeParts(const FactorView<Scalar>& L, const Supernode& node, Scalar* x)
      : n(node.columns), m(node.storedRows), end(n), T(L.entries + node.triangle), R(L.entries + node.rectangle),
        rows(L.rowsBelow + node.rows), own(x + node.first) {}
};

template <class Scalar>
HAPTOS_INLINE void forwardNode(const FactorView<Scalar>& L, const Supernode& node, Scalar* x, Scalar* work) {
  const auto& [n, m, end, T, R, rows, own] = NodeParts<Scalar>(L, node, x);
  for (int j = 0; j < end.six; j += 6) forwardBlock<Scalar, 6>(n, j, T, own);
  for (int j = end.six; j < end.three; j += 3) forwardBlock<Scalar, 3>(n, j, T, own);
  for (int j = end.three; j < n; ++j) forwardBlock<Scalar, 1>(n, j, T, own);
  for (int i = 0; i < m; ++i) work[i] = x[rows[i]];
  for (int j = 0; j < end.six; j += 6) subtractProduct<Scalar, 6>(m, rectangleBlock<Scalar, 6>(R, m, j), own + j, work);
  for (int j = end.six; j < end.three; j += 3) subtractProduct<Scalar, 3>(m, rectangleBlock<Scalar, 3>(R, m, j), own + j, work);
  for (int j = end.three; j < n; ++j) subtractProduct<Scalar, 1>(m, rectangleBlock<Scalar, 1>(R, m, j), own + j, work);
  for (int i = 0; i < m; ++i) x[rows[i]] = work[i];
}

template <class Scalar>
HAPTOS_INLINE void backwardNode(const FactorView<Scalar>& L, const Supernode& node, Scalar* x, Scalar* work) {
  const auto& [n, m, end, T, R, rows, own] = NodeParts<Scalar>(L, node, x);
  for (int i = 0; i < m; ++i) work[i] = x[rows[i]];
  for (int j = n - 1; j >= end.three; --j) subtractTransposed<Scalar, 1>(m, rectangleBlock<Scalar, 1>(R, m, j), work, own + j);
  for (int j = end.three - 3; j >= end.six; j -= 3) subtractTransposed<Scalar, 3>(m, rectangleBlock<Scalar, 3>(R, m, j), work, own + j);
  for (int j = end.six - 6; j >= 0; j -= 6) subtractTransposed<Scalar, 6>(m, rectangleBlock<Scalar, 6>(R, m, j), work, own + j);
  for (int j = n - 1; j >= end.three; --j) backwardBlock<Scalar, 1>(n, j, T, own);
  for (int j = end.three - 3; j >= end.six; j -= 3) backwardBlock<Scalar, 3>(n, j, T, own);
  for (int j = end.six - 6; j >= 0; j -= 6) backwardBlock<Scalar, 6>(n, j, T, own);
}

/// x := L^-1 x; x [n + kCount], zeros behind: the rows of padding point to the first of them.
template <class Scalar>
HAPTOS_INLINE void sweepForward(const FactorView<Scalar>& L, Scalar* x, Scalar* work) {
  for (const Supernode& node : L.nodes) forwardNode(L, node, x, work);
}

/// x := L^-T x, x as above.
template <class Scalar>
HAPTOS_INLINE void sweepBackward(const FactorView<Scalar>& L, Scalar* x, Scalar* work) {
  for (auto node = L.nodes.rbegin(); node != L.nodes.rend(); ++node) backwardNode(L, *node, x, work);
}

}  // namespace Haptos
