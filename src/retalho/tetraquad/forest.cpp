#include "retalho/tetraquad/forest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "retalho/core/error.h"

namespace retalho {
namespace {

/// The axes in the order in which a root's path takes them.
constexpr std::array<std::array<std::size_t, 3>, 6> kPaths = {
    {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};

std::uint64_t key(const TetForest::LatticePlace& p) {
  const auto part = [](std::int32_t c) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(c + (1 << 20)));
  };
  return part(p[0]) | part(p[1]) << 21 | part(p[2]) << 42;
}

}  // namespace

TetForest::TetForest(std::vector<LatticePlace> cubes) {
  std::sort(cubes.begin(), cubes.end());
  cubes.erase(std::unique(cubes.begin(), cubes.end()), cubes.end());
  for (const LatticePlace& cube : cubes) {
    for (const std::int32_t c : cube)
      if (std::abs(c) >= 1000) throw BadInput("an adaptive mesh of more than 1000 root cubes along a side");
    root_.emplace(key(cube), static_cast<std::uint32_t>(nodes_.size()));
    for (const auto& path : kPaths) {
      LatticePlace at = {cube[0] * kUnit, cube[1] * kUnit, cube[2] * kUnit};
      Node node;
      node.corners[0] = vertex(at);
      for (std::size_t n = 0; n < 3; ++n) {
        at[path[n]] += kUnit;
        node.corners[n + 1] = vertex(at);
      }
      nodes_.push_back(node);
    }
  }
}

std::uint32_t TetForest::vertex(const LatticePlace& at) {
  const auto [found, fresh] = number_.try_emplace(key(at), static_cast<std::uint32_t>(vertices_.size()));
  if (fresh) vertices_.push_back(at);
  return found->second;
}

TetForest::TetForest(std::vector<LatticePlace> cubes, std::span<const std::uint8_t> halved) {
  for (std::size_t n = 1; n < cubes.size(); ++n)
    if (!(cubes[n - 1] < cubes[n])) throw BadInput("the root cubes of an adaptive mesh are out of order");
  if (halved.size() < 6 * cubes.size()) throw BadInput("an adaptive mesh with fewer marks than roots");
  *this = TetForest(std::move(cubes));
  std::size_t at = 0;
  std::vector<std::uint32_t> stack;
  for (std::size_t root = 0; root < 6 * root_.size(); ++root) {
    stack.assign(1, static_cast<std::uint32_t>(root));
    while (!stack.empty()) {
      const std::uint32_t n = stack.back();
      stack.pop_back();
      if (at == halved.size()) throw BadInput("the marks of an adaptive mesh end inside of a tree");
      if (halved[at++] == 0) continue;
      if (nodes_[n].level >= kDeepest) throw BadInput(fmt::format("an adaptive mesh of more than {} levels", kDeepest));
      bisect_one(n);
      stack.push_back(static_cast<std::uint32_t>(nodes_[n].child) + 1);
      stack.push_back(static_cast<std::uint32_t>(nodes_[n].child));
    }
  }
  if (at != halved.size()) throw BadInput("an adaptive mesh with more marks than nodes");
  for (const Node& node : nodes_)
    if (node.child < 0 && has_hanging_vertex(node))
      throw BadInput("the tetrahedra of an adaptive mesh do not fit together");
}

std::vector<TetForest::LatticePlace> TetForest::cubes() const {
  std::vector<LatticePlace> found(root_.size());
  for (std::size_t n = 0; n < found.size(); ++n) {
    const LatticePlace& corner = vertices_[nodes_[6 * n].corners[0]];  // every path begins at the cube's lowest corner
    for (std::size_t d = 0; d < 3; ++d) found[n][d] = corner[d] / kUnit;
  }
  return found;
}

std::vector<std::uint8_t> TetForest::halved() const {
  std::vector<std::uint8_t> marks;
  marks.reserve(nodes_.size());
  std::vector<std::uint32_t> stack;
  for (std::size_t root = 0; root < 6 * root_.size(); ++root) {
    stack.assign(1, static_cast<std::uint32_t>(root));
    while (!stack.empty()) {
      const Node& node = nodes_[stack.back()];
      stack.pop_back();
      marks.push_back(node.child < 0 ? 0 : 1);
      if (node.child < 0) continue;
      stack.push_back(static_cast<std::uint32_t>(node.child) + 1);
      stack.push_back(static_cast<std::uint32_t>(node.child));
    }
  }
  return marks;
}

