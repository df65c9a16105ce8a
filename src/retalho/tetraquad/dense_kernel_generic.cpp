#include "retalho/tetraquad/dense_kernel.h"

#define RETALHO_LANES 2
#define RETALHO_ROWS 2
#define RETALHO_COLUMNS 4
#define RETALHO_KERNEL dense_product_generic
#include "retalho/tetraquad/dense_kernel.inc"
