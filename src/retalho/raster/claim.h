// A file's claimed size against the memory that there is, before anything is allocated.
#pragma once

#include <cstddef>
#include <string>

namespace retalho {

/// Throws BadInput, with what it would need, when columns x rows cells of `bytes` each do not fit into memory.
void check_claim(int columns, int rows, std::size_t bytes, const std::string& name);

}  // namespace retalho
