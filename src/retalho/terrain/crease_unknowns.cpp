#include "retalho/terrain/crease_unknowns.h"

#include <algorithm>
#include <numeric>

namespace retalho {
namespace {

constexpr std::size_t kGrain = 1024;  // nodes or corners

/// What one node adds to the nine numbers of a triangle.
struct NodeRows {
  std::uint32_t node = kNone;
  std::array<std::array<double, 3>, 9> row{};
};

/// The nodes of one triangle: three vertices, and up to three sectors a corner.
struct TriangleRows {
  std::array<NodeRows, 12> of{};
  std::size_t count = 0;

  NodeRows& node(std::uint32_t n) {
    for (std::size_t k = 0; k < count; ++k)
      if (of[k].node == n) return of[k];
    of[count].node = n;
    return of[count++];
  }
};

}  // namespace

CreasedUnknowns::CreasedUnknowns(TriangleList triangles, TriangleList neighbors, TriangleList sectors,
                                 std::span<const Vec2> points)
    : vertices_(points.size()), vertex_(points.size()), triangles_(sectors.begin(), sectors.end()) {
  std::iota(vertex_.begin(), vertex_.end(), 0U);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      if (sectors[t][k] >= vertex_.size()) vertex_.resize(sectors[t][k] + std::size_t{1}, kNone);
      vertex_[sectors[t][k]] = triangles[t][k];
    }
  corners_.resize(vertex_.size());
  for (std::uint32_t n = 0; n < vertex_.size(); ++n) {
    corners_[n].vertex = vertex_[n];
    corners_[n].node[0] = n;
    corners_[n].share[0] = {1, 0, 0, 1};
  }
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) add_corner(neighbors, sectors, triangles, points, t, k);
  list_corners();
}

/// A corner at a crease gets a number of its own.
void CreasedUnknowns::add_corner(TriangleList neighbors, TriangleList sectors, TriangleList triangles,
                                 std::span<const Vec2> points, std::uint32_t triangle, std::size_t k) {
  const auto& v = triangles[triangle];
  const std::uint32_t own = sectors[triangle][k];
  const auto across = [&](std::size_t edge) {  // the sector on the other side of an edge at this corner
    const std::uint32_t other = neighbors[triangle][edge];
    if (other == kNone) return own;
    const auto& w = triangles[other];
    return sectors[other][w[0] == v[k] ? 0 : w[1] == v[k] ? 1 : 2];
  };
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;  // edge j leads to corner i, edge i to corner j
  const std::uint32_t over[2] = {across(j), across(i)};
  if (over[0] == own && over[1] == own) return;
  const Vec2 to_i = points[v[i]] - points[v[k]], to_j = points[v[j]] - points[v[k]];
  const double area2 = cross(to_i, to_j);
  // The gradient g with g . to_i = 1 and g . to_j = 0, and the other way round.
  const Vec2 dual[2] = {Vec2{to_j.y, -to_j.x} / area2, Vec2{-to_i.y, to_i.x} / area2}, along[2] = {to_i, to_j};
  Corner corner;
  corner.vertex = v[k];
  corner.node[0] = own;
  corner.share[0] = {1, 0, 0, 1};
  for (std::size_t e = 0; e < 2; ++e) {
    if (over[e] == own) continue;
    corner.node[e + 1] = over[e];
    const Vec2 d = dual[e] / 2, a = along[e];
    corner.share[e + 1] = {d.x * a.x, d.x * a.y, d.y * a.x, d.y * a.y};
    for (std::size_t s = 0; s < 4; ++s) corner.share[0][s] -= corner.share[e + 1][s];
  }
  triangles_[triangle][k] = static_cast<std::uint32_t>(corners_.size());
  corners_.push_back(corner);
}

