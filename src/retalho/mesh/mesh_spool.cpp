#include "retalho/mesh/mesh_spool.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "retalho/core/error.h"

namespace retalho {

MeshSpool::MeshSpool(const std::string& temporary, std::string name) : name_(std::move(name)), cache_(kCached) {
  vertex_file_ = open_part(temporary + ".vertices");
  triangle_file_ = open_part(temporary + ".triangles");
}

MeshSpool::~MeshSpool() {
  if (vertex_file_ >= 0) close(vertex_file_);
  if (triangle_file_ >= 0) close(triangle_file_);
}

int MeshSpool::open_part(const std::string& path) const {
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  if (file < 0) throw CannotWrite(fmt::format("cannot write '{}': {}", name_, std::strerror(errno)), name_);
  unlink(path.c_str());
  return file;
}

void MeshSpool::put(int file, const void* bytes, std::size_t size, std::uint64_t at) const {
  const auto* from = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t done = pwrite(file, from, size, static_cast<off_t>(at));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) throw CannotWrite(fmt::format("cannot write '{}': {}", name_, std::strerror(errno)), name_);
    from += done;
    at += static_cast<std::uint64_t>(done);
    size -= static_cast<std::size_t>(done);
  }
}

void MeshSpool::get(int file, void* bytes, std::size_t size, std::uint64_t at) const {
  auto* to = static_cast<char*>(bytes);
  while (size > 0) {
    const ssize_t done = pread(file, to, size, static_cast<off_t>(at));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) throw CannotWrite(fmt::format("cannot write '{}': {}", name_, std::strerror(errno)), name_);
    to += done;
    at += static_cast<std::uint64_t>(done);
    size -= static_cast<std::size_t>(done);
  }
}

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
    put(vertex_file_, &normal, sizeof normal, vertex * sizeof(Vertex) + offsetof(Vertex, normal));
}

void MeshSpool::add_triangle(const Triangle& vertices) {
  new_triangles_.push_back(vertices);
  ++triangles_;
  if (new_triangles_.size() == kBlock) flush();
}

void MeshSpool::flush() {
  put(vertex_file_, new_vertices_.data(), new_vertices_.size() * sizeof(Vertex),
      (vertices_ - new_vertices_.size()) * sizeof(Vertex));
  put(triangle_file_, new_triangles_.data(), new_triangles_.size() * sizeof(Triangle),
      (triangles_ - new_triangles_.size()) * sizeof(Triangle));
  new_vertices_.clear();
  new_triangles_.clear();
}

const std::vector<MeshSpool::Vertex>& MeshSpool::block_of(std::uint64_t block) {
  Cached& cached = cache_[block % kCached];
  if (cached.block != block) {
    cached.vertices.resize(std::min<std::uint64_t>(kBlock, vertices_ - block * kBlock));
    get(vertex_file_, cached.vertices.data(), cached.vertices.size() * sizeof(Vertex), block * kBlock * sizeof(Vertex));
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
      get(triangle_file_, block.data(), block.size() * sizeof(Triangle), from * sizeof(Triangle));
      take(block);
    }
  };
  stream.position = [this](std::uint32_t v) { return block_of(v / kBlock)[v % kBlock].position; };
  return stream;
}

}  // namespace retalho
