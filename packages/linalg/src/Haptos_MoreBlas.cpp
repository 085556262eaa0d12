// SPDX-License-Identifier: BSD-3-Clause
// Without Eigen, precompiled or not: it declares some of these functions with other arguments.
#include "Haptos_MoreBlas.hpp"

extern "C" {
void dspmv_(const char* uplo, const int* n, const double* alpha, const double* ap, const double* x, const int* incx,
            const double* beta, double* y, const int* incy);
void sspmv_(const char* uplo, const int* n, const float* alpha, const float* ap, const float* x, const int* incx,
            const float* beta, float* y, const int* incy);
void dsyr2k_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha, const double* a,
             const int* lda, const double* b, const int* ldb, const double* beta, double* c, const int* ldc);
void dtrsv_(const char* uplo, const char* trans, const char* diag, const int* n, const double* a, const int* lda, double* x,
            const int* incx);
void dtpsv_(const char* uplo, const char* trans, const char* diag, const int* n, const double* ap, double* x, const int* incx);
void stpsv_(const char* uplo, const char* trans, const char* diag, const int* n, const float* ap, float* x, const int* incx);
}

namespace Haptos::Blas {
namespace {

const int kOne = 1;

const char* transposition(bool transposed) { return transposed ? "T" : "N"; }

}  // namespace

void spmv(int n, const double* A, const double* x, double* y) {
  const double one = 1, zero = 0;
  dspmv_("L", &n, &one, A, x, &kOne, &zero, y, &kOne);
}

void spmv(int n, const float* A, const float* x, float* y) {
  const float one = 1, zero = 0;
  sspmv_("L", &n, &one, A, x, &kOne, &zero, y, &kOne);
}

void syr2k(int n, int k, double alpha, const double* A, int lda, const double* B, int ldb, double* C, int ldc) {
  const double one = 1;
  dsyr2k_("L", "N", &n, &k, &alpha, A, &lda, B, &ldb, &one, C, &ldc);
}

void trsv(bool transposed, int n, const double* L, double* x) { dtrsv_("L", transposition(transposed), "N", &n, L, &n, x, &kOne); }

void tpsv(bool transposed, int n, const double* L, double* x) { dtpsv_("L", transposition(transposed), "N", &n, L, x, &kOne); }

void tpsv(bool transposed, int n, const float* L, float* x) { stpsv_("L", transposition(transposed), "N", &n, L, x, &kOne); }

}  // namespace Haptos::Blas
