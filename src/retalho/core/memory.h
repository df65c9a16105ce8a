// How much memory there is, and whether work fits into it: refused before anything is allocated.
#pragma once

#include <cstdint>
#include <string>

namespace retalho {

/// Bytes that this process can still take without swapping: the least of what the machine has available, what the
/// address-space limit leaves and what the control group (version 1 or 2) leaves. The largest number when nothing can
/// be learnt.
std::uint64_t available_memory();

/// Bytes that this process could have at most: the least of the machine's memory, the control group's limits and the
/// address-space limit. The largest number when nothing can be learnt.
std::uint64_t whole_memory();

/// Bytes of memory that this process holds now (its resident set). 0 when it cannot be learnt. About 10 us.
std::uint64_t resident_memory();

/// Bytes that this process may hold, for claims of files and estimates of work. A process has one memory, so there is
/// one limit; set it before work starts. At first: no limit.
void set_memory_limit(std::uint64_t bytes);
std::uint64_t memory_limit();

/// Throws BadInput, with what it would need, when the process would hold more than memory_limit(). `bytes`: an estimate
/// of the peak, the process itself and its libraries included (kProcessMemory); `what` names the work and its size
/// ("fitting 4000 x 3000 cells"); `file`: the input, may be empty.
void check_memory(double bytes, const std::string& what, const std::string& file);

/// What the process holds before it has read anything: the program, GDAL and the other libraries, and what GDAL keeps
/// of blocks (the program sets GDAL_CACHEMAX to 64 MB).
inline constexpr double kProcessMemory = 128e6;

/// "3.20 GB", "640 MB": three digits, units of 1000.
std::string size_text(double bytes);

}  // namespace retalho
