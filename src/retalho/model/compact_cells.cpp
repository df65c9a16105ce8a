#include "retalho/model/compact_cells.h"

#include <algorithm>
#include <cstdint>

namespace retalho {
namespace {

using greedy::Cell;

/// The rows coded so far, as deep as the widest window, and what can be counted in them.
class Window {
 public:
  static constexpr int kDeep = 24, kPad = 40;

  explicit Window(int columns)
      : columns_(columns),
        rows_(kDeep + 1, std::vector<std::uint8_t>(width(), 0)),
        sums_(kDeep + 1, std::vector<std::uint32_t>(width() + 1, 0)),
        current_(width() + 1, 0),
        last_seen_(width(), 1 << 20) {}

  void begin_row() {
    std::fill(current_.begin(), current_.end(), 0);
    std::fill(rows_.front().begin(), rows_.front().end(), std::uint8_t{0});
  }
  void set(int x, bool bit) {
    const std::size_t k = place(x);
    rows_.front()[k] = bit ? 1 : 0;
    current_[k + 1] = current_[k] + (bit ? 1U : 0U);
  }
  /// The row is complete: it becomes the one above.
  void end_row() {
    for (std::size_t k = place(columns_); k <= width() - 1; ++k) current_[k + 1] = current_[k];
    std::rotate(rows_.begin(), rows_.end() - 1, rows_.end());
    std::rotate(sums_.begin(), sums_.end() - 1, sums_.end());
    for (std::size_t k = 0; k < current_.size(); ++k) sums_[0][k] = sums_[1][k] + current_[k];
    for (std::size_t k = 0; k < width(); ++k) last_seen_[k] = rows_[1][k] != 0 ? 1 : last_seen_[k] + 1;
  }

  bool at(int dx, int dy, int x) const { return rows_[static_cast<std::size_t>(-dy)][place(x + dx)] != 0; }
  /// Vertices within columns x + from to x + to of the `deep` rows above; all of |from|, |to| < kPad, deep <= kDeep.
  int above(int x, int from, int to, int deep) const {
    const std::size_t a = place(x + from), b = place(x + to) + 1;
    const auto& until = sums_[static_cast<std::size_t>(deep)];
    return static_cast<int>(sums_[0][b] - sums_[0][a] - until[b] + until[a]);
  }
  int before(int x, int reach) const {
    const std::size_t k = place(x);
    return static_cast<int>(current_[k] - current_[k - static_cast<std::size_t>(reach)]);
  }
  /// Squared distance to the nearest vertex within 7 columns and rows; 200: none.
  int nearest(int x, int last) const {
    int best = x - last <= 7 ? (x - last) * (x - last) : 200;
    for (int dx = -7; dx <= 7; ++dx) {
      const int up = last_seen_[place(x + dx)];
      if (up <= 7) best = std::min(best, up * up + dx * dx);
    }
    return best;
  }

 private:
  std::size_t width() const { return static_cast<std::size_t>(columns_) + 2 * kPad; }
  std::size_t place(int x) const { return static_cast<std::size_t>(x + kPad); }

  int columns_;
  std::vector<std::vector<std::uint8_t>> rows_;  // [0]: the row in work
  // [d]: vertices in all rows over the one d rows above, it included, left of each column. Differences count.
  std::vector<std::vector<std::uint32_t>> sums_;
  std::vector<std::uint32_t> current_;
  std::vector<int> last_seen_;  // rows up to the nearest vertex of the column
};

int distance_class(int squared) {
  static constexpr int kSteps[] = {1, 2, 4, 5, 8, 9, 10, 13, 17, 20, 25, 29, 34, 41, 50, 64};
  int k = 0;
  while (k < 16 && squared > kSteps[k]) ++k;
  return k;
}
/// Counts up to 5 as they are, above in thirds of an octave.
int count_class(int n) {
  return n < 6 ? n : std::min(19, 6 + log2_class(n / 6.0, 3));
}

struct VertexModel {
  static constexpr double kRate = 0.004;
  std::vector<AdaptiveBit> near, middle, wide, pattern, widest, mixed;
  std::vector<Mixer> mixers;

  explicit VertexModel(double share)
      : near(4 * 8 * 16 * 3, {share}),
        middle(20 * 10 * 3, {share}),
        wide(20 * 17 * 3, {share}),
        pattern(1 << 12, {share}),
        widest(20 * 20 * 3, {share}),
        mixed(17 * 8 * 20, {share}),
        mixers(17 * 3, Mixer(6, 0.12, kRate)) {
    for (Mixer& m : mixers) m.weight[7] = 0.4;
  }

