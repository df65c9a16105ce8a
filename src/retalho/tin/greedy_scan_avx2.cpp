// Compiled with AVX2 where the compiler has it (src/CMakeLists.txt); called only on machines that have it.
#ifdef __AVX2__
#include <immintrin.h>
#endif

#include <algorithm>
#include <cmath>

#include "retalho/tin/greedy_scan.h"

namespace retalho::greedy {
#ifdef __AVX2__
#define RETALHO_SCAN_LANES
#endif
#include "retalho/tin/greedy_scan.inc"

template <class Height>
void scan_avx2(const ScanField<Height>& field, Record& t) {
  scan(field, t);
}
template void scan_avx2(const ScanField<float>&, Record&);
template void scan_avx2(const ScanField<double>&, Record&);

}  // namespace retalho::greedy
