// The content of a model file, without its envelope: what a damaged file that has got past the checksum meets.
// Internal to the room; the tests feed it with anything.
#pragma once

#include <string>
#include <string_view>

#include "retalho/model/model.h"

namespace retalho {

/// Throws BadInput for a model with a fault (check.h). Without the check anything is written that can be: for tests of
/// what reading makes of it.
std::string encode_content(const Model& model, bool checked = true);

/// Throws CannotRead for everything that is not a model without a fault; never crashes, never reads beyond `content`,
/// never allocates more than its length can stand for.
Model decode_content(std::string_view content, std::string* created_by = nullptr);

}  // namespace retalho
