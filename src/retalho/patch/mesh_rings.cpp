#include "retalho/patch/mesh_rings.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "retalho/core/error.h"

namespace retalho {
namespace {

std::string at(std::span<const Vec3> positions, std::uint32_t v) {
  return fmt::format("vertex {} ({:.6g}, {:.6g}, {:.6g})", v, positions[v].x, positions[v].y, positions[v].z);
}

[[noreturn]] void fail(const std::string& words, const std::string& where) {
  throw BadInput(words, {}, where);
}

/// What is wrong with the edge from v to a, which two triangles run along the same way.
[[noreturn]] void fail_edge(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::uint32_t v,
                            std::uint32_t a) {
  std::vector<std::size_t> of;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto has = [&](std::uint32_t x) {
      return std::find(triangles[t].begin(), triangles[t].end(), x) != triangles[t].end();
    };
    if (has(v) && has(a)) of.push_back(t);
  }
  const std::string where = fmt::format("edge {} {}", v, a);
  if (of.size() > 2)
    fail(fmt::format("the edge from {} to {} belongs to {} triangles (among them {}, {} and {}): a surface has at most "
                     "two at an edge",
                     at(positions, v), at(positions, a), of.size(), of[0], of[1], of[2]),
         where);
  fail(fmt::format("triangles {} and {} are oriented against each other at the edge from {} to {}: turn one of them "
                   "round (all of a surface's triangles go the same way)",
                   of[0], of[1], at(positions, v), at(positions, a)),
       where);
}

}  // namespace

MeshRings mesh_rings(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  const std::size_t count = positions.size();
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Triangle& c = triangles[t];
    for (const std::uint32_t v : c)
      if (v >= count)
        fail(fmt::format("triangle {} names vertex {}, and there are {}", t, v, count), fmt::format("triangle {}", t));
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0])
      fail(fmt::format("triangle {} names vertex {} twice", t, c[0] == c[1] ? c[0] : c[2]),
           fmt::format("triangle {}", t));
    for (std::size_t k = 0; k < 3; ++k)
      if (positions[c[k]] == positions[c[(k + 1) % 3]])
        fail(fmt::format("triangle {} has an edge of no length, from {} to {}", t, at(positions, c[k]),
                         at(positions, c[(k + 1) % 3])),
             fmt::format("triangle {}", t));
  }
  const VertexTriangles around = vertex_triangles(triangles, count);
  MeshRings rings;
  rings.first.reserve(count + 1);
  rings.first.push_back(0);
  rings.neighbors.reserve(3 * triangles.size() + count / 8);
  rings.border.assign(count, 0);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  std::size_t lonely = 0;
  std::uint32_t first_lonely = 0;
  for (std::uint32_t v = 0; v < count; ++v) {
    links.clear();
    for (const std::uint32_t t : around.of(v)) {
      const Triangle& c = triangles[t];
      const std::size_t k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
      links.emplace_back(c[(k + 1) % 3], c[(k + 2) % 3]);
    }
    if (links.empty() && lonely++ == 0) first_lonely = v;
    // Long fans are chained by search in a sorted list; for the usual six a scan is faster.
    const bool sorted = links.size() > 16;
    if (sorted) std::sort(links.begin(), links.end());
    const auto find = [&](std::uint32_t a) -> std::size_t {
      if (sorted) {
        const auto i = std::lower_bound(links.begin(), links.end(), std::pair<std::uint32_t, std::uint32_t>(a, 0));
        return i != links.end() && i->first == a ? static_cast<std::size_t>(i - links.begin()) : links.size();
      }
      std::size_t i = 0;
      while (i < links.size() && links[i].first != a) ++i;
      return i;
    };
    std::vector<std::uint32_t> ends;
    if (sorted) {
      for (const auto& l : links) ends.push_back(l.second);
      std::sort(ends.begin(), ends.end());
    }
    std::size_t start = links.size(), starts = 0;
    for (std::size_t i = 0; i < links.size(); ++i) {
      bool reached = false;
      if (sorted) {
        if (i > 0 && links[i].first == links[i - 1].first) fail_edge(positions, triangles, v, links[i].first);
        if (i > 0 && ends[i] == ends[i - 1]) fail_edge(positions, triangles, v, ends[i]);
        reached = std::binary_search(ends.begin(), ends.end(), links[i].first);
      } else {
        for (std::size_t j = 0; j < links.size(); ++j) {
          if (j < i && links[j].first == links[i].first) fail_edge(positions, triangles, v, links[i].first);
          if (j < i && links[j].second == links[i].second) fail_edge(positions, triangles, v, links[i].second);
          reached = reached || links[j].second == links[i].first;
        }
      }
      if (!reached) {
        start = i;
        ++starts;
      }
    }
    const auto touch = [&] {
      fail(fmt::format("two parts of the surface touch at {}, which belongs to both: give each a vertex of its own",
                       at(positions, v)),
           fmt::format("vertex {}", v));
    };
    if (starts > 1) touch();
    rings.border[v] = starts == 1 ? 1 : 0;
    std::size_t visited = 0;
    if (!links.empty()) {
      std::size_t i = starts == 1 ? start : 0;
      const std::size_t begin = i;
      rings.neighbors.push_back(links[i].first);
      for (;;) {
        ++visited;
        const std::uint32_t b = links[i].second;
        i = find(b);
        if (i == begin && starts == 0) break;
        rings.neighbors.push_back(b);
        if (i == links.size()) break;
      }
    }
    if (visited != links.size()) touch();
    rings.first.push_back(static_cast<std::uint32_t>(rings.neighbors.size()));
  }
  if (lonely > 0)
    fail(fmt::format("{} vertices belong to no triangle, the first is {}: remove them", lonely,
                     at(positions, first_lonely)),
         fmt::format("vertex {}", first_lonely));
  return rings;
}

