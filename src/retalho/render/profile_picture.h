// The picture of a sight line: the terrain under it, the line, the first Fresnel zone, where it is blocked.
#pragma once

#include <string>

#include "retalho/render/curve_picture.h"
#include "retalho/visibility/line_of_sight.h"

namespace retalho {

/// Distance to the right, height up, scales of their own. `unit`: of the distances, for the caption. Stretches without
/// data are left open. Throws UsageError for a line of no length.
CurvePicture profile_picture(const SightLine& line, const std::string& unit);

}  // namespace retalho
