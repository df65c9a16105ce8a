// A terrain model as a FlatBuffers table and back. Internal to the room: FlatBuffers stands in this pair and in
// model_codec.cpp, nowhere else.
#pragma once

#include "retalho/model/model_file_generated.h"
#include "retalho/terrain/terrain.h"

namespace retalho {

/// Throws BadInput when `terrain` is to be checked and has a fault (check.h), CannotWrite when it is too large for one
/// file.
flatbuffers::Offset<model_file::TerrainSurface> encode_terrain(flatbuffers::FlatBufferBuilder& builder,
                                                               const Terrain& terrain, bool checked);

/// `table` has passed FlatBuffers' verifier. Throws CannotRead when what it says is no terrain without a fault.
Terrain decode_terrain(const model_file::TerrainSurface& table);

}  // namespace retalho
