// What the codecs of all kinds of surfaces share. Internal to the room.
#pragma once

#include <string>
#include <string_view>

#include "retalho/model/model_file_generated.h"
#include "retalho/model/numbers.h"
#include "retalho/raster/georef.h"

namespace retalho {

using FlatBytes = flatbuffers::Vector<std::uint8_t>;

/// Throws CannotWrite when the file would pass 2 GB.
flatbuffers::Offset<FlatBytes> add_bytes(flatbuffers::FlatBufferBuilder& builder, const std::string& bytes);
flatbuffers::Offset<model_file::Numbers> add_numbers(flatbuffers::FlatBufferBuilder& builder,
                                                     const PackedNumbers& packed);

std::string_view view(const FlatBytes& bytes);
/// Throws CannotRead, naming `what`, when there are none.
PackedView view(const model_file::Numbers* numbers, const char* what);

flatbuffers::Offset<model_file::Georef> encode_georef(flatbuffers::FlatBufferBuilder& builder, const Georef& georef);
Georef decode_georef(const model_file::Georef& table);

}  // namespace retalho
