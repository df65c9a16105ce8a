#include "retalho/tetraquad/tight_box.h"

#include <algorithm>
#include <cmath>

namespace retalho {
namespace {

constexpr double kTiny = 1e-12;  // of ordinates: what rounding may have done to them
/// A piece whose planes are nearer than this times the tetrahedron's size is not bisected further.
constexpr double kThin = 0.02;

using Piece = std::array<TetBarycentric, 4>;  // its corners

void extend(TightBox& box, Vec3 q) {
  box.low = {std::min(box.low.x, q.x), std::min(box.low.y, q.y), std::min(box.low.z, q.z)};
  box.high = {std::max(box.high.x, q.x), std::max(box.high.y, q.y), std::max(box.high.z, q.z)};
}

class Filler {
 public:
  Filler(const TetCubic& c, const std::array<Vec3, 4>& x) : c_(c), x_(x) {
    for (const Vec3& q : x) size2_ = std::max(size2_, norm2(q - x[0]));
  }

  /// Extends the box by the piece's zeros.
  void fill(const Piece& piece, int halvings, TightBox& box) const {
    const TetCubic o = ordinates_of(piece);
    const auto [least, most] = bounds(o);
    if (least > kTiny || most < -kTiny) return;
    const std::array<Vec3, 4> p = corners_of(piece);
    const auto is_inside = [&box](const Vec3& q) {
      return q.x >= box.low.x && q.x <= box.high.x && q.y >= box.low.y && q.y <= box.high.y && q.z >= box.low.z &&
             q.z <= box.high.z;
    };
    if (std::all_of(p.begin(), p.end(), is_inside) || clip(o, p, halvings == 0, box)) return;
    for (const Piece& half : halves(piece, p)) fill(half, halvings - 1, box);
  }

 private:
  TetCubic ordinates_of(const Piece& corners) const {
    TetCubic o;
    std::size_t n = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const TetQuadratic q = contract(c_, corners[i]);
      for (std::size_t j = i; j < 4; ++j) {
        const TetLinear l = contract(q, corners[j]);
        for (std::size_t k = j; k < 4; ++k) o[n++] = contract(l, corners[k]);
      }
    }
    return o;
  }

  std::array<Vec3, 4> corners_of(const Piece& piece) const {
    std::array<Vec3, 4> p;
    for (std::size_t i = 0; i < 4; ++i)
      p[i] = piece[i][0] * x_[0] + piece[i][1] * x_[1] + piece[i][2] * x_[2] + piece[i][3] * x_[3];
    return p;
  }

  static std::array<Piece, 2> halves(const Piece& piece, const std::array<Vec3, 4>& p) {
    std::size_t a = 0, b = 1;
    double longest = -1;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j)
        if (const double length = norm2(p[i] - p[j]); length > longest * 1.0001) {
          longest = length;
          a = i;
          b = j;
        }
    std::array<Piece, 2> both = {piece, piece};
    for (std::size_t k = 0; k < 4; ++k) both[0][a][k] = both[1][b][k] = 0.5 * (piece[a][k] + piece[b][k]);
    return both;
  }

  /// Takes the part of the piece between the two planes into the box; false, and nothing done, where they are far apart
  /// and it need not (`must`).
  bool clip(const TetCubic& o, const std::array<Vec3, 4>& p, bool must, TightBox& box) const {
    const std::array<double, 4> f = {o[0], o[10], o[16], o[19]};  // at the corners
    double over = 0, under = 0;
    for (std::size_t n = 0; n < 20; ++n) {
      const auto [i, j, k] = kTet.cubic[n];
      const double more =
          o[n] - (f[static_cast<std::size_t>(i)] + f[static_cast<std::size_t>(j)] + f[static_cast<std::size_t>(k)]) / 3;
      over = std::max(over, more);
      under = std::min(under, more);
    }
    const double low = -over - kTiny, high = -under + kTiny;
    if (!must) {
      double steepest = 0;
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j) {
          const double rise = f[i] - f[j];
          steepest = std::max(steepest, rise * rise / norm2(p[i] - p[j]));
        }
      if ((high - low) * (high - low) > kThin * kThin * size2_ * steepest) return false;
    }
    for (std::size_t i = 0; i < 4; ++i) {
      if (f[i] >= low && f[i] <= high) extend(box, p[i]);
      for (std::size_t j = i + 1; j < 4; ++j)
        for (const double level : {low, high})
          if ((f[i] < level) != (f[j] < level)) {
            const double s = std::clamp((level - f[i]) / (f[j] - f[i]), 0.0, 1.0);
            extend(box, (1 - s) * p[i] + s * p[j]);
          }
    }
    return true;
  }

  const TetCubic& c_;
  const std::array<Vec3, 4>& x_;
  double size2_ = 0;  // of the tetrahedron, squared
};

}  // namespace

std::optional<TightBox> tight_box(const TetCubic& c, const std::array<Vec3, 4>& x, int halvings) {
  TightBox box{{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
  if (halvings == 0) {
    const auto [least, most] = bounds(c);
    if (least > kTiny || most < -kTiny) return {};
    for (const Vec3& q : x) extend(box, q);
  } else {
    Filler(c, x).fill({{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}, halvings, box);
  }
  if (box.low.x > box.high.x) return {};
  return box;
}

}  // namespace retalho
