#include "retalho/tetraquad/ray_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "retalho/core/parallel.h"
#include "retalho/tetraquad/tight_box.h"

namespace retalho {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr RayBox kNothing{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
/// From this depth on ranges are cut in the middle: no boxes make the tree deeper than 96, seven entries a level.
constexpr int kDeep = 64;

void extend(RayBox& box, const RayBox& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    box.low[k] = std::min(box.low[k], other.low[k]);
    box.high[k] = std::max(box.high[k], other.high[k]);
  }
}

double half_area(const RayBox& box) {
  const double x = box.high[0] - box.low[0], y = box.high[1] - box.low[1], z = box.high[2] - box.low[2];
  return x * y + y * z + z * x;
}

/// A range of the boxes in the builder's order.
struct Range {
  std::size_t begin = 0, end = 0;
  RayBox box = kNothing;
  int depth = 0;
};

class Builder {
 public:
  explicit Builder(const std::vector<RayBox>& boxes) : boxes_(boxes) {
    const std::size_t count = boxes.size();
    for (std::size_t k = 0; k < 3; ++k) {
      order_[k].resize(count);
      std::iota(order_[k].begin(), order_[k].end(), 0U);
      std::sort(order_[k].begin(), order_[k].end(), [&](std::uint32_t a, std::uint32_t b) {
        const float at_a = boxes[a].low[k] + boxes[a].high[k], at_b = boxes[b].low[k] + boxes[b].high[k];
        return at_a != at_b ? at_a < at_b : a < b;
      });
    }
    scratch_.resize(count);
    is_left_.resize(count);
    areas_.resize(count);
  }

  std::vector<RayNode> build() {
    if (boxes_.empty()) return {};
    Range all{0, boxes_.size(), kNothing, 0};
    for (const RayBox& box : boxes_) extend(all.box, box);
    add_node(all);
    return std::move(nodes_);
  }

 private:
  std::uint32_t add_node(const Range& whole) {
    const auto place = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    std::vector<Range> parts = {whole};
    while (parts.size() < kRayWidth) {
      std::size_t widest = parts.size();
      double largest = -1;
      for (std::size_t i = 0; i < parts.size(); ++i)
        if (parts[i].end - parts[i].begin > 1 && half_area(parts[i].box) > largest) {
          largest = half_area(parts[i].box);
          widest = i;
        }
      if (widest == parts.size()) break;
      Range right;
      split(parts[widest], right);
      parts.push_back(right);
    }
    RayNode node;
    for (std::size_t i = 0; i < kRayWidth; ++i) {
      const RayBox box = i < parts.size() ? parts[i].box : kNothing;
      for (std::size_t k = 0; k < 3; ++k) {
        node.plane[k][i] = box.low[k];
        node.plane[3 + k][i] = box.high[k];
      }
      node.child[i] = 0;
    }
    for (std::size_t i = 0; i < parts.size(); ++i)
      node.child[i] = parts[i].end - parts[i].begin == 1 ? kRayLeaf | order_[0][parts[i].begin] : add_node(parts[i]);
    nodes_[place] = node;
    return place;
  }

  /// Cuts the range where the sum of the halves' areas times their boxes is least.
  void split(Range& range, Range& right) {
    std::size_t axis = 0, at = (range.begin + range.end) / 2;
    if (range.depth < kDeep) {
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::vector<std::uint32_t>& order = order_[k];
        RayBox box = kNothing;
        for (std::size_t i = range.end; i-- > range.begin + 1;) {
          extend(box, boxes_[order[i]]);
          areas_[i] = half_area(box) * static_cast<double>(range.end - i);
        }
        box = kNothing;
        for (std::size_t i = range.begin + 1; i < range.end; ++i) {
          extend(box, boxes_[order[i - 1]]);
          const double cost = half_area(box) * static_cast<double>(i - range.begin) + areas_[i];
          if (cost < least) {
            least = cost;
            axis = k;
            at = i;
          }
        }
      }
    }
    for (std::size_t i = range.begin; i < range.end; ++i) is_left_[order_[axis][i]] = i < at ? 1 : 0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == axis) continue;
      std::size_t left = range.begin, behind = 0;
      for (std::size_t i = range.begin; i < range.end; ++i) {
        const std::uint32_t box = order_[k][i];
        if (is_left_[box] != 0)
          order_[k][left++] = box;
        else
          scratch_[behind++] = box;
      }
      std::copy(scratch_.begin(), scratch_.begin() + static_cast<std::ptrdiff_t>(behind),
                order_[k].begin() + static_cast<std::ptrdiff_t>(left));
    }
    right = {at, range.end, kNothing, range.depth + 1};
    range = {range.begin, at, kNothing, range.depth + 1};
    for (Range* half : {&range, &right})
      for (std::size_t i = half->begin; i < half->end; ++i) extend(half->box, boxes_[order_[0][i]]);
  }

  const std::vector<RayBox>& boxes_;
  std::array<std::vector<std::uint32_t>, 3> order_;  // boxes by their middles along each axis
  std::vector<std::uint32_t> scratch_;
  std::vector<char> is_left_;
  std::vector<double> areas_;
  std::vector<RayNode> nodes_;
};

