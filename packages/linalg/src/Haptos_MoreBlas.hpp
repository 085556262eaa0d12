// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace Haptos::Blas {

// What Teuchos::BLAS has not.  Vectors are contiguous, matrices stored by columns, of symmetric and triangular ones the lower half.

// y := A x, A [n x n] packed
void spmv(int n, const double* A, const double* x, double* y);
void spmv(int n, const float* A, const float* x, float* y);

// C [n x n] += alpha (A B^T + B A^T), A and B [n x k]
void syr2k(int n, int k, double alpha, const double* A, int lda, const double* B, int ldb, double* C, int ldc);

// x := L^-1 x, or L^-T x if transposed, L [n x n]
void trsv(bool transposed, int n, const double* L, double* x);

// The same, L packed
void tpsv(bool transposed, int n, const double* L, double* x);
void tpsv(bool transposed, int n, const float* L, float* x);

}  // namespace Haptos::Blas
