// The model file (.retalho): one versioned, checked format for every surface (docs/model-file.md).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>

#include "retalho/patch/patch.h"
#include "retalho/terrain/terrain.h"
#include "retalho/tetraquad/tetraquad.h"

namespace retalho {

/// What a model file can hold. Further kinds of surface become further alternatives.
using Model = std::variant<Terrain, TetraQuad, PatchSet>;

/// What a file says of itself.
struct ModelFileNotes {
  int format_major = 0, format_minor = 0;
  bool compact = false;    ///< the compact form (compact.h), whose versions are numbered for themselves
  std::string created_by;  ///< "retalho 0.1.0"; the compact form does not say
  std::size_t bytes = 0;
};

/// The file's bytes: the same model gives the same bytes (from the same versions of Retalho and zstd).
/// Throws BadInput for a model that the checks of decode_model would refuse, CannotWrite for one over 2 GB.
/// Cost: about 2 us a vertex.
std::string encode_model(const Model& model);

/// The model, equal to the one encoded to the last bit; of either form. Throws CannotRead for anything that
/// encode_model did not write: every proper prefix and every changed byte is refused, before anything is interpreted;
/// content that got past the checksum is verified as a FlatBuffer, and then as a model (indices, orientation, finite
/// numbers, array lengths). `file` is its name in messages. Never allocates more than the bytes can stand for. Cost:
/// about 1 us a vertex.
Model decode_model(std::string_view bytes, const std::string& file = {}, ModelFileNotes* notes = nullptr);

/// Atomic. Throws as encode_model does, and CannotWrite.
void save_model(const Model& model, const std::string& path, bool overwrite = false);
/// A file, or the folder of a tiled model (model/tiled.h), whose tiles become one terrain. Throws CannotRead.
Model load_model(const std::string& path, ModelFileNotes* notes = nullptr);
/// Does the file start as a model file does, or is it the folder of a tiled model? False for a missing or short file.
bool is_model_file(const std::string& path);

}  // namespace retalho
