#include "retalho/tin/greedy_tiles.h"

#include <atomic>
#include <bit>
#include <cmath>
#include <memory>
#include <mutex>
#include <queue>
#include <span>

#include "retalho/core/error.h"
#include "retalho/core/parallel.h"
#include "retalho/tin/greedy_heap.h"
#include "retalho/tin/greedy_mesh.h"
#include "retalho/tin/grid_hull.h"

namespace retalho {
namespace {

using namespace greedy;

constexpr int kTile = 256;             // cells a side of the smallest tile
constexpr double kTileTriangles = 24;  // a tile is at least so many mean triangle sides wide
constexpr std::size_t kExactCells =
    1'000'000;  // smaller grids start in exact order: order matters most on coarse meshes
constexpr std::size_t kExactInsertions = 8192;
constexpr std::size_t kFewLeft = 200;  // so few are inserted one by one instead of in tiles
constexpr int kBuckets = 4096;         // 32 an octave
/// A level went past the budget: the caller takes the plain way.
struct Overshoot {};

constexpr float kDirty = -1e30F;  // in the start phase: not scanned yet

/// What one worker needs; handed from tile to tile.
struct Worker {
  Cavity cavity;
  std::vector<std::vector<std::uint32_t>> buckets{kBuckets};
  std::vector<std::size_t> heads = std::vector<std::size_t>(kBuckets, 0);
};

class WorkerPool {
 public:
  std::unique_ptr<Worker> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<Worker>();
    auto worker = std::move(free_.back());
    free_.pop_back();
    return worker;
  }
  void give(std::unique_ptr<Worker> worker) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(worker));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Worker>> free_;
};

template <class Height>
class Refinement {
 public:
  Refinement(const Raster& raster, const std::vector<Height>& heights, const RefineOptions& options,
             const Context& context)
      : raster_(raster),
        options_(options),
        context_(context),
        hull_(hull_of_valid(raster)),
        mesh_(raster.columns, raster.rows, kTile / 2, hull_) {
    reciprocals_.resize(static_cast<std::size_t>(std::max(raster.columns, raster.rows)) + 1);
    for (std::size_t i = 1; i < reciprocals_.size(); ++i) reciprocals_[i] = 1 / static_cast<double>(i);
    field_ = {heights.data(),     raster.columns, raster.rows, 0, raster.columns - 1, 0, raster.rows - 1, 0, 0, 24,
              reciprocals_.data()};
    vertices_ = hull_.size();
    set_tolerance(heights);
  }

  GridTin run() {
    const std::size_t budget = options_.vertices;
    const bool small = raster_.cells() <= kExactCells;
    if (budget == 0) {
      refine_sides();
      field_.x0 = field_.y0 = 1;  // the sides are done, and theirs alone
      field_.x1 -= 1;
      field_.y1 -= 1;
    }
    scan_all();
    if (small)
      insert_worst_first(budget > 0 ? std::min(budget, vertices_ + kExactInsertions) : vertices_ + kExactInsertions);
    else
      start(budget);
    for (;;) {
      const double largest = largest_error();
      // The last stretch to a budget is made in exact order; near it the levels are narrow, so as not to overshoot.
      if (largest <= 0 || (budget > 0 && vertices_ * 8 / 5 > budget)) break;
      const double threshold = largest * (budget > 0 && vertices_ * 6 > budget ? 0.84 : 0.5);
      if (budget > 0) field_.enough = threshold;
      refine_level(threshold > field_.tolerance ? threshold : 0);
      context_.report("triangulation", budget > 0 ? static_cast<double>(vertices_) / static_cast<double>(budget)
                                                  : 1 - (largest - field_.tolerance) / largest);
    }
    if (budget > 0) {
      if (vertices_ > budget) throw Overshoot();
      field_.sampled_rows = 0;
      scan_all();
      insert_worst_first(budget);
    }
    return result();
  }

 private:
  using Ids = std::vector<std::uint32_t>;

