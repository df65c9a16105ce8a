#include <algorithm>
#include <cmath>

#include "retalho/tin/greedy_scan.h"

namespace retalho::greedy {
#include "retalho/tin/greedy_scan.inc"

template <class Height>
void scan_generic(const ScanField<Height>& field, Record& t) {
  scan(field, t);
}
template void scan_generic(const ScanField<float>&, Record&);
template void scan_generic(const ScanField<double>&, Record&);

template <class Height>
Scan<Height> choose_scan() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return scan_avx2<Height>;
#endif
  return scan_generic<Height>;
}
template Scan<float> choose_scan();
template Scan<double> choose_scan();

}  // namespace retalho::greedy
