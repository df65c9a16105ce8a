#include "retalho/tetraquad/half_faces.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "retalho/core/error.h"

namespace retalho {
namespace {

struct Face {
  std::array<std::uint32_t, 3> key;
  std::uint32_t half_face;
};

bool holds(const TetCorners& tet, std::uint32_t vertex) {
  return std::find(tet.begin(), tet.end(), vertex) != tet.end();
}

void sort_unique(std::vector<std::uint32_t>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

HalfFaces::HalfFaces(std::vector<TetCorners> tets, std::size_t vertices) : tets_(std::move(tets)) {
  if (tets_.size() > std::size_t{1} << 29) throw BadInput("more than 2^29 tetrahedra");
  opposite_.assign(4 * tets_.size(), -1);
  std::vector<Face> faces(4 * tets_.size());
  for (std::size_t t = 0; t < tets_.size(); ++t) {
    TetCorners sorted = tets_[t];
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end() || sorted[3] >= vertices)
      throw BadInput(fmt::format("tetrahedron {} names a vertex twice, or one that does not exist", t));
    for (std::size_t i = 0; i < 4; ++i) {
      Face& face = faces[4 * t + i];
      face.half_face = static_cast<std::uint32_t>(4 * t + i);
      std::size_t n = 0;
      for (const std::uint32_t v : sorted)
        if (v != tets_[t][i]) face.key[n++] = v;
    }
  }
  std::sort(faces.begin(), faces.end(),
            [](const Face& a, const Face& b) { return a.key != b.key ? a.key < b.key : a.half_face < b.half_face; });
  for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
    if (faces[i].key != faces[i + 1].key) continue;
    if (i + 2 < faces.size() && faces[i + 2].key == faces[i].key)
      throw BadInput(fmt::format("the face {} {} {} belongs to three tetrahedra", faces[i].key[0], faces[i].key[1],
                                 faces[i].key[2]));
    opposite_[faces[i].half_face] = static_cast<std::int32_t>(faces[i + 1].half_face);
    opposite_[faces[i + 1].half_face] = static_cast<std::int32_t>(faces[i].half_face);
  }

  // One tetrahedron of each fan: corners of one vertex joined across the faces that hold it.
  std::vector<std::uint32_t> parent(4 * tets_.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t c) {
    while (parent[c] != c) c = parent[c] = parent[parent[c]];
    return c;
  };
  for (std::uint32_t f = 0; f < opposite_.size(); ++f) {
    if (opposite_[f] < static_cast<std::int32_t>(f)) continue;
    const std::uint32_t t = f / 4, other = static_cast<std::uint32_t>(opposite_[f]) / 4;
    for (std::uint32_t i = 0; i < 4; ++i) {
      if (i == f % 4) continue;
      const auto at = std::find(tets_[other].begin(), tets_[other].end(), tets_[t][i]) - tets_[other].begin();
      const std::uint32_t a = root(4 * t + i), b = root(4 * other + static_cast<std::uint32_t>(at));
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  first_.resize(vertices);
  for (std::uint32_t c = 0; c < parent.size(); ++c)
    if (root(c) == c) first_[vertex(c)].push_back(c / 4);
}

std::vector<std::uint32_t> HalfFaces::star(std::uint32_t vertex) const {
  std::vector<std::uint32_t> found = first_.at(vertex);
  // Stars are small (24 on a regular grid): a linear search for what was seen is faster than a hash.
  for (std::size_t n = 0; n < found.size(); ++n) {
    for (std::size_t i = 0; i < 4; ++i) {
      const std::int64_t next = tets_[found[n]][i] == vertex ? -1 : neighbour(found[n], i);
      if (next >= 0 && std::find(found.begin(), found.end(), next) == found.end())
        found.push_back(static_cast<std::uint32_t>(next));
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::uint32_t> HalfFaces::star(std::uint32_t a, std::uint32_t b) const {
  std::vector<std::uint32_t> found = star(a);
  std::erase_if(found, [&](std::uint32_t t) { return !holds(tets_[t], b); });
  return found;
}

std::vector<std::uint32_t> HalfFaces::link(std::uint32_t vertex) const {
  std::vector<std::uint32_t> found = star(vertex);
  for (std::uint32_t& t : found) {
    const auto at = std::find(tets_[t].begin(), tets_[t].end(), vertex) - tets_[t].begin();
    t = 4 * t + static_cast<std::uint32_t>(at);
  }
  return found;
}

std::vector<std::uint32_t> HalfFaces::neighbours(std::uint32_t vertex) const {
  std::vector<std::uint32_t> found;
  for (const std::uint32_t t : star(vertex))
    for (const std::uint32_t v : tets_[t])
      if (v != vertex) found.push_back(v);
  sort_unique(found);
  return found;
}

std::vector<std::uint32_t> HalfFaces::border() const {
  std::vector<std::uint32_t> found;
  for (std::uint32_t f = 0; f < opposite_.size(); ++f)
    if (opposite_[f] < 0) found.push_back(f);
  return found;
}

std::vector<std::uint32_t> HalfFaces::components(std::size_t* count) const {
  constexpr std::uint32_t none = ~0U;
  std::vector<std::uint32_t> number(tets_.size(), none), queue;
  std::uint32_t next = 0;
  for (std::uint32_t seed = 0; seed < tets_.size(); ++seed) {
    if (number[seed] != none) continue;
    queue.assign(1, seed);
    number[seed] = next;
    while (!queue.empty()) {
      const std::uint32_t t = queue.back();
      queue.pop_back();
      for (std::size_t i = 0; i < 4; ++i) {
        const std::int64_t o = neighbour(t, i);
        if (o < 0 || number[static_cast<std::size_t>(o)] != none) continue;
        number[static_cast<std::size_t>(o)] = next;
        queue.push_back(static_cast<std::uint32_t>(o));
      }
    }
    ++next;
  }
  if (count != nullptr) *count = next;
  return number;
}

}  // namespace retalho
