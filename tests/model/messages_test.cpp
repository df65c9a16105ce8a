// What the room says of files whose envelopes are wrong, and of terrains that have no compact form.
#include <gtest/gtest.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <set>
#include <string>

#include "retalho/core/error.h"
#include "retalho/model/byte_stream.h"
#include "retalho/model/compact.h"
#include "retalho/model/compact_file.h"
#include "retalho/model/envelope.h"
#include "retalho/model/model.h"
#include "retalho/model/model_codec.h"
#include "retalho/terrain/fit.h"
#include "retalho/tin/refine.h"
#include "support/errors.h"
#include "support/grids.h"
#include "support/sample_terrain.h"

namespace retalho::test {
namespace {

/// With a hash of `size` bytes at `at`, over everything else, that fits.
std::string sealed_anew(std::string bytes, std::size_t at, std::size_t size) {
  XXH64_state_t state;
  XXH64_reset(&state, 0);
  XXH64_update(&state, bytes.data(), at);
  XXH64_update(&state, bytes.data() + at + size, bytes.size() - at - size);
  const auto sum = XXH64_digest(&state);
  for (std::size_t k = 0; k < size; ++k) bytes[at + k] = static_cast<char>(sum >> (8 * k) & 0xff);
  return bytes;
}

TEST(ModelMessages, EnvelopesThatAreWrongAreNamed) {
  std::string old = seal(encode_content(sample_terrain({})));
  old[8] = 0;
  const std::string sealed = sealed_anew(old, 24, 8);
  expect_refused<CannotRead>({
      {"cannot read the model: there is no format 0", [&] { decode_model(sealed); }},
      {"a content of 3 bytes", [] { decode_content("abc"); }},
      {"the header ends before its kind", [] { ByteReader("").byte("kind"); }},
  });
}

/// Heights that no step of half a metre reaches in 2^29 steps.
struct Steep : ValueSource {
  void settle() override {}
  double height(std::uint32_t v) override { return v == 1 ? 1e12 : 0; }
  Vec2 gradient(std::uint32_t) override { return {}; }
  void coded_height(std::uint32_t, double) override {}
  void coded_gradient(std::uint32_t, Vec2) override {}
};

Raster hill() {
  return make_grid(12, 9, [](int x, int y) { return 50 + x * y + (x * 7 + y * 5) % 11; });
}

TEST(ModelMessages, CompactFormsThatAreWrongAreNamed) {
  const Raster grid = hill();
  const std::string sound = fit_compact(grid, {.max_error = 2}).bytes;
  std::set<std::string> said;
  for (std::size_t at = 4; at < sound.size(); ++at)
    for (const char value : {'\0', '\7'}) {
      std::string changed = sound;
      changed[at] = value;
      try {
        decode_model(sealed_anew(changed, 5, 4));
      } catch (const CannotRead& error) {
        said.insert(error.what());
      }
    }
  for (const char* words :
       {"there is no compact form 0", "the CRS is stored in a form that this Retalho does not know"})
    EXPECT_TRUE(said.contains(std::string("cannot read the model: ") + words)) << words;
}

TEST(ModelMessages, TerrainsWithoutACompactFormAreNamed) {
  const Raster grid = hill();
  Terrain twice = make_terrain(refine_tin(grid, {.max_error = 1}), grid);
  twice.tin.points[1] = twice.tin.points[0];
  Raster line = grid;
  line.cell_width = 1e9;
  expect_refused<BadInput>({
      {"this terrain has no compact form: two vertices lie in one cell",
       [&] { compact_terrain(twice, grid, {.max_error = 1}); }},
      {"this terrain has no compact form: a cell that is a line", [&] { fit_compact(line, {.max_error = 1}); }},
      {"this terrain has no compact form: a number lies more than 2^29 steps from where it is expected",
       [] {
         Steep steep;
         CompactFrameFacts facts;
         facts.kind = SurfaceKind::linear;
         facts.grid = {9, 9, 1, 1, {}};
         facts.steps.height = 0.5;
         encode_compact(facts, {greedy::cell_at(0, 0), greedy::cell_at(8, 0), greedy::cell_at(0, 8)}, steep);
       }},
  });
}

}  // namespace
}  // namespace retalho::test