RayBox rounded_outwards(const TightBox& box, double slack) {
  const std::array<double, 3> low = {box.low.x, box.low.y, box.low.z}, high = {box.high.x, box.high.y, box.high.z};
  RayBox rounded;
  for (std::size_t k = 0; k < 3; ++k) {
    rounded.low[k] = std::nextafter(static_cast<float>(low[k] - slack), -kInfinity);
    rounded.high[k] = std::nextafter(static_cast<float>(high[k] + slack), kInfinity);
  }
  return rounded;
}

/// Adds a tetrahedron to the tree's arrays; its frame is looked for among those that there are.
class PrimWriter {
 public:
  PrimWriter(const TetraQuadField& field, RayTree& tree) : field_(field), tree_(tree) {}

  std::uint32_t add(std::uint32_t tet, const std::array<Vec3, 4>& x) {
    const TetFrame frame(x[0], x[1], x[2], x[3]);
    std::array<double, 12> key;
    for (std::size_t i = 0; i < 4; ++i) {
      key[i] = frame.gradients[i].x;
      key[4 + i] = frame.gradients[i].y;
      key[8 + i] = frame.gradients[i].z;
    }
    const auto [at, fresh] = places_.try_emplace(key, static_cast<std::uint32_t>(tree_.frames.size()));
    if (fresh) {
      tree_.frames.emplace_back();
      std::copy(key.begin(), key.end(), &tree_.frames.back().axis[0][0]);
    }
    RayPrim prim{{x[0].x, x[0].y, x[0].z}, at->second, tet, {}};
    const TetCubic& c = field_.ordinates(tet);
    std::copy(c.begin(), c.end(), prim.ordinate);
    tree_.prims.push_back(prim);
    return static_cast<std::uint32_t>(tree_.prims.size() - 1);
  }

 private:
  const TetraQuadField& field_;
  RayTree& tree_;
  std::map<std::array<double, 12>, std::uint32_t> places_;
};

}  // namespace

std::vector<RayNode> build_ray_nodes(const std::vector<RayBox>& boxes) {
  return Builder(boxes).build();
}

RayScene RayTree::scene() const {
  RayScene scene{nodes.data(), prims.data(), frames.data(), {}, {}};
  std::copy(all.low.begin(), all.low.end(), scene.low);
  std::copy(all.high.begin(), all.high.end(), scene.high);
  return scene;
}

RayTree make_ray_tree(const TetraQuadField& field, int halvings, const Context& context) {
  const TetMesh& mesh = field.surface().mesh;
  const auto corner = [&](std::uint32_t v) {
    const LatticePoint& l = mesh.lattice[v];
    return Vec3{static_cast<double>(l[0]), static_cast<double>(l[1]), static_cast<double>(l[2])};
  };
  RayTree tree;
  std::vector<std::uint32_t> crossed;
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high = -low;
  for (std::uint32_t t = 0; t < mesh.tets.size(); ++t) {
    if (!field.may_cross(t)) continue;
    crossed.push_back(t);
    for (const std::uint32_t v : mesh.tets[t]) {
      const Vec3 p = corner(v);
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  if (crossed.empty()) return tree;
  tree.middle = 0.5 * (low + high);
  const auto corners = [&](std::uint32_t t) {
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = corner(mesh.tets[t][i]) - tree.middle;
    return x;
  };
  // A ray in the box of all loses less than four units in the last place of the box's size.
  const Vec3 half = 0.5 * (high - low);
  const double slack = 3e-6 * (1 + std::max({half.x, half.y, half.z}));
  std::vector<RayBox> tight(crossed.size());
  parallel_chunks(crossed.size(), 64, context, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const auto box = tight_box(field.ordinates(crossed[n]), corners(crossed[n]), std::max(0, halvings));
      tight[n] = box ? rounded_outwards(*box, slack) : kNothing;
    }
  });
  std::vector<std::uint32_t> kept;  // tetrahedra, by the places of their boxes
  std::vector<RayBox> boxes;
  tree.all = kNothing;
  for (std::size_t n = 0; n < crossed.size(); ++n) {
    if (tight[n].low[0] > tight[n].high[0]) continue;
    kept.push_back(crossed[n]);
    boxes.push_back(tight[n]);
    extend(tree.all, tight[n]);
  }
  tree.nodes = build_ray_nodes(boxes);
  // What the nodes name one after the other lies close in space, and so in memory.
  PrimWriter writer(field, tree);
  for (RayNode& node : tree.nodes)
    for (std::uint32_t& child : node.child)
      if ((child & kRayLeaf) != 0) {
        const std::uint32_t t = kept[child & ~kRayLeaf];
        child = kRayLeaf | writer.add(t, corners(t));
      }
  return tree;
}

}  // namespace retalho
