#include "retalho/model/codec_parts.h"

#include <fmt/format.h>

#include "retalho/core/error.h"

namespace retalho {
namespace {

// A FlatBuffer's offsets are 31 bits wide; half of it leaves room for everything that is not an array.
constexpr std::size_t kMostBytes = std::size_t{2} << 30;
constexpr std::size_t kMargin = std::size_t{16} << 20;

}  // namespace

flatbuffers::Offset<FlatBytes> add_bytes(flatbuffers::FlatBufferBuilder& builder, const std::string& bytes) {
  if (builder.GetSize() + bytes.size() + kMargin > kMostBytes)
    throw CannotWrite("the model is larger than the 2 GB that a model file can hold: fit with a larger error");
  return builder.CreateVector(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

flatbuffers::Offset<model_file::Numbers> add_numbers(flatbuffers::FlatBufferBuilder& builder,
                                                     const PackedNumbers& packed) {
  const auto bytes = add_bytes(builder, packed.bytes);
  return model_file::CreateNumbers(builder, packed.count, static_cast<model_file::NumberForm>(packed.form),
                                   packed.width, packed.differences, packed.decimals, bytes);
}

std::string_view view(const FlatBytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

PackedView view(const model_file::Numbers* numbers, const char* what) {
  if (!numbers) throw CannotRead(fmt::format("{} is missing", what), {}, what);
  return {numbers->count(),    static_cast<NumberForm>(numbers->form()),
          numbers->width(),    numbers->differences(),
          numbers->decimals(), view(*numbers->zstd())};
}

flatbuffers::Offset<model_file::Georef> encode_georef(flatbuffers::FlatBufferBuilder& builder, const Georef& g) {
  const auto wkt = builder.CreateString(g.crs_wkt), unit = builder.CreateString(g.unit);
  return model_file::CreateGeoref(builder, g.origin_x, g.origin_y, g.scale_x, g.scale_y, wkt, unit, g.geographic);
}

Georef decode_georef(const model_file::Georef& table) {
  return {table.origin_x(),       table.origin_y(),    table.scale_x(),   table.scale_y(),
          table.crs_wkt()->str(), table.unit()->str(), table.geographic()};
}

}  // namespace retalho