void CreasedUnknowns::list_corners() {
  height_begin_.assign(vertices_ + 1, 0);
  gradient_begin_.assign(nodes() + 1, 0);
  for (const Corner& c : corners_) {
    if (c.vertex != kNone) ++height_begin_[c.vertex + 1];
    for (const std::uint32_t n : c.node)
      if (n != kNone) ++gradient_begin_[n + 1];
  }
  std::partial_sum(height_begin_.begin(), height_begin_.end(), height_begin_.begin());
  std::partial_sum(gradient_begin_.begin(), gradient_begin_.end(), gradient_begin_.begin());
  height_.resize(height_begin_.back());
  gradient_.resize(gradient_begin_.back());
  std::vector<std::uint32_t> next_height(height_begin_.begin(), height_begin_.end() - 1),
      next_gradient(gradient_begin_.begin(), gradient_begin_.end() - 1);
  for (std::uint32_t c = 0; c < corners_.size(); ++c) {
    if (corners_[c].vertex != kNone) height_[next_height[corners_[c].vertex]++] = c;
    for (std::uint32_t k = 0; k < 3; ++k)
      if (const std::uint32_t n = corners_[c].node[k]; n != kNone) gradient_[next_gradient[n]++] = {c, k};
  }
}

void CreasedUnknowns::expand(const std::vector<double>& x, std::vector<double>& u, const Context& context) const {
  parallel_chunks(corners_.size(), kGrain, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const Corner& corner = corners_[c];
      Vec2 g;
      for (std::size_t k = 0; k < 3; ++k) {
        if (corner.node[k] == kNone) continue;
        const double* in = &x[3 * std::size_t{corner.node[k]}];
        const auto& m = corner.share[k];
        g = g + Vec2{m[0] * in[1] + m[1] * in[2], m[2] * in[1] + m[3] * in[2]};
      }
      u[3 * c] = corner.vertex == kNone ? 0 : x[3 * std::size_t{corner.vertex}];
      u[3 * c + 1] = g.x;
      u[3 * c + 2] = g.y;
    }
  });
}

void CreasedUnknowns::gather(const std::vector<double>& u, std::vector<double>& x, const Context& context) const {
  parallel_chunks(nodes(), kGrain, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      double z = 0;
      if (n < vertices_)
        for (std::uint32_t s = height_begin_[n]; s < height_begin_[n + 1]; ++s) z += u[3 * std::size_t{height_[s]}];
      Vec2 g;
      for (std::uint32_t s = gradient_begin_[n]; s < gradient_begin_[n + 1]; ++s) {
        const auto [c, k] = gradient_[s];
        const auto& m = corners_[c].share[k];
        const double* in = &u[3 * std::size_t{c}];
        g = g + Vec2{m[0] * in[1] + m[2] * in[2], m[1] * in[1] + m[3] * in[2]};
      }
      x[3 * n] = z;
      x[3 * n + 1] = g.x;
      x[3 * n + 2] = g.y;
    }
  });
}

std::vector<std::array<double, 9>> CreasedUnknowns::diagonal(std::span<const FitElement> elements) const {
  std::vector<std::array<double, 9>> blocks(nodes(), std::array<double, 9>{});
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    TriangleRows rows;
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner& c = corners_[triangles_[t][k]];
      rows.node(c.vertex).row[3 * k][0] += 1;
      for (std::size_t p = 0; p < 3; ++p) {
        if (c.node[p] == kNone) continue;
        auto& row = rows.node(c.node[p]).row;
        for (std::size_t i = 0; i < 2; ++i)
          for (std::size_t j = 0; j < 2; ++j) row[3 * k + 1 + i][1 + j] += c.share[p][2 * i + j];
      }
    }
    const FitElement& e = elements[t];
    for (std::size_t n = 0; n < rows.count; ++n) {
      const auto& row = rows.of[n].row;
      auto& block = blocks[rows.of[n].node];
      for (std::size_t r = 0; r < 9; ++r)
        for (std::size_t s = 0; s < 9; ++s) {
          const double a = e.a[packed_index(std::min(r, s), std::max(r, s))];
          for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) block[3 * i + j] += row[r][i] * a * row[s][j];
        }
    }
  }
  return blocks;
}

CornerData CreasedUnknowns::at(std::uint32_t triangle, std::span<const Vec3> data) const {
  CornerData result;
  for (std::size_t k = 0; k < 3; ++k) {
    const Corner& c = corners_[triangles_[triangle][k]];
    Vec2 g;
    for (std::size_t p = 0; p < 3; ++p) {
      if (c.node[p] == kNone) continue;
      const Vec3& d = data[c.node[p]];
      const auto& m = c.share[p];
      g = g + Vec2{m[0] * d.y + m[1] * d.z, m[2] * d.y + m[3] * d.z};
    }
    result[k] = {data[c.vertex].x, g.x, g.y};
  }
  return result;
}

}  // namespace retalho
