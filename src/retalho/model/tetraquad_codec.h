// A TetraQuad model as a FlatBuffers table and back. Internal to the room.
#pragma once

#include "retalho/model/model_file_generated.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

/// Throws BadInput when `surface` is to be checked and has a fault (check.h), CannotWrite when it is too large for one
/// file.
flatbuffers::Offset<model_file::TetraQuadSurface> encode_tetraquad(flatbuffers::FlatBufferBuilder& builder,
                                                                   const TetraQuad& surface, bool checked);

/// The same for one on an adaptive mesh.
flatbuffers::Offset<model_file::AdaptiveTetraQuadSurface> encode_adaptive(flatbuffers::FlatBufferBuilder& builder,
                                                                          const TetraQuad& surface, bool checked);
TetraQuad decode_adaptive(const model_file::AdaptiveTetraQuadSurface& table);

/// `table` has passed FlatBuffers' verifier. Throws CannotRead when what it says is no TetraQuad without a fault.
TetraQuad decode_tetraquad(const model_file::TetraQuadSurface& table);

}  // namespace retalho
