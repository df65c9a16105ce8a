#include "retalho/level/clip.h"

#include <algorithm>
#include <utility>

namespace retalho {
namespace {

struct Part {
  std::vector<Vec2> points;
  std::array<std::uint32_t, 2> ends;
};

class LineClipper {
 public:
  LineClipper(const PlacedGrid& grid, std::uint32_t first_root)
      : grid_(grid), next_root_(first_root), near_(1e-9 * std::min(grid.cell_width, grid.cell_height)) {}

  /// The parts of a line in cells with data; `whole` when it is not cut.
  std::vector<Part>& clip(const ContourSet& set, const ContourLine& line, std::array<std::uint32_t, 2> ends,
                          bool& whole) {
    parts_.clear();
    stretches_.clear();
    split(set, line);
    drop_touches(line.closed);
    whole = stretches_.size() == 1;
    if (whole) {
      if (stretches_[0].inside) parts_.push_back({std::move(stretches_[0].points), ends});
      return parts_;
    }
    const std::size_t n = stretches_.size();
    std::vector<std::uint32_t> root(n + 1);  // root[k]: between stretch k - 1 and k
    for (std::size_t k = 0; k <= n; ++k) {
      const bool cut = line.closed ? k < n : k > 0 && k < n;
      if (!cut) continue;
      root[k] = next_root_++;
      cuts_.push_back({root[k], stretches_[k].side, stretches_[k].points.front()});
    }
    root[0] = line.closed ? root[0] : ends[0];
    root[n] = line.closed ? root[0] : ends[1];
    for (std::size_t k = 0; k < n; ++k) {
      if (!stretches_[k].inside) continue;
      parts_.push_back({std::move(stretches_[k].points), {root[k], root[k + 1]}});
      if (parts_.back().points.size() == 1) parts_.back().points.push_back(parts_.back().points.front());
    }
    return parts_;
  }
  std::vector<LineCut> take_cuts() { return std::move(cuts_); }

 private:
  /// A stretch of a line in cells with data, or without, both ends included.
  struct Stretch {
    bool inside;
    CellSide side;  ///< that it starts on; unused where the line itself starts
    std::vector<Vec2> points;
  };

  void split(const ContourSet& set, const ContourLine& line) {
    const std::size_t n = line.end - line.begin, segments = line.closed ? n : n - 1;
    const Vec2 start = set.points[line.begin];
    stretches_.push_back({holds_data(cell_of(start, grid_), grid_), {}, {start}});
    for (std::size_t i = 0; i < segments; ++i) {
      const Vec2 a = set.points[line.begin + i], b = set.points[line.begin + (i + 1) % n];
      walk_cells(a, b, grid_, [&](Cell, Cell to, CellSide side, Vec2 place) {
        if (holds_data(to, grid_) == stretches_.back().inside) return;
        append(stretches_.back(), place);
        stretches_.push_back({!stretches_.back().inside, side, {place}});
      });
      append(stretches_.back(), b);
    }
    // A closed line that was cut goes on over its own start.
    if (line.closed && stretches_.size() > 1 && stretches_.front().inside == stretches_.back().inside) {
      append(stretches_.back(), stretches_.front());
      stretches_.front() = std::move(stretches_.back());
      stretches_.pop_back();
    }
  }

  /// A stretch that does not leave the place where it starts, on one side, is none: the line touches the side there.
  /// Which of its ends came first could not be said.
  void drop_touches(bool closed) {
    for (std::size_t k = closed ? 0 : 1;
         closed ? stretches_.size() > 1 && k < stretches_.size() : k + 1 < stretches_.size();) {
      if (!touches(stretches_[k], stretches_[(k + 1) % stretches_.size()])) {
        ++k;
        continue;
      }
      if (closed && stretches_.size() == 2) {
        stretches_.erase(stretches_.begin() + static_cast<std::ptrdiff_t>(k));
        append(stretches_[0], stretches_[0].points.front());
        return;
      }
      if (closed) {  // a walk around may start anywhere
        const std::size_t before = (k + stretches_.size() - 1) % stretches_.size();
        std::rotate(stretches_.begin(), stretches_.begin() + static_cast<std::ptrdiff_t>(before), stretches_.end());
        k = 1;
      }
      append(stretches_[k - 1], stretches_[k + 1]);
      const auto gone = stretches_.begin() + static_cast<std::ptrdiff_t>(k);
      stretches_.erase(gone, gone + 2);
      k = closed ? 0 : std::max<std::size_t>(1, k - 1);
    }
  }
  bool touches(const Stretch& here, const Stretch& after) const {
    return here.side.column == after.side.column && here.side.row == after.side.row &&
           here.side.vertical == after.side.vertical &&
           std::all_of(here.points.begin(), here.points.end(),
                       [&](Vec2 p) { return norm(p - here.points.front()) <= near_; });
  }

  static void append(Stretch& to, Vec2 p) {
    if (!(to.points.back() == p)) to.points.push_back(p);
  }
  static void append(Stretch& to, const Stretch& more) {
    for (const Vec2 p : more.points) append(to, p);
  }

  PlacedGrid grid_;
  std::uint32_t next_root_;
  double near_;
  std::vector<Stretch> stretches_;
  std::vector<Part> parts_;
  std::vector<LineCut> cuts_;
};

}  // namespace

bool has_voids(const GridDomain& grid) {
  return grid.columns > 0 && !grid.valid.empty() &&
         grid.valid.count() != static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows);
}

std::vector<LineCut> clip_to_cells(ContourSet& set, std::vector<std::array<std::uint32_t, 2>>& ends,
                                   std::uint32_t first_root, const PlacedGrid& grid) {
  std::vector<Vec2> points;
  std::vector<ContourLine> lines;
  std::vector<std::array<std::uint32_t, 2>> new_ends;
  LineClipper clipper(grid, first_root);
  for (std::size_t l = 0; l < set.lines.size(); ++l) {
    const ContourLine& line = set.lines[l];
    bool whole = false;
    for (const Part& part : clipper.clip(set, line, ends[l], whole)) {
      ContourLine out{line.level, line.closed && whole, points.size(), 0};
      points.insert(points.end(), part.points.begin(), part.points.end());
      if (out.closed) points.pop_back();
      out.end = points.size();
      lines.push_back(out);
      new_ends.push_back(part.ends);
    }
  }
  set.points = std::move(points);
  set.lines = std::move(lines);
  ends = std::move(new_ends);
  return clipper.take_cuts();
}

void drop_points(ContourSet& set) {
  std::size_t write = 0, kept = 0;
  for (const ContourLine& line : set.lines) {
    bool point = true;
    for (std::size_t i = line.begin + 1; i < line.end; ++i) point = point && set.points[i] == set.points[line.begin];
    if (point) continue;
    const std::size_t begin = write;
    for (std::size_t i = line.begin; i < line.end; ++i) set.points[write++] = set.points[i];
    set.lines[kept++] = {line.level, line.closed, begin, write};
  }
  set.points.resize(write);
  set.lines.resize(kept);
}

}  // namespace retalho