  /// The tolerance that scans use: a little under the one asked for where heights are not small integers, so that a
  /// checker that rounds differently agrees to the last bit.
  void set_tolerance(const std::vector<Height>& heights) {
    double largest = 0;
    bool integers = true;
    for (const Height h : heights) {
      if (std::isnan(h)) continue;
      const double z = static_cast<double>(h);
      largest = std::max(largest, std::abs(z));
      integers = integers && std::abs(z) < 0x1p49 && z == static_cast<double>(static_cast<std::int64_t>(z));
    }
    if (std::isinf(largest)) throw BadInput("the grid holds infinite heights; a void is NaN");
    const int side_bits = std::bit_width(static_cast<unsigned>(std::max(raster_.columns, raster_.rows) - 1));
    exact_ = integers && std::bit_width(static_cast<std::uint64_t>(largest)) + 1 + 2 * side_bits <= 49;
    const double asked = options_.max_error;
    const double rounding = largest * 0x1p-48;
    field_.tolerance = exact_ ? asked : std::max(asked - std::max(asked * 0x1p-40, rounding), rounding);
    field_.enough = field_.tolerance;
    const float base =
        std::max(static_cast<float>(field_.tolerance), static_cast<float>(std::max(largest, 1e-30) * 0x1p-60));
    first_bucket_ = static_cast<int>(std::bit_cast<std::uint32_t>(base) >> 18);
  }

  int bucket_of(float error) const {
    return std::clamp(static_cast<int>(std::bit_cast<std::uint32_t>(error) >> 18) - first_bucket_, 0, kBuckets - 1);
  }

  void refine_sides() {
    const auto worker = std::make_unique<Worker>();
    Ids pending;
    each([&](std::uint32_t id) { pending.push_back(id); });
    while (!pending.empty()) {
      const std::uint32_t id = pending.back();
      pending.pop_back();
      for (int k = 0; k < 3; ++k) {
        const Record& t = mesh_[id];
        const Cell a = t.corner[k], b = t.corner[k == 2 ? 0 : k + 1];
        if (t.link[k] != kNone || !on_side(a, b, raster_.columns, raster_.rows)) continue;
        const Cell worst = worst_on_side(raster_, a, b, options_.max_error);
        if (worst == a) continue;
        insert(id, worst, worker->cavity);
        pending.insert(pending.end(), worker->cavity.made.begin(),
                       worker->cavity.made.begin() + worker->cavity.made_size);
        break;
      }
    }
  }

  void insert(std::uint32_t id, Cell p, Cavity& cavity) {
    mesh_.open(id, p, nullptr, cavity);
    mesh_.fill(p, cavity);
    ++vertices_;
  }

  template <class Visit>
  void each(const Visit& visit) const {
    for (std::size_t b = 0; b < mesh_.block_count(); ++b) {
      std::uint32_t first = 0, last = 0;
      mesh_.block(b, first, last);
      for (; first < last; ++first) visit(first);
    }
  }

