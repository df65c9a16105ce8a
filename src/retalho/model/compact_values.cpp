#include "retalho/model/compact_values.h"

#include <algorithm>
#include <cmath>

#include "retalho/core/error.h"

namespace retalho {
namespace {

constexpr int kLargest = 1 << 29;  // steps

/// 2^(k / 8) by products of exactly rounded numbers.
double eighth_octaves(int k) {
  static constexpr double kRoot[8] = {1,
                                      1.0905077326652577,
                                      1.189207115002721,
                                      1.2968395546510096,
                                      1.4142135623730951,
                                      1.5422108254079407,
                                      1.681792830507429,
                                      1.8340080864093424};
  const int whole = k >= 0 ? k / 8 : -((7 - k) / 8);
  return std::ldexp(kRoot[k - 8 * whole], whole);
}

int whole(double steps) {
  if (!(std::abs(steps) <= kLargest))
    throw BadInput("this terrain has no compact form: a number lies more than 2^29 steps from where it is expected");
  return static_cast<int>(steps);
}

/// The mean of what has been seen lately.
class Lately {
 public:
  void add(double value) {
    sum_ += value;
    if (++count_ <= 400) return;
    sum_ /= 2;
    count_ /= 2;
  }
  double mean(double otherwise) const { return count_ > 0 ? sum_ / count_ : otherwise; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

/// How many cells each vertex stands for: a third of its triangles; half a cell at least.
std::vector<double> stars_of(const CellTriangulation& finest) {
  std::vector<double> star(finest.vertex.size(), 0.0);
  for (const auto& t : finest.mesh.triangles()) {
    const auto at = [&](std::size_t k) { return finest.mesh.cell(t[k]); };
    const auto twice = static_cast<double>(greedy::area2(at(0), at(2), at(1)));
    for (const std::uint32_t v : t) star[finest.vertex[v]] += twice / 6;
  }
  for (double& s : star) s = std::max(s, 0.5);
  return star;
}

class Values {
 public:
  Values(BitCoder& coder, const CompactFrame& frame, const CompactSteps& steps, ValueSource* source)
      : coder_(coder),
        frame_(frame),
        steps_(steps),
        source_(source),
        count_(frame.cells.size()),
        data_(count_, VertexJet{0, 0, 0}),
        known_(count_, 0),
        roughness_(count_, 0.0) {
    for (const greedy::Cell c : frame.cells)
      points_.push_back({greedy::column_of(c) * frame.step.x, -greedy::row_of(c) * frame.step.y});
    star_ = stars_of(frame.levels.back());
    for (const double star : star_) total_ += star;
    LatticeSteps lattice = lattice_steps(frame.levels.back(), steps);
    height_step_ = std::move(lattice.height);
    slope_step_ = std::move(lattice.slope);
  }

  void heights(const Context& context) {
    coarsest();
    for (std::size_t l = 1; l < frame_.levels.size(); ++l) {
      context.check();
      level(l);
    }
  }

  void gradients(const Context& context);

  std::vector<VertexJet> take() { return std::move(data_); }

 private:
  /// A number's place on its lattice of whole steps: which step its prediction is next to, on which side of it the
  /// prediction lies, and how far (0 to 3).
  struct Guess {
    double base;
    bool below;
    int shade;

    Guess(double prediction, double step) {
      const double at = prediction / step;
      base = std::floor(at + 0.5);
      below = at < base;
      shade = std::clamp(static_cast<int>(std::abs(at - base) * 8), 0, 3);
    }
    /// Steps from the base to the target, counted towards the prediction's side.
    int towards(double target, double step) const {
      return whole(below ? base - std::floor(target / step + 0.5) : std::floor(target / step + 0.5) - base);
    }
    double value(int q, double step) const { return (base + (below ? -q : q)) * step; }
  };

  /// The smallest number on the way from 0 to `q` that will do.
  template <class Accepts>
  static int nearer(int q, const Accepts& accepts) {
    constexpr int kTries = 6;
    for (int k = 0; k < std::min(std::abs(q), kTries); ++k)
      if (accepts(q < 0 ? -k : k)) return q < 0 ? -k : k;
    return q;
  }

  void coarsest() {
    if (source_) source_->settle();
    for (const std::uint32_t v : frame_.levels.front().fresh) {
      const int q = source_ ? whole(std::floor((source_->height(v) - frame_.reference) / height_step_[v] + 0.5)) : 0;
      const std::uint32_t size = coder_.code_gamma(static_cast<std::uint32_t>(std::abs(q)) + 1) - 1;
      const bool negative = size != 0 && coder_.code_even(q < 0);
      const double magnitude = size * height_step_[v];
      settle_height(v, frame_.reference + (negative ? -magnitude : magnitude));
    }
  }

  void settle_height(std::uint32_t v, double height) {
    data_[v][0] = height;
    known_[v] = 1;
    if (source_) source_->coded_height(v, height);
  }

  /// The surface over a level, with the gradients of its facets.
  std::vector<VertexJet> surface_of(const CellLevel& level) const {
    std::vector<VertexJet> data;
    std::vector<Vec2> points;
    for (const std::uint32_t v : level.vertex) {
      data.push_back(data_[v]);
      points.push_back(points_[v]);
    }
    facet_gradients(points, level.mesh.triangles(), folds_of(level), data);
    return data;
  }

  /// Which of a level's vertices are folded, by its numbers.
  std::vector<std::uint8_t> folds_of(const CellLevel& level) const {
    std::vector<std::uint8_t> folds;
    if (!frame_.folded.empty())
      for (const std::uint32_t v : level.vertex) folds.push_back(frame_.folded[v]);
    return folds;
  }

  void level(std::size_t l) {
    const CellLevel &here = frame_.levels[l], &coarse = frame_.levels[l - 1];
    const std::vector<VertexJet> surface = surface_of(coarse);
    if (source_) source_->settle();
    const int age = static_cast<int>(std::min<std::size_t>(5, frame_.levels.size() - 1 - l));
    const double mean_side = std::sqrt(total_ / static_cast<double>(count_));
    CellMesh::Star star;
    std::uint32_t near = 0;
    for (const std::uint32_t v : here.fresh) {
      near = coarse.mesh.locate(frame_.cells[v], near);
      const auto& t = coarse.mesh.triangles()[near];
      const auto place = [&](std::size_t k) { return points_[coarse.vertex[t[k]]]; };
      std::array<VertexJet, 3> jets{surface[t[0]], surface[t[1]], surface[t[2]]};
      fold_jets({place(0), place(1), place(2)}, folded_at(coarse, t), jets);
      const double prediction = clough_tocher_height({place(0), place(1), place(2)}, jets, points_[v]);
      here.mesh.star(here.number[v], star);
      double sides = 0, rough = 0;
      int rough_count = 0;
      for (const std::uint32_t k : star.ring) {
        const std::uint32_t w = here.vertex[k];
        const double dx = points_[v].x - points_[w].x, dy = points_[v].y - points_[w].y;
        sides += std::sqrt(dx * dx + dy * dy);
        if (roughness_[w] > 0) {
          rough += roughness_[w];
          ++rough_count;
        }
      }
      const double side = sides / static_cast<double>(star.ring.size()), step = height_step_[v];
      rough = (rough + lately_.mean(steps_.height / 4)) / (rough_count + 1);
      const int size = 8 + log2_class(rough * side / step, 2);
      const int length = std::clamp(4 + log2_class(side / mean_side, 2), 0, 9);
      const Guess guess(prediction - frame_.reference, step);
      int q = source_ ? guess.towards(source_->height(v) - frame_.reference, step) : 0;
      q = nearer(q, [&](int k) { return source_->accepts_height(v, frame_.reference + guess.value(k, step)); });
      const int coded =
          heights_.code(coder_, q, size, age * 10 + length, std::clamp(size / 2, 0, 15) * 4 + guess.shade, guess.shade);
      const double height = frame_.reference + guess.value(coded, step);
      roughness_[v] = std::max(std::abs(height - prediction), 0.3 * step) / side;
      lately_.add(roughness_[v]);
      settle_height(v, height);
    }
  }

  std::array<bool, 3> folded_at(const CellLevel& level, const std::array<std::uint32_t, 3>& t) const {
    std::array<bool, 3> result{};
    if (!frame_.folded.empty())
      for (std::size_t k = 0; k < 3; ++k) result[k] = frame_.folded[level.vertex[t[k]]] != 0;
    return result;
  }

  BitCoder& coder_;
  const CompactFrame& frame_;
  const CompactSteps& steps_;
  ValueSource* source_;
  std::size_t count_;
  std::vector<VertexJet> data_;
  std::vector<std::uint8_t> known_;
  std::vector<double> roughness_;  // of each height: how far from its prediction, by distance
  std::vector<Vec2> points_;
  std::vector<double> star_, height_step_, slope_step_;
  double total_ = 0;
  Lately lately_;
  IntegerCoder heights_, slopes_x_, slopes_y_;
};

void Values::gradients(const Context& context) {
  constexpr std::size_t kGroups = 4;
  const CellLevel& finest = frame_.levels.back();
  std::vector<Vec2> points;
  std::vector<VertexJet> data;
  for (const std::uint32_t v : finest.vertex) {
    points.push_back(points_[v]);
    data.push_back(data_[v]);
  }
  const std::vector<std::uint8_t> folds = folds_of(finest);
  facet_gradients(points, finest.mesh.triangles(), folds, data);
  const Bending bending(points, finest.mesh.triangles(), folds);
  std::vector<std::uint8_t> held(count_, 0);
  std::vector<double> missed(count_, 0.0);  // how far each gradient was from its prediction
  Lately ratio;
  const double mean_star = total_ / static_cast<double>(count_);
  const std::size_t levels = frame_.levels.size(), old = levels - std::min(levels, kGroups - 1);
  CellMesh::Star star;
  for (std::size_t group = old == 0 ? 1 : 0; group < kGroups && (group == 0 || old + group - 1 < levels); ++group) {
    context.check();
    std::vector<std::uint32_t> list;
    if (group == 0) {
      for (std::size_t l = 0; l < old; ++l)
        list.insert(list.end(), frame_.levels[l].fresh.begin(), frame_.levels[l].fresh.end());
    } else {
      list = frame_.levels[old + group - 1].fresh;
    }
    bending.relax(data, held);
    if (source_) source_->settle();
    for (const std::uint32_t v : list) {
      if (!frame_.folded.empty() && frame_.folded[v] != 0) continue;
      const std::uint32_t k = finest.number[v];
      finest.mesh.star(k, star);
      double rough = 2 * roughness_[v], weights = 2, near = 0;
      int near_count = 0;
      for (const std::uint32_t n : star.ring) {
        const std::uint32_t w = finest.vertex[n];
        rough += roughness_[w];
        weights += 1;
        if (missed[w] > 0) {
          near += missed[w];
          ++near_count;
        }
      }
      rough /= weights;
      const double step = slope_step_[v], from_heights = rough * ratio.mean(1);
      const double expected = (from_heights * 2 + near) / (2 + near_count) / step;
      const int size = 8 + log2_class(expected, 2), half = std::clamp(size / 2, 0, 15) * 4;
      const int crowd = std::clamp(4 + log2_class(star_[v] / mean_star, 1), 0, 9);
      const Vec2 target = source_ ? source_->gradient(v) : Vec2{};
      const Guess guess_x(data[k][1], step), guess_y(data[k][2], step);
      int wanted_x = 0, wanted_y = 0;
      if (source_) {
        wanted_x = guess_x.towards(target.x, step);
        wanted_y = guess_y.towards(target.y, step);
        const auto jet = [&](int i, int j) { return Vec2{guess_x.value(i, step), guess_y.value(j, step)}; };
        wanted_x = nearer(wanted_x, [&](int i) { return source_->accepts_gradient(v, jet(i, wanted_y)); });
        wanted_y = nearer(wanted_y, [&](int j) { return source_->accepts_gradient(v, jet(wanted_x, j)); });
      }
      const int x =
          slopes_x_.code(coder_, wanted_x, size, static_cast<int>(std::min<std::size_t>(group, 5)) * 10 + crowd,
                         half + guess_x.shade, guess_x.shade);
      const int y = slopes_y_.code(coder_, wanted_y, size, std::min(std::abs(x), 5) * 10 + crowd, half + guess_y.shade,
                                   guess_y.shade);
      const double gx = guess_x.value(x, step), gy = guess_y.value(y, step);
      missed[v] = std::max(0.3 * step, (std::abs(gx - data[k][1]) + std::abs(gy - data[k][2])) / 2);
      data[k][1] = gx;
      data[k][2] = gy;
      ratio.add(missed[v] / std::max(rough, 1e-9));
      held[k] = 1;
      if (source_) source_->coded_gradient(v, {data[k][1], data[k][2]});
    }
  }
  for (std::uint32_t k = 0; k < count_; ++k) data_[finest.vertex[k]] = data[k];
}

}  // namespace

double LatticeSteps::nearest(double value, double step) {
  return std::floor(value / step + 0.5) * step;
}

LatticeSteps lattice_steps(const CellTriangulation& finest, const CompactSteps& steps) {
  LatticeSteps result;
  for (const double star : stars_of(finest)) {
    const int octaves = log2_class(star, 4);       // in quarters: a small change of the star leaves the step as it is
    const int height = -octaves * steps.crowding;  // in quarters of sixteenths
    const double step = steps.height * eighth_octaves(height >= 0 ? (height + 4) / 8 : -((4 - height) / 8));
    result.height.push_back(step);
    result.slope.push_back(steps.slope * 0.25 * step * eighth_octaves(-octaves));
  }
  return result;
}

std::vector<VertexJet> code_values(BitCoder& coder, const CompactFrame& frame, const CompactSteps& steps,
                                   bool gradients, ValueSource* source, const Context& context) {
  Values values(coder, frame, steps, source);
  values.heights(context);
  if (gradients) values.gradients(context);
  return values.take();
}

}  // namespace retalho
