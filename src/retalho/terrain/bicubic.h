// A C1 bicubic surface on an elevation grid: Hermite bicubics (Coons patches) whose tangents are those of cubic splines
// along rows and columns (docs/mathematics.md, "Bicubic"; the contour paper's eqs. 1-6, its matrix put right).
//
// u runs along a row to the east, v along a column to the south; derivatives are per cell. A patch exists where its
// four corners hold data; each unbroken run of a row or column has a spline of its own.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "retalho/bernstein/triangle.h"
#include "retalho/core/context.h"
#include "retalho/raster/raster.h"

namespace retalho {

enum class TangentEnds { not_a_knot, natural };
/// How the mixed derivative of each sample is set.
enum class Twist {
  zero,    ///< the paper's; second order only, does not reproduce z = uv
  adini,   ///< from the neighbouring tangents; fourth order
  spline,  ///< splines of the tangents: a C2 surface on a grid without voids
};

struct BicubicOptions {
  TangentEnds ends = TangentEnds::not_a_knot;
  Twist twist = Twist::spline;
  /// No slope (and no twist) along a row or column where a neighbour has the very same height, so that lakes and seas
  /// stay flat instead of ringing. Still C1.
  bool keep_flats = true;
};

struct BicubicGrid {
  int columns = 0, rows = 0;
  double cell_width = 1, cell_height = 1;  ///< local units
  Georef georef;
  Mask valid;                          ///< samples with data; empty: all
  std::vector<double> z, zu, zv, zuv;  ///< row-major, a value each sample; 0 where there is no data

  bool has_sample(int column, int row) const { return valid.empty() || valid.get(column, row); }
  /// The patch between this sample and its south-eastern neighbour exists.
  bool has_patch(int column, int row) const {
    return has_sample(column, row) && has_sample(column + 1, row) && has_sample(column, row + 1) &&
           has_sample(column + 1, row + 1);
  }
  /// Its 16 ordinates, [4 * i + j]: i along v, j along u.
  std::array<double, 16> patch(int column, int row) const;
  /// Height, gradient and second derivatives at a local point; nothing outside of the patches.
  std::optional<Jet> at(Vec2 local) const;
};

/// How many samples a tangent depends on, to each side: a tile cut out with this many samples around it gives the same
/// bits as the whole grid. (A sample's weight falls by 2 - sqrt(3) with each step: 1e-16 after 28.)
inline constexpr int kSplineHalo = 28;

/// Throws BadInput for a grid of less than two rows or columns. Cost: about 90 multiplications a cell; 32 bytes a cell.
BicubicGrid make_bicubic(const Raster& raster, const BicubicOptions& options = {}, const Context& context = {});

const char* twist_name(Twist twist);
std::optional<Twist> parse_twist(std::string_view name);

}  // namespace retalho
