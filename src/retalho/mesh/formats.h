// The mesh formats, one file each, behind write_mesh and read_mesh. Internal to the room.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <string_view>

#include "retalho/mesh/mesh.h"
#include "retalho/mesh/mesh_stream.h"

namespace retalho {

/// A file, or a text in memory, being written front to back, in large blocks. Throws CannotWrite when the disk is full.
class ByteSink {
 public:
  /// `path` is written; errors speak of `name`.
  ByteSink(const std::string& path, std::string name);
  /// The bytes go to the end of `into`, which is whole after close().
  explicit ByteSink(std::string& into);
  ~ByteSink();
  ByteSink(const ByteSink&) = delete;
  ByteSink& operator=(const ByteSink&) = delete;

  void text(std::string_view words);
  void number(double value);  ///< shortest text that reads back to the same double
  void number(std::uint64_t value);
  template <typename T>
  void binary(T value) {  ///< little-endian, as every machine that this is built for
    if (used_ + sizeof value > kBlock) flush();
    __builtin_memcpy(block_ + used_, &value, sizeof value);
    used_ += sizeof value;
  }
  void close();

 private:
  void flush();
  [[noreturn]] void fail();
  static constexpr std::size_t kBlock = std::size_t{1} << 18;
  std::string name_;
  std::FILE* file_ = nullptr;
  std::string* into_ = nullptr;
  char* block_;
  std::size_t used_ = 0;
};

/// Writes what `fill` gives to `path`, in the format that its ending names. Atomic. Throws as write_mesh does.
void write_stream(const std::string& path, bool overwrite,
                  const std::function<MeshStream(const std::string& temporary)>& fill);

void write_ply(const MeshStream& mesh, ByteSink& out);
void write_obj(const MeshStream& mesh, ByteSink& out);
void write_stl(const MeshStream& mesh, ByteSink& out);
void write_glb(const MeshStream& mesh, ByteSink& out);
void write_landxml(const MeshStream& mesh, ByteSink& out);

TriangleMesh read_ply(std::string_view bytes, const std::string& path);
TriangleMesh read_obj(std::string_view bytes, const std::string& path);

}  // namespace retalho
