// Compiled with AVX2 where the compiler has it (src/CMakeLists.txt); called only on machines that have it.
#include <algorithm>
#include <cmath>

#include "retalho/tin/greedy_scan.h"

namespace retalho::greedy {
#define RETALHO_SCAN_LANES
#include "retalho/tin/greedy_scan.inc"

template <class Height>
void scan_avx2(const ScanField<Height>& field, Record& t) {
  scan(field, t);
}
template void scan_avx2(const ScanField<float>&, Record&);
template void scan_avx2(const ScanField<double>&, Record&);

}  // namespace retalho::greedy
