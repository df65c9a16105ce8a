#include "retalho/model/model_codec.h"

#include <fmt/format.h>

#include <cstdint>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "retalho/core/error.h"
#include "retalho/model/patch_codec.h"
#include "retalho/model/terrain_codec.h"
#include "retalho/model/tetraquad_codec.h"

namespace retalho {
namespace {

namespace fb = model_file;

/// FlatBuffers reads numbers in place: they must lie on their own alignment.
class AlignedView {
 public:
  explicit AlignedView(std::string_view bytes) : bytes_(bytes) {
    if (reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(std::uint64_t) == 0) return;
    copy_.resize((bytes.size() + 7) / 8);
    bytes.copy(reinterpret_cast<char*>(copy_.data()), bytes.size());
    bytes_ = {reinterpret_cast<const char*>(copy_.data()), bytes.size()};
  }
  const std::uint8_t* data() const { return reinterpret_cast<const std::uint8_t*>(bytes_.data()); }
  std::size_t size() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
  std::vector<std::uint64_t> copy_;
};

}  // namespace

std::string encode_content(const Model& model, bool checked) {
  flatbuffers::FlatBufferBuilder builder(1 << 16);
  const auto created_by = builder.CreateString("retalho " RETALHO_VERSION);
  const auto [kind, surface] = std::visit(
      [&](const auto& shape) -> std::pair<fb::Surface, flatbuffers::Offset<void>> {
        if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, Terrain>)
          return {fb::Surface::TerrainSurface, encode_terrain(builder, shape, checked).Union()};
        else if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, PatchSet>)
          return {fb::Surface::PatchSetSurface, encode_patches(builder, shape, checked).Union()};
        else if (shape.mesh.forest)
          return {fb::Surface::AdaptiveTetraQuadSurface, encode_adaptive(builder, shape, checked).Union()};
        else
          return {fb::Surface::TetraQuadSurface, encode_tetraquad(builder, shape, checked).Union()};
      },
      model);
  const auto root = fb::CreateModelFile(builder, created_by, kind, surface);
  fb::FinishModelFileBuffer(builder, root);
  return {reinterpret_cast<const char*>(builder.GetBufferPointer()), builder.GetSize()};
}

Model decode_content(std::string_view content, std::string* created_by) {
  const AlignedView bytes(content);
  // Under 12 bytes there is no room for a root, an identifier and a table; the verifier itself wants to be asked less.
  if (bytes.size() < 12 || bytes.size() >= FLATBUFFERS_MAX_BUFFER_SIZE)
    throw CannotRead(fmt::format("a content of {} bytes", bytes.size()), {}, "content");
  flatbuffers::Verifier verifier(bytes.data(), bytes.size());
  if (!fb::VerifyModelFileBuffer(verifier))
    throw CannotRead("the content is not a Retalho model (its FlatBuffer is broken)", {}, "content");
  const fb::ModelFile& file = *fb::GetModelFile(bytes.data());
  if (created_by) *created_by = file.created_by()->str();
  switch (file.surface_type()) {
    case fb::Surface::TerrainSurface:
      return decode_terrain(*file.surface_as_TerrainSurface());
    case fb::Surface::TetraQuadSurface:
      return decode_tetraquad(*file.surface_as_TetraQuadSurface());
    case fb::Surface::AdaptiveTetraQuadSurface:
      return decode_adaptive(*file.surface_as_AdaptiveTetraQuadSurface());
    case fb::Surface::PatchSetSurface:
      return decode_patches(*file.surface_as_PatchSetSurface());
    default:
      throw CannotRead(fmt::format("it holds a kind of surface ({}) that this Retalho does not know: update Retalho",
                                   static_cast<int>(file.surface_type())),
                       {}, "surface");
  }
}

}  // namespace retalho
