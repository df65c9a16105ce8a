// Normals of points that come without: a plane through each point's neighbours, then one side for all of them.
#pragma once

#include <cstddef>
#include <vector>

#include "retalho/core/context.h"
#include "retalho/core/vec.h"

namespace retalho {

struct NormalOptions {
  int neighbours = 16;  ///< 3 to 200; more: smoother, and blind to thin parts
};

struct NormalNotes {
  std::size_t parts = 0;      ///< that hang together through neighbours: each has been turned by itself
  double agreement = 0;       ///< share of neighbouring pairs whose normals lie on one side, 0.5 to 1
  double flatness = 0;        ///< mean of how plane neighbourhoods are: 1 a plane, 0 a cloud
  std::size_t undecided = 0;  ///< points that got no normal (zeros): fewer than three places around them
};

/// Unit normals that point outwards. The plane is the least-squares one of the nearest neighbours (doubles of a place
/// count once); the side is carried along a minimum spanning tree of the neighbour graph, where an edge costs what the
/// two normals, mirrored at the bisecting plane, differ (Hoppe et al. 1992; Xie et al. 2003 for the mirror); each part
/// is turned so that its outermost points look outwards. Points that are not finite get zeros. Results do not depend on
/// threads. Throws UsageError for `neighbours` out of range. Cost: about 8 us and 400 bytes a point.
std::vector<Vec3> estimate_normals(const std::vector<Vec3>& positions, const NormalOptions& options = {},
                                   NormalNotes* notes = nullptr, const Context& context = {});

}  // namespace retalho
