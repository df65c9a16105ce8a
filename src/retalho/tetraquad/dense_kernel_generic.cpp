// For machines without AVX2 and FMA: where a processor has no fused multiply-add at all the C library works it out,
// some tens of times slower, to the same bits.
#include "retalho/tetraquad/dense_kernel.h"

#define RETALHO_LANES 2
#define RETALHO_ROWS 2
#define RETALHO_COLUMNS 4
#define RETALHO_FMA(a, b, c) (Register{__builtin_fma(a[0], b[0], c[0]), __builtin_fma(a[1], b[1], c[1])})
#define RETALHO_KERNEL dense_product_generic
#include "retalho/tetraquad/dense_kernel.inc"