  bool code(BitCoder& coder, bool bit, const Window& w, int x, int last, int border, double prior) {
    constexpr int kMemory = 1000;
    const int n2 = w.above(x, -2, 2, 2) + w.before(x, 2), n3 = w.above(x, -3, 3, 3) + w.before(x, 3),
              n4 = w.above(x, -4, 4, 4) + w.before(x, 4), n6 = w.above(x, -6, 6, 6) + w.before(x, 6),
              n8 = w.above(x, -8, 8, 8) + w.before(x, 8), n16 = w.above(x, -16, 16, 16) + w.before(x, 16),
              n32 = w.above(x, -32, 32, 24) + w.before(x, 32), right = w.above(x, 1, 6, 5);
    static constexpr int kPattern[12][2] = {{-1, 0}, {-2, 0},  {0, -1}, {1, -1},  {-1, -1}, {0, -2},
                                            {2, -1}, {-2, -1}, {1, -2}, {-1, -2}, {-3, 0},  {0, -3}};
    std::size_t shape = 0;
    for (std::size_t k = 0; k < 12; ++k) shape |= std::size_t{w.at(kPattern[k][0], kPattern[k][1], x)} << k;
    const int d = distance_class(w.nearest(x, last));
    const auto at = [](std::vector<AdaptiveBit>& bits, int k) { return &bits[static_cast<std::size_t>(k)]; };
    return code_mixed<6>(coder, bit,
                         {at(near, ((std::min(n2, 3) * 8 + std::min(n3, 7)) * 16 + std::min(n6, 15)) * 3 + border),
                          at(middle, (count_class(n8) * 10 + std::min(n4, 9)) * 3 + border),
                          at(wide, (count_class(n16) * 17 + d) * 3 + border), &pattern[shape],
                          at(widest, (count_class(n32) * 20 + count_class(n8)) * 3 + border),
                          at(mixed, (d * 8 + std::min(right, 7)) * 20 + count_class(n16))},
                         mixers[static_cast<std::size_t>(d * 3 + border)], kMemory, prior);
  }
};

}  // namespace

std::vector<Cell> code_vertices(BitCoder& coder, int columns, int rows, std::size_t count,
                                const std::vector<Cell>& cells) {
  const double total = static_cast<double>(columns) * rows;
  VertexModel model(std::clamp(static_cast<double>(count) / total, 1.0 / 4096, 4095.0 / 4096));
  Window window(columns);
  std::vector<Cell> found;
  double left = total;
  for (int y = 0; y < rows; ++y) {
    window.begin_row();
    int last = -100;
    for (int x = 0; x < columns; ++x, left -= 1) {
      const auto wanted = static_cast<double>(count - found.size());
      bool bit = wanted > 0;
      if (bit && wanted < left) {  // else it is certain
        const int border = x == 0 || x == columns - 1 ? 1 : y == 0 || y == rows - 1 ? 2 : 0;
        const bool is = coder.writing() && cells[found.size()] == greedy::cell_at(x, y);
        bit = model.code(coder, is, window, x, last, border, wanted / left);
      }
      window.set(x, bit);
      if (!bit) continue;
      found.push_back(greedy::cell_at(x, y));
      last = x;
    }
    window.end_row();
  }
  return found;
}

std::vector<std::uint8_t> code_folds(BitCoder& coder, const CellTriangulation& finest,
                                     const std::vector<std::uint8_t>& folded) {
  const std::size_t count = finest.vertex.size();
  std::vector<double> twice(count, 0.0);  // the triangles of each, by the mesh's numbers
  double total = 0;
  for (const auto& t : finest.mesh.triangles()) {
    const auto at = [&](std::size_t k) { return finest.mesh.cell(t[k]); };
    const auto area = static_cast<double>(greedy::area2(at(0), at(2), at(1)));
    for (const std::uint32_t v : t) twice[v] += area;
    total += 3 * area;
  }
  const double mean = total / static_cast<double>(count);
  std::vector<AdaptiveBit> near(4 * 4 * 8, {0.1}), crowd(8 * 4, {0.1}), share(64, {0.1});
  std::vector<Mixer> mixers(16, Mixer(3, 0.4, 0.01));
  std::vector<std::uint8_t> result(count, 0);
  CellMesh::Star star;
  for (std::uint32_t v = 0; v < count; ++v) {
    const std::uint32_t k = finest.number[v];
    finest.mesh.star(k, star);
    std::size_t folds = 0, known = 0;
    for (const std::uint32_t n : star.ring) {
      const std::uint32_t w = finest.vertex[n];
      if (w >= v) continue;
      ++known;
      folds += result[w];
    }
    const auto size = static_cast<std::size_t>(std::clamp(4 + log2_class(twice[k] / mean, 1), 0, 7));
    const std::size_t f = std::min<std::size_t>(folds, 3), s = std::min<std::size_t>(known - folds, 3);
    const bool bit =
        code_mixed<3>(coder, coder.writing() && folded[v] != 0,
                      {&near[(f * 4 + s) * 8 + size], &crowd[size * 4 + f],
                       &share[std::min<std::size_t>(folds, 7) * 8 + std::min<std::size_t>(known - folds, 7)]},
                      mixers[f * 4 + s], 255);
    result[v] = bit ? 1 : 0;
  }
  return result;
}

Mask code_mask(BitCoder& coder, int columns, int rows, const Mask& mask) {
  Mask result(columns, rows, false);
  std::vector<AdaptiveBit> bits(1 << 10);
  Mixer alone(1, 1, 0);
  const auto at = [&](int x, int y) {
    return x >= 0 && x < columns && y >= 0 && result.get(x, y) ? std::size_t{1} : std::size_t{0};
  };
  static constexpr int kBefore[10][2] = {{-1, 0}, {-2, 0}, {-3, 0},  {-1, -1}, {0, -1},
                                         {1, -1}, {2, -1}, {-2, -1}, {0, -2},  {1, -2}};
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      std::size_t shape = 0;
      for (std::size_t k = 0; k < 10; ++k) shape |= at(x + kBefore[k][0], y + kBefore[k][1]) << k;
      const bool bit = code_mixed<1>(coder, coder.writing() && mask.get(x, y), {&bits[shape]}, alone, 255);
      if (bit) result.set(x, y, true);
    }
  return result;
}

}  // namespace retalho
