// What the fits on a grid and on an adaptive mesh share. Internal to the room.
#pragma once

#include <vector>

#include "retalho/tetraquad/energy.h"
#include "retalho/tetraquad/fit.h"

namespace retalho {

/// Throws UsageError.
void check_options(const TetraQuadFitOptions& options);

/// The points in lattice coordinates, with unit normals (or none).
struct Samples {
  Vec3 origin;
  double step = 1;
  std::vector<Sample> samples;   ///< tet is not set yet
  std::vector<TetPlace> places;  ///< of each
};

/// Throws BadInput for points that make no surface; the report gets their counts and warnings.
Samples take_samples(const PointCloud& cloud, const TetraQuadFitOptions& options, TetraQuadFitReport& report);

/// `area`: that holds points, in steps^2.
EnergyWeights weights_of(const TetraQuadFitOptions& options, double area, std::size_t samples);

/// Sizes and residuals of the finished surface.
void measure(const TetraQuadField& field, const std::vector<Sample>& samples, const TetraQuadErrorOptions& error,
             TetraQuadFitReport& report);

}  // namespace retalho
