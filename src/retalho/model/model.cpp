#include "retalho/model/model.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "retalho/core/atomic_file.h"
#include "retalho/core/error.h"
#include "retalho/model/compact_file.h"
#include "retalho/model/envelope.h"
#include "retalho/model/model_codec.h"
#include "retalho/model/tiled.h"

namespace retalho {

std::string encode_model(const Model& model) {
  return seal(encode_content(model));
}

Model decode_model(std::string_view bytes, const std::string& file, ModelFileNotes* notes) {
  try {
    if (has_compact_signature(bytes)) {
      Terrain terrain = decode_compact(bytes);
      if (notes) *notes = {kCompactVersion, 0, true, {}, bytes.size()};
      return terrain;
    }
    const Envelope envelope = unseal(bytes);
    std::string created_by;
    Model model = decode_content(envelope.content, &created_by);
    if (notes) *notes = {envelope.major, envelope.minor, false, created_by, bytes.size()};
    return model;
  } catch (const CannotRead& e) {
    throw CannotRead(file.empty() ? fmt::format("cannot read the model: {}", e.what())
                                  : fmt::format("cannot read '{}': {}", file, e.what()),
                     file, e.where());
  }
}

void save_model(const Model& model, const std::string& path, bool overwrite) {
  write_file(path, encode_model(model), overwrite);
}

Model load_model(const std::string& path, ModelFileNotes* notes) {
  std::error_code ec;
  if (std::filesystem::is_directory(path, ec)) {
    if (notes) *notes = {kFormatMajor, kFormatMinor, false, "tiles", model_size(path)};
    return load_tiled_model(path);
  }
  return decode_model(read_file(path), path, notes);
}

bool is_model_file(const std::string& path) {
  if (is_tiled_model(path)) return true;
  std::ifstream in(path, std::ios::binary);
  char start[8];
  return in.read(start, sizeof start) &&
         (has_signature({start, sizeof start}) || has_compact_signature({start, sizeof start}));
}

}  // namespace retalho
