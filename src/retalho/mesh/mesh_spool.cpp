#include "retalho/mesh/mesh_spool.h"

#include <algorithm>
#include <cstddef>

namespace retalho {

MeshSpool::MeshSpool(const std::string& temporary, const std::string& name)
    : vertex_file_(temporary + ".vertices", name), triangle_file_(temporary + ".triangles", name), cache_(kCached) {}

std::uint32_t MeshSpool::add_vertex(Vec3 position, Vec3 normal) {
  if (vertices_ == 0) low_ = high_ = position;
  widen(low_, high_, position);
  new_vertices_.push_back({position, normal});
  const auto number = static_cast<std::uint32_t>(vertices_++);
  if (new_vertices_.size() == kBlock) flush();
  return number;
}

void MeshSpool::set_normal(std::uint32_t vertex, Vec3 normal) {
  const std::uint64_t on_disk = vertices_ - new_vertices_.size();
  if (vertex >= on_disk)
    new_vertices_[vertex - on_disk].normal = normal;
  else
    vertex_file_.put(&normal, sizeof normal, vertex * sizeof(Vertex) + offsetof(Vertex, normal));
}

void MeshSpool::add_triangle(const Triangle& vertices) {
  new_triangles_.push_back(vertices);
  ++triangles_;
  if (new_triangles_.size() == kBlock) flush();
}

void MeshSpool::flush() {
  vertex_file_.put(new_vertices_.data(), new_vertices_.size() * sizeof(Vertex),
                   (vertices_ - new_vertices_.size()) * sizeof(Vertex));
  triangle_file_.put(new_triangles_.data(), new_triangles_.size() * sizeof(Triangle),
                     (triangles_ - new_triangles_.size()) * sizeof(Triangle));
  new_vertices_.clear();
  new_triangles_.clear();
}

const std::vector<MeshSpool::Vertex>& MeshSpool::block_of(std::uint64_t block) {
  Cached& cached = cache_[block % kCached];
  if (cached.block != block) {
    cached.vertices.resize(std::min<std::uint64_t>(kBlock, vertices_ - block * kBlock));
    vertex_file_.get(cached.vertices.data(), cached.vertices.size() * sizeof(Vertex), block * kBlock * sizeof(Vertex));
    cached.block = block;
  }
  return cached.vertices;
}

MeshStream MeshSpool::stream() {
  flush();
  MeshStream stream;
  stream.vertices = vertices_;
  stream.triangles = triangles_;
  stream.normals = vertices_ > 0;
  stream.low = low_;
  stream.high = high_;
  stream.each_vertex = [this](const std::function<void(const VertexBlock&)>& take) {
    std::vector<Vec3> positions, normals;
    for (std::uint64_t block = 0; block * kBlock < vertices_; ++block) {
      positions.clear();
      normals.clear();
      for (const Vertex& v : block_of(block)) {
        positions.push_back(v.position);
        normals.push_back(v.normal);
      }
      take({positions, normals, {}});
    }
  };
  stream.each_triangle = [this](const std::function<void(TriangleBlock)>& take) {
    std::vector<Triangle> block;
    for (std::uint64_t from = 0; from < triangles_; from += block.size()) {
      block.resize(std::min<std::uint64_t>(kBlock, triangles_ - from));
      triangle_file_.get(block.data(), block.size() * sizeof(Triangle), from * sizeof(Triangle));
      take(block);
    }
  };
  stream.position = [this](std::uint32_t v) { return vertex(v).position; };
  return stream;
}

}  // namespace retalho