std::vector<std::uint32_t> disk_border(const MeshRings& rings, std::span<const Vec3> positions, std::size_t triangles) {
  const std::size_t count = positions.size();
  if (triangles == 0) fail("the mesh has no triangles", "triangles");
  // Parts.
  std::vector<std::uint8_t> seen(count, 0);
  std::vector<std::uint32_t> queue;
  std::string parts;
  std::size_t part_count = 0;
  for (std::uint32_t v = 0; v < count; ++v) {
    if (seen[v] != 0) continue;
    queue.assign(1, v);
    seen[v] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i)
      for (const std::uint32_t w : rings.of(queue[i]))
        if (seen[w] == 0) {
          seen[w] = 1;
          queue.push_back(w);
        }
    if (++part_count <= 4)
      parts += fmt::format("{}{} vertices with {}", part_count == 1 ? "" : "; ", queue.size(), at(positions, v));
  }
  if (part_count > 1)
    fail(fmt::format("the mesh has {} separate parts ({}{}): a patch is one", part_count, parts,
                     part_count > 4 ? "; ..." : ""),
         "parts");
  // Borders.
  std::fill(seen.begin(), seen.end(), std::uint8_t{0});
  std::vector<std::uint32_t> border;
  std::string holes;
  std::size_t loops = 0, border_edges = 0;
  for (std::uint32_t v = 0; v < count; ++v) {
    if (rings.border[v] == 0 || seen[v] != 0) continue;
    std::vector<std::uint32_t> loop;
    for (std::uint32_t w = v; seen[w] == 0; w = rings.of(w)[0]) {
      seen[w] = 1;
      loop.push_back(w);
    }
    if (++loops <= 4) holes += fmt::format("{}{} edges with {}", loops == 1 ? "" : "; ", loop.size(), at(positions, v));
    border_edges += loop.size();
    if (loops == 1) border = std::move(loop);
  }
  if (loops == 0) fail("the mesh is closed: a patch has a border, on which its three corners are", "border");
  if (loops > 1)
    fail(fmt::format("the mesh has {} borders ({}{}): fill all holes but one", loops, holes, loops > 4 ? "; ..." : ""),
         "border");
  const auto edges = static_cast<long long>((3 * triangles + border_edges) / 2);
  const long long euler = static_cast<long long>(count) - edges + static_cast<long long>(triangles);
  if (euler != 1)
    fail(fmt::format("the mesh has {} handle{}: a patch is a disk", (1 - euler) / 2, euler == -1 ? "" : "s"),
         "handles");
  return border;
}

}  // namespace retalho
