// The dense kernel of the factorisation. Internal to the room.
#pragma once

#include <cstddef>

namespace retalho {

/// `a`: n x n, column-major, the lower triangle counts. Factors the first `pivots` columns (L over A), and takes their
/// share off the rest: A22 -= L21 L21'. False when a pivot is not positive.
bool factor_front(double* a, std::size_t n, std::size_t pivots);

}  // namespace retalho
