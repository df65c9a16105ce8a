// A mesh in the making, on disk: what is added leaves memory at once. Its two files have no names, so that nothing is
// left of them whatever happens. Internal to the room.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "retalho/mesh/mesh_file.h"
#include "retalho/mesh/mesh_stream.h"

namespace retalho {

class MeshSpool {
 public:
  /// Puts its files beside `temporary`; errors speak of `name`. Throws CannotWrite, here and below.
  MeshSpool(const std::string& temporary, const std::string& name);
  MeshSpool(const MeshSpool&) = delete;
  MeshSpool& operator=(const MeshSpool&) = delete;

  /// The vertex's number.
  std::uint32_t add_vertex(Vec3 position, Vec3 normal);
  void set_normal(std::uint32_t vertex, Vec3 normal);
  void add_triangle(const std::array<std::uint32_t, 3>& vertices);
  struct Vertex {
    Vec3 position, normal;
  };
  /// One that was added, from memory where those near it were asked for last. Not between additions.
  const Vertex& vertex(std::uint32_t number) { return block_of(number / kBlock)[number % kBlock]; }
  std::uint64_t vertices() const { return vertices_; }
  std::uint64_t triangles() const { return triangles_; }

  /// Nothing more will be added.
  void finish() { flush(); }
  /// All that was added, without offset, unit and CRS. The spool must outlive it; nothing may be added any more.
  MeshStream stream();

 private:
  using Triangle = std::array<std::uint32_t, 3>;
  static constexpr std::size_t kBlock = 4096;  ///< elements read or written at a time
  static constexpr std::size_t kCached = 64;   ///< blocks of vertices kept for position()

  struct Cached {
    std::uint64_t block = ~std::uint64_t{0};
    std::vector<Vertex> vertices;
  };

  void flush();
  const std::vector<Vertex>& block_of(std::uint64_t block);

  MeshFile vertex_file_, triangle_file_;
  std::uint64_t vertices_ = 0, triangles_ = 0;
  std::vector<Vertex> new_vertices_;  ///< the last ones, not yet on disk
  std::vector<Triangle> new_triangles_;
  std::vector<Cached> cache_;
  Vec3 low_, high_;
};

}  // namespace retalho
