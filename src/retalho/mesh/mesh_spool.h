// A mesh in the making, on disk: what is added leaves memory at once. Its two files have no names, so that nothing is
// left of them whatever happens. Internal to the room.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "retalho/mesh/mesh_stream.h"

namespace retalho {

class MeshSpool {
 public:
  /// Puts its files beside `temporary`; errors speak of `name`. Throws CannotWrite, here and below.
  MeshSpool(const std::string& temporary, std::string name);
  ~MeshSpool();
  MeshSpool(const MeshSpool&) = delete;
  MeshSpool& operator=(const MeshSpool&) = delete;

  /// The vertex's number.
  std::uint32_t add_vertex(Vec3 position, Vec3 normal);
  void set_normal(std::uint32_t vertex, Vec3 normal);
  void add_triangle(const std::array<std::uint32_t, 3>& vertices);
  std::uint64_t vertices() const { return vertices_; }
  std::uint64_t triangles() const { return triangles_; }

  /// All that was added, without offset, unit and CRS. The spool must outlive it; nothing may be added any more.
  MeshStream stream();

 private:
  struct Vertex {
    Vec3 position, normal;
  };
  using Triangle = std::array<std::uint32_t, 3>;
  static constexpr std::size_t kBlock = 4096;  ///< elements read or written at a time
  static constexpr std::size_t kCached = 64;   ///< blocks of vertices kept for position()

  struct Cached {
    std::uint64_t block = ~std::uint64_t{0};
    std::vector<Vertex> vertices;
  };

  int open_part(const std::string& path) const;
  void put(int file, const void* bytes, std::size_t size, std::uint64_t at) const;
  void get(int file, void* bytes, std::size_t size, std::uint64_t at) const;
  void flush();
  const std::vector<Vertex>& block_of(std::uint64_t block);

  std::string name_;
  int vertex_file_ = -1, triangle_file_ = -1;
  std::uint64_t vertices_ = 0, triangles_ = 0;
  std::vector<Vertex> new_vertices_;  ///< the last ones, not yet on disk
  std::vector<Triangle> new_triangles_;
  std::vector<Cached> cache_;
  Vec3 low_, high_;
};

}  // namespace retalho
