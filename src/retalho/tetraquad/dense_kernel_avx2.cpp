#if defined(__x86_64__)
#include <immintrin.h>

#include "retalho/tetraquad/dense_kernel.h"

#define RETALHO_LANES 4
#define RETALHO_ROWS 2
#define RETALHO_COLUMNS 6
#define RETALHO_FMA(a, b, c) _mm256_fmadd_pd(a, b, c)
#define RETALHO_KERNEL dense_product_avx2
#include "retalho/tetraquad/dense_kernel.inc"
#endif
