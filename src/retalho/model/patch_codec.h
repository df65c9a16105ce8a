// Triangular patches as a FlatBuffers table and back. Internal to the room.
#pragma once

#include "retalho/model/model_file_generated.h"
#include "retalho/patch/patch.h"

namespace retalho {

/// Throws BadInput when `set` is to be checked and has a fault (check.h), CannotWrite when it is too large for one
/// file.
flatbuffers::Offset<model_file::PatchSetSurface> encode_patches(flatbuffers::FlatBufferBuilder& builder,
                                                                const PatchSet& set, bool checked);

/// `table` has passed FlatBuffers' verifier. Throws CannotRead when what it says are no patches without a fault.
PatchSet decode_patches(const model_file::PatchSetSurface& table);

}  // namespace retalho
