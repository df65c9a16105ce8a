#include "retalho/level/void_border.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <unordered_map>

namespace retalho {
namespace {

// Three kinds of nodes: vertices of the triangulation by their number, corners of cells, crossings of outline and side.
constexpr std::uint64_t kFirstCorner = std::uint64_t{1} << 33, kFirstCrossing = std::uint64_t{1} << 62;

struct Node {
  std::uint64_t key;
  Vec2 place;
};

/// What lies on a side: the cut of a line, or a crossing of the outline.
struct SideItem {
  enum class Kind { cut, opens, closes };  ///< opens: the triangulation lies behind it, in the side's direction
  Kind kind;
  std::uint32_t root;
  Node node;
  double along = 0;  ///< in the side's direction, from its start
};

class VoidBorder {
 public:
  VoidBorder(const GridDomain& grid, std::span<const Vec2> root_places, const std::function<bool(Vec2)>& inside)
      : grid_(grid), root_places_(root_places), inside_(inside) {}

  void add_outline(const std::vector<DirectedBorder>& outline) {
    std::unordered_map<std::uint64_t, Vec2> place;
    place.reserve(outline.size());
    for (const DirectedBorder& piece : outline) place.emplace(piece.from, piece.place);
    for (const DirectedBorder& piece : outline) add_piece(piece, {piece.to, place.at(piece.to)});
  }
  void add_cuts(const std::vector<LineCut>& cuts) {
    for (const LineCut& cut : cuts) items_[key(cut.side)].push_back({SideItem::Kind::cut, cut.root, {0, cut.place}});
  }
  void add_sides(const Context& context) {
    for (int r = -1; r < grid_.rows; ++r) {
      context.check();
      for (int c = -1; c < grid_.columns; ++c) {
        const bool here = holds_data({c, r}, grid_), east = holds_data({c + 1, r}, grid_),
                   south = holds_data({c, r + 1}, grid_);
        // Data to the left of the direction.
        if (here != east)
          add_side({c, r, true}, here ? Cell{c, r} : Cell{c, r - 1}, here ? Cell{c, r - 1} : Cell{c, r});
        if (here != south)
          add_side({c, r, false}, here ? Cell{c - 1, r} : Cell{c, r}, here ? Cell{c, r} : Cell{c - 1, r});
      }
    }
  }
  std::vector<DirectedBorder> take() { return std::move(border_); }

 private:
  std::uint64_t cell_key(Cell c) const {
    return static_cast<std::uint64_t>(c.row + 1) * (static_cast<std::uint64_t>(grid_.columns) + 1) +
           static_cast<std::uint64_t>(c.column + 1);
  }
  std::uint64_t key(const CellSide& s) const { return 2 * cell_key({s.column, s.row}) + (s.vertical ? 1 : 0); }
  Node corner(Cell c) const { return {kFirstCorner + cell_key(c), corner_place(c, grid_)}; }

  void emit(const Node& from, const Node& to, Vec2 along, int band, std::vector<std::uint32_t>&& roots) {
    border_.push_back({from.key, to.key, from.place, along, band, std::move(roots)});
  }

  /// The stretches of an edge of the outline in cells with data.
  void add_piece(const DirectedBorder& piece, const Node& to) {
    Node start{piece.from, piece.place};
    int band = piece.band;
    std::vector<std::uint32_t> roots;
    bool inside = holds_data(cell_of(piece.place, grid_), grid_);
    const auto walk = [&](Vec2 a, Vec2 b) {
      walk_cells(a, b, grid_, [&](Cell left, Cell entered, CellSide side, Vec2 place) {
        const bool was = holds_data(left, grid_), will = holds_data(entered, grid_);
        if (was == will) return;
        const Node node{kFirstCrossing + crossings_++, place};
        items_[key(side)].push_back({was ? SideItem::Kind::opens : SideItem::Kind::closes, kNoPoint, node});
        if (was) emit(start, node, piece.along, band, std::move(roots));
        roots.clear();
        start = node;
        band = DirectedBorder::kUnknownBand;
        inside = will;
      });
    };
    Vec2 here = piece.place;
    for (const std::uint32_t root : piece.roots) {
      walk(here, root_places_[root]);
      here = root_places_[root];
      if (inside) roots.push_back(root);
    }
    walk(here, to.place);
    if (inside) emit(start, to, piece.along, band, std::move(roots));
  }

  /// The stretches of a side on the triangulation.
  void add_side(const CellSide& side, Cell from, Cell to) {
    const Node first = corner(from), last = corner(to);
    const auto found = items_.find(key(side));
    std::vector<SideItem> none;
    std::vector<SideItem>& items = found == items_.end() ? none : found->second;
    for (SideItem& item : items) item.along = dot(item.node.place - first.place, last.place - first.place);
    std::stable_sort(items.begin(), items.end(),
                     [](const SideItem& a, const SideItem& b) { return a.along < b.along; });
    const auto crossing = [](const SideItem& item) { return item.kind != SideItem::Kind::cut; };
    const auto first_crossing = std::find_if(items.begin(), items.end(), crossing);
    bool inside = first_crossing != items.end() ? first_crossing->kind == SideItem::Kind::closes
                                                : inside_(0.5 * (first.place + last.place));
    Node start = first;
    std::size_t stretches = 0;
    std::vector<std::uint32_t> roots;  // outside of the triangulation by rounding alone: they wait for where it opens
    const auto close = [&](const Node& end) {
      emit(start, end, last.place - first.place, DirectedBorder::kAskMiddle, std::move(roots));
      roots.clear();
      ++stretches;
      inside = false;
    };
    for (auto item = items.begin(); item != items.end(); ++item) {
      if (item->kind == SideItem::Kind::cut) {
        roots.push_back(item->root);
        continue;
      }
      // Two crossings at one place may have been found in either order.
      const auto due = inside ? SideItem::Kind::closes : SideItem::Kind::opens;
      if (item->kind != due) {
        const auto other = std::find_if(item, items.end(), [&](const SideItem& x) { return x.kind == due; });
        // Without one the outline would enter twice: build_bands finds the gap and says so.
        if (other == items.end()) continue;
        std::iter_swap(item, other);
      }
      if (inside) {
        close(item->node);
      } else {
        start = item->node;
        inside = true;
      }
    }
    if (inside)
      close(last);
    else if (!roots.empty() && stretches > 0)  // behind the last stretch by rounding alone
      border_.back().roots.insert(border_.back().roots.end(), roots.begin(), roots.end());
  }

  const GridDomain& grid_;
  std::span<const Vec2> root_places_;
  const std::function<bool(Vec2)>& inside_;
  std::unordered_map<std::uint64_t, std::vector<SideItem>> items_;
  std::vector<DirectedBorder> border_;
  std::uint64_t crossings_ = 0;
};

}  // namespace

std::vector<DirectedBorder> void_border(const GridDomain& grid, const std::vector<DirectedBorder>& outline,
                                        std::span<const Vec2> root_places, const std::vector<LineCut>& cuts,
                                        const std::function<bool(Vec2)>& inside, const Context& context) {
  VoidBorder border(grid, root_places, inside);
  border.add_outline(outline);
  border.add_cuts(cuts);
  border.add_sides(context);
  return border.take();
}

}  // namespace retalho