std::vector<std::uint32_t> TetForest::leaves() const {
  std::vector<std::uint32_t> found, stack;
  for (std::size_t root = 0; root < 6 * root_.size(); ++root) {
    stack.assign(1, static_cast<std::uint32_t>(root));
    while (!stack.empty()) {
      const std::uint32_t n = stack.back();
      stack.pop_back();
      if (nodes_[n].child < 0) {
        found.push_back(n);
        continue;
      }
      stack.push_back(static_cast<std::uint32_t>(nodes_[n].child) + 1);
      stack.push_back(static_cast<std::uint32_t>(nodes_[n].child));
    }
  }
  return found;
}

void TetForest::bisect_one(std::uint32_t number) {
  const Node node = nodes_[number];
  const std::size_t tag = node.tag();
  const LatticePlace &a = vertices_[node.corners[0]], &b = vertices_[node.corners[tag]];
  const std::uint32_t z = vertex({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2});
  Node first = node, second = node;
  first.level = second.level = static_cast<std::uint8_t>(node.level + 1);
  first.corners[tag] = z;
  for (std::size_t n = 0; n < tag; ++n) second.corners[n] = node.corners[n + 1];
  second.corners[tag] = z;
  nodes_[number].child = static_cast<std::int32_t>(nodes_.size());
  nodes_.push_back(first);
  nodes_.push_back(second);
}

bool TetForest::has_hanging_vertex(const Node& node) const {
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      const LatticePlace &a = vertices_[node.corners[i]], &b = vertices_[node.corners[j]];
      if (((a[0] + b[0]) | (a[1] + b[1]) | (a[2] + b[2])) & 1) continue;  // no lattice point in the middle
      if (number_.contains(key({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2}))) return true;
    }
  return false;
}

void TetForest::bisect(std::span<const std::uint32_t> chosen) {
  for (const std::uint32_t n : chosen)
    if (nodes_[n].child < 0 && nodes_[n].level < kDeepest) bisect_one(n);
  std::vector<std::uint32_t> look = leaves();
  bool changed = true;
  while (changed) {
    changed = false;
    std::vector<std::uint32_t> next;
    for (const std::uint32_t n : look) {
      if (!has_hanging_vertex(nodes_[n])) {
        next.push_back(n);
        continue;
      }
      bisect_one(n);
      next.push_back(static_cast<std::uint32_t>(nodes_[n].child));
      next.push_back(static_cast<std::uint32_t>(nodes_[n].child) + 1);
      changed = true;
    }
    look = std::move(next);
  }
}

std::int64_t TetForest::locate(Vec3 p, TetBarycentric* where) const {
  const std::array<double, 3> u = {p.x / kUnit, p.y / kUnit, p.z / kUnit};
  if (!(std::abs(u[0]) < 1000 && std::abs(u[1]) < 1000 && std::abs(u[2]) < 1000)) return -1;
  LatticePlace cube{};
  std::array<double, 3> f{};
  for (std::size_t d = 0; d < 3; ++d) {
    cube[d] = static_cast<std::int32_t>(std::floor(u[d]));
    f[d] = u[d] - cube[d];
  }
  const auto root = root_.find(key(cube));
  if (root == root_.end()) return -1;
  std::size_t path = 0;
  while (!(f[kPaths[path][0]] >= f[kPaths[path][1]] && f[kPaths[path][1]] >= f[kPaths[path][2]])) ++path;
  const auto& axes = kPaths[path];
  TetBarycentric b = {1 - f[axes[0]], f[axes[0]] - f[axes[1]], f[axes[1]] - f[axes[2]], f[axes[2]]};
  std::size_t n = root->second + path;
  while (nodes_[n].child >= 0) {
    const std::size_t tag = nodes_[n].tag();
    if (b[0] >= b[tag]) {
      b[0] -= b[tag];
      b[tag] *= 2;
      n = static_cast<std::size_t>(nodes_[n].child);
    } else {
      const double first = b[0], last = b[tag] - b[0];
      for (std::size_t k = 0; k + 1 < tag; ++k) b[k] = b[k + 1];
      b[tag - 1] = last;
      b[tag] = 2 * first;
      n = static_cast<std::size_t>(nodes_[n].child) + 1;
    }
  }
  if (where != nullptr) *where = b;
  return static_cast<std::int64_t>(n);
}

}  // namespace retalho
