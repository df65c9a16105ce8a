// The model file (.retalho): one versioned, checked format for every surface (docs/model-file.md).
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "retalho/terrain/terrain.h"

namespace retalho {

/// What a model file can hold. Further kinds of surface become further alternatives.
using Model = std::variant<Terrain>;

/// The file's bytes. The same model gives the same bytes.
std::string encode_model(const Model& model);
/// Throws CannotRead for anything that encode_model did not write: every proper prefix and every changed byte is
/// refused.
Model decode_model(std::string_view bytes, const std::string& file = {});

/// Atomic. Throws CannotWrite.
void save_model(const Model& model, const std::string& path, bool overwrite = false);
/// Throws CannotRead.
Model load_model(const std::string& path);
/// Does the file start as a model file does? False for a missing or short file.
bool is_model_file(const std::string& path);

}  // namespace retalho
