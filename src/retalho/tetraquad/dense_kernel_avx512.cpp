#if defined(__x86_64__)
#include <immintrin.h>

#include "retalho/tetraquad/dense_kernel.h"

#define RETALHO_LANES 8
#define RETALHO_ROWS 3
#define RETALHO_COLUMNS 8
#define RETALHO_FMA(a, b, c) _mm512_fmadd_pd(a, b, c)
#define RETALHO_KERNEL dense_product_avx512
#include "retalho/tetraquad/dense_kernel.inc"
#endif