  /// In parallel over blocks of ids: visit(chunk, id).
  template <class Visit>
  void each_chunk(const Visit& visit) const {
    parallel_chunks(mesh_.block_count(), 16, context_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        std::uint32_t first = 0, last = 0;
        mesh_.block(b, first, last);
        for (; first < last; ++first) visit(begin / 16, first);
      }
    });
  }

  void scan_all() {
    each_chunk([&](std::size_t, std::uint32_t id) { scan_(field_, mesh_[id]); });
  }

  double largest_error() const {
    std::vector<float> largest((mesh_.block_count() + 15) / 16, 0);
    each_chunk(
        [&](std::size_t chunk, std::uint32_t id) { largest[chunk] = std::max(largest[chunk], mesh_[id].error); });
    return static_cast<double>(*std::max_element(largest.begin(), largest.end()));
  }

  /// One heap over all triangles, by (error, lowest cell), until there are `target` vertices or nothing is over the
  /// tolerance. All triangles are scanned; scans look at every row.
  void insert_worst_first(std::size_t target) {
    struct Entry {
      float error;
      Cell cell;
      std::uint32_t id;
      bool operator<(const Entry& o) const { return error != o.error ? error < o.error : cell > o.cell; }
    };
    const int sampled = field_.sampled_rows;
    field_.sampled_rows = 0;
    std::priority_queue<Entry> heap;
    const auto push = [&](std::uint32_t id) {
      if (mesh_[id].error > 0) heap.push({mesh_[id].error, mesh_[id].candidate, id});
    };
    each(push);
    const auto worker = std::make_unique<Worker>();
    while (!heap.empty() && vertices_ < target) {
      const Entry e = heap.top();
      heap.pop();
      const Record& t = mesh_[e.id];
      if (t.error != e.error || t.candidate != e.cell) continue;  // replaced since
      context_.check();
      insert(e.id, e.cell, worker->cavity);
      for (int i = 0; i < worker->cavity.made_size; ++i) {
        scan_(field_, mesh_[worker->cavity.made[i]]);
        push(worker->cavity.made[i]);
      }
    }
    field_.sampled_rows = sampled;
  }

  /// The first few insertions of a large grid, in rounds: all new triangles are scanned at once, then the worst ones
  /// down to a part of the largest error are split.
  void start(std::size_t budget) {
    std::size_t target = vertices_ + raster_.cells() / 2048;
    if (budget > 0) target = std::min(target, budget / 3);
    const auto worker = std::make_unique<Worker>();
    std::vector<Ids>& buckets = worker->buckets;
    Ids dirty;
    int top = -1;
    const auto sort_in = [&](std::uint32_t id) {
      const float error = mesh_[id].error;
      if (error <= 0) return;
      const int b = bucket_of(error);
      buckets[static_cast<std::size_t>(b)].push_back(id);
      top = std::max(top, b);
    };
    const auto scan_dirty = [&] {
      parallel_chunks(dirty.size(), 4, context_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) scan_(field_, mesh_[dirty[i]]);
      });
    };
    each(sort_in);
    while (vertices_ < target) {
      while (top >= 0 && buckets[static_cast<std::size_t>(top)].empty()) --top;
      if (top < 0) break;
      for (int b = top, low = std::max(0, top - 16); b >= low; --b) {  // half an octave: down to 0.7 of the largest
        Ids& bucket = buckets[static_cast<std::size_t>(b)];
        for (const std::uint32_t id : bucket) {
          const Record& t = mesh_[id];
          if (!(t.error > 0) || bucket_of(t.error) != b) continue;
          insert(id, t.candidate, worker->cavity);
          for (int i = 0; i < worker->cavity.made_size; ++i) {
            Record& made = mesh_[worker->cavity.made[i]];
            if (i < worker->cavity.removed_size && made.error == kDirty) continue;  // in the list already
            made.error = kDirty;
            dirty.push_back(worker->cavity.made[i]);
          }
        }
        bucket.clear();
      }
      scan_dirty();
      for (const std::uint32_t id : dirty) sort_in(id);
      dirty.clear();
    }
  }

  /// Inserts until no triangle is over the threshold.
  void refine_level(double threshold) {
    const auto least = static_cast<float>(threshold);
    const std::size_t triangles = mesh_.triangle_count();
    const double span = std::sqrt(static_cast<double>(raster_.cells()) / static_cast<double>(triangles));
    int side = kTile;
    while (side < 2 * kTileTriangles * span && side < 8192) side *= 2;
    Ids todo = over(least);
    while (!todo.empty()) {
      for (int pass = 0; pass < 4 && todo.size() > kFewLeft; ++pass) {
        const int shift = side / 2;
        todo = refine_tiles(todo, side, pass == 1 || pass == 2 ? shift : 0, pass == 1 || pass == 3 ? shift : 0, least);
      }
      Ids left;
      const bool once = todo.size() > kFewLeft;  // what is left in numbers goes back to the tiles after one step each
      auto worker = pool_.take();
      vertices_ += refine_list(todo, nullptr, least, once, *worker, left);
      pool_.give(std::move(worker));
      todo.swap(left);
    }
  }

  Ids over(float least) const {
    const std::size_t chunks = (mesh_.block_count() + 15) / 16;
    std::vector<Ids> found(chunks);
    each_chunk([&](std::size_t chunk, std::uint32_t id) {
      if (mesh_[id].error > 0 && mesh_[id].error >= least) found[chunk].push_back(id);
    });
    Ids all;
    for (const Ids& part : found) all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  /// One pass over all tiles of that shift; returns what could not be done inside a tile, in the tiles' order.
  Ids refine_tiles(const Ids& todo, int side, int shift_x, int shift_y, float least) {
    const int across = (raster_.columns + shift_x + side - 1) / side, down = (raster_.rows + shift_y + side - 1) / side;
    const std::size_t tiles = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
    const auto tile_of = [&](std::uint32_t id) {
      const Cell c = mesh_[id].candidate;
      return static_cast<std::size_t>((row_of(c) + shift_y) / side) * static_cast<std::size_t>(across) +
             static_cast<std::size_t>((column_of(c) + shift_x) / side);
    };
    std::vector<std::size_t> starts(tiles + 1, 0);
    Ids live;
    live.reserve(todo.size());
    for (const std::uint32_t id : todo)
      if (mesh_[id].error > 0 && mesh_[id].error >= least) live.push_back(id);
    for (const std::uint32_t id : live) ++starts[tile_of(id) + 1];
    for (std::size_t i = 0; i < tiles; ++i) starts[i + 1] += starts[i];
    Ids ordered(live.size());
    std::vector<std::size_t> place(starts.begin(), starts.end() - 1);
    for (const std::uint32_t id : live) ordered[place[tile_of(id)]++] = id;
    std::vector<Ids> deferred(tiles);
    std::vector<std::size_t> inserted(tiles, 0);
    parallel_chunks(tiles, 1, context_, [&](std::size_t begin, std::size_t end) {
      auto worker = pool_.take();
      for (std::size_t i = begin; i < end; ++i) {
        if (starts[i] == starts[i + 1]) continue;
        const Square square{static_cast<int>(i) % across * side - shift_x,
                            static_cast<int>(i) / across * side - shift_y, side};
        inserted[i] = refine_list(std::span(ordered).subspan(starts[i], starts[i + 1] - starts[i]), &square, least,
                                  false, *worker, deferred[i]);
      }
      pool_.give(std::move(worker));
    });
    Ids left;
    for (std::size_t i = 0; i < tiles; ++i) {
      vertices_ += inserted[i];
      left.insert(left.end(), deferred[i].begin(), deferred[i].end());
    }
    return left;
  }

  /// Refines the triangles of a list, worst bucket first, inside `square`; `deferred` gets those whose cavity leaves
  /// it. `once`: new triangles are deferred instead of refined. Returns the number of insertions.
  std::size_t refine_list(std::span<const std::uint32_t> list, const Square* square, float least, bool once,
                          Worker& worker, Ids& deferred) {
    int top = -1;
    std::size_t inserted = 0;
    const auto push = [&](std::uint32_t id) {
      const float error = mesh_[id].error;
      if (!(error > 0) || error < least) return;
      const int b = bucket_of(error);
      worker.buckets[static_cast<std::size_t>(b)].push_back(id);
      top = std::max(top, b);
    };
    for (const std::uint32_t id : list) push(id);
    Cavity& cavity = worker.cavity;
    while (top >= 0) {
      auto& bucket = worker.buckets[static_cast<std::size_t>(top)];
      auto& head = worker.heads[static_cast<std::size_t>(top)];
      if (head >= bucket.size()) {
        bucket.clear();
        head = 0;
        --top;
        continue;
      }
      const std::uint32_t id = bucket[head++];
      const Record& t = mesh_[id];
      if (!(t.error > 0) || bucket_of(t.error) != top) continue;  // replaced since
      const Cell p = t.candidate;
      if (!mesh_.open(id, p, square, cavity)) {
        deferred.push_back(id);
        continue;
      }
      mesh_.fill(p, cavity);
      ++inserted;
      for (int i = 0; i < cavity.made_size; ++i) {
        const std::uint32_t made = cavity.made[i];
        scan_(field_, mesh_[made]);
        if (!once)
          push(made);
        else if (mesh_[made].error > 0 && mesh_[made].error >= least)
          deferred.push_back(made);
      }
    }
    return inserted;
  }

  /// Vertices in raster order by a bitmap and its ranks, triangles in the order of their blocks.
  GridTin result() const {
    GridTin tin;
    const std::size_t columns = static_cast<std::size_t>(raster_.columns);
    const auto place = [&](Cell c) {
      return static_cast<std::size_t>(row_of(c)) * columns + static_cast<std::size_t>(column_of(c));
    };
    std::vector<std::uint64_t> used((raster_.cells() + 63) / 64, 0);
    each_chunk([&](std::size_t, std::uint32_t id) {
      for (const Cell c : mesh_[id].corner) {
        std::atomic_ref<std::uint64_t> word(used[place(c) / 64]);
        const std::uint64_t bit = std::uint64_t{1} << (place(c) % 64);
        if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
      }
    });
    std::vector<std::uint32_t> rank(used.size() + 1, 0);
    for (std::size_t i = 0; i < used.size(); ++i)
      rank[i + 1] = rank[i] + static_cast<std::uint32_t>(std::popcount(used[i]));
    tin.cells.reserve(rank.back());
    for (std::size_t i = 0; i < used.size(); ++i)
      for (std::uint64_t word = used[i]; word != 0; word &= word - 1) {
        const std::size_t cell = i * 64 + static_cast<std::size_t>(std::countr_zero(word));
        tin.cells.push_back(cell_at(static_cast<int>(cell % columns), static_cast<int>(cell / columns)));
      }
    const auto number = [&](Cell c) {
      const std::size_t p = place(c);
      return rank[p / 64] +
             static_cast<std::uint32_t>(std::popcount(used[p / 64] & ((std::uint64_t{1} << (p % 64)) - 1)));
    };
    std::vector<std::uint32_t> offset(mesh_.block_count() + 1, 0);
    std::uint32_t first = 0, last = 0;
    for (std::size_t b = 0; b < mesh_.block_count(); ++b) {
      mesh_.block(b, first, last);
      offset[b + 1] = offset[b] + (last - first);
    }
    // A record's number: its block's offset and its place there.
    const auto block_start = [&](std::size_t b) {
      std::uint32_t start = 0, end = 0;
      mesh_.block(b, start, end);
      return start;
    };
    const std::uint32_t second = mesh_.block_count() > 1 ? block_start(1) : 0,
                        size = mesh_.block_count() > 2 ? block_start(2) - second : kNone;
    const auto renumber = [&](std::uint32_t link) {
      if (link == kNone) return kNone;
      const std::uint32_t id = link >> 2;
      return id < second ? id : offset[1 + (id - second) / size] + (id - second) % size;
    };
    tin.triangles.resize(offset.back());
    tin.neighbors.resize(offset.back());
    std::vector<float> worst((mesh_.block_count() + 15) / 16, 0);
    parallel_chunks(mesh_.block_count(), 16, context_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) {
        std::uint32_t id = 0, stop = 0, n = offset[b];
        mesh_.block(b, id, stop);
        for (; id < stop; ++id, ++n) {
          const Record& t = mesh_[id];
          // Rows run south, so what turns left in (column, row) turns right seen from above: the order is reversed.
          tin.triangles[n] = {number(t.corner[0]), number(t.corner[2]), number(t.corner[1])};
          tin.neighbors[n] = {renumber(t.link[1]), renumber(t.link[0]), renumber(t.link[2])};
          worst[begin / 16] = std::max(worst[begin / 16], std::abs(t.error));
        }
      }
    });
    for (const float w : worst) tin.max_error = std::max(tin.max_error, static_cast<double>(w));
    return tin;
  }

  const Raster& raster_;
  const RefineOptions& options_;
  const Context& context_;
  std::vector<Cell> hull_;
  Mesh mesh_;
  std::vector<double> reciprocals_;
  ScanField<Height> field_;
  Scan<Height> scan_ = choose_scan<Height>();
  bool exact_ = false;
  int first_bucket_ = 0;
  std::size_t vertices_ = 0;
  WorkerPool pool_;
};

}  // namespace

GridTin refine_grid_in_tiles(const Raster& raster, const RefineOptions& options, const Context& context) {
  try {
    return std::visit([&](const auto& heights) { return Refinement(raster, heights, options, context).run(); },
                      raster.heights);
  } catch (const Overshoot&) {
    return refine_grid_by_heap(raster, options, context);
  }
}

}  // namespace retalho
