// The parts of the compact form, each by itself: what is written is what is read, and the predictions are the surfaces
// that they are said to be.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "retalho/core/error.h"
#include "retalho/model/bit_coder.h"
#include "retalho/model/byte_stream.h"
#include "retalho/model/compact_cells.h"
#include "retalho/model/compact_levels.h"
#include "retalho/model/thin_plate.h"
#include "retalho/terrain/evaluate.h"
#include "retalho/terrain/fit.h"
#include "support/support.h"

namespace retalho {
namespace {

using greedy::Cell;
using greedy::cell_at;

TEST(CompactParts, LogarithmAndExponentialAreTrueToNineDigits) {
  test::Random random;
  for (int k = 0; k < 20000; ++k) {
    const double x = std::exp(random.uniform(-200, 200));
    ASSERT_NEAR(portable_log(x), std::log(x), 1e-9 * std::max(1.0, std::abs(std::log(x))));
    const double y = random.uniform(-40, 40);
    ASSERT_NEAR(portable_exp(y) / std::exp(y), 1, 1e-9);
    ASSERT_NEAR(log2_class(x, 2), 2 * std::log2(x), 0.5 + 1e-9 + std::max(0.0, 2 * std::abs(std::log2(x)) - 120));
  }
  EXPECT_EQ(log2_class(std::nan(""), 2), -120);
}

RC_GTEST_PROP(CompactPartsProperty, BitsComeBack, (const std::vector<std::pair<bool, std::uint16_t>>& bits)) {
  BitCoder writer;
  for (const auto& [bit, p] : bits) writer.code(bit, std::clamp<std::uint32_t>(p, 1, 65535));
  const std::string bytes = writer.finish();
  BitCoder reader(bytes);
  for (const auto& [bit, p] : bits) RC_ASSERT(reader.code(false, std::clamp<std::uint32_t>(p, 1, 65535)) == bit);
}

TEST(CompactParts, UnlikelyBitsCarryThroughEveryByteWritten) {
  test::Random random;
  for (int round = 0; round < 200; ++round) {
    std::vector<std::pair<bool, std::uint32_t>> bits;
    for (int k = 0; k < 400; ++k) {
      const std::uint32_t one = random.index(2) != 0 ? 65535 : 1;
      bits.emplace_back(random.index(5) == 0 ? one == 1 : one != 1, one);
    }
    BitCoder writer;
    for (const auto& [bit, one] : bits) writer.code(bit, one);
    const std::string bytes = writer.finish();
    BitCoder reader(bytes);
    for (const auto& [bit, one] : bits) ASSERT_EQ(reader.code(false, one), bit);
  }
}

RC_GTEST_PROP(CompactPartsProperty, WholeNumbersComeBack, ()) {
  struct Number {
    int value, size, place, kin, sign;
  };
  std::vector<Number> numbers;
  const int count = *rc::gen::inRange(1, 200);
  for (int k = 0; k < count; ++k) {
    const int bits = *rc::gen::inRange(0, 29);
    numbers.push_back({*rc::gen::inRange(-(1 << bits), (1 << bits) + 1), *rc::gen::inRange(-3, 40),
                       *rc::gen::inRange(-2, 70), *rc::gen::inRange(-2, 70), *rc::gen::inRange(0, 4)});
  }
  BitCoder writer;
  IntegerCoder in;
  for (const Number& n : numbers) in.code(writer, n.value, n.size, n.place, n.kin, n.sign);
  const std::string bytes = writer.finish();
  BitCoder reader(bytes);
  IntegerCoder out;
  for (const Number& n : numbers) RC_ASSERT(out.code(reader, 0, n.size, n.place, n.kin, n.sign) == n.value);
}

TEST(CompactParts, RealsAreKeptToTheBitByFewBytes) {
  test::Random random;
  std::vector<double> values{0, 1, -1, 30, 0.1, 1e300, -1e-300, 5e-324, 1.7976931348623157e308, 0.0002777777777777778};
  for (int k = 0; k < 5000; ++k)
    values.push_back(std::ldexp(random.uniform(-1, 1), static_cast<int>(random.index(2000)) - 1000));
  ByteWriter out;
  for (const double v : values) out.real(v);
  ByteReader in(out.bytes());
  for (const double v : values) ASSERT_EQ(in.real("number"), v);
  EXPECT_TRUE(in.rest().empty());
  ByteWriter thirty;
  thirty.real(30);
  EXPECT_EQ(thirty.bytes().size(), 2U);
  for (std::size_t size = 0; size < 2; ++size) {
    ByteReader cut(std::string_view(thirty.bytes()).substr(0, size));
    EXPECT_THROW(cut.real("number"), CannotRead);
  }
}

std::vector<Cell> random_cells(int columns, int rows, int count) {
  std::set<Cell> cells;
  for (int k = 0; k < count; ++k) cells.insert(cell_at(*rc::gen::inRange(0, columns), *rc::gen::inRange(0, rows)));
  return {cells.begin(), cells.end()};
}

RC_GTEST_PROP(CompactPartsProperty, SetsOfCellsComeBack, ()) {
  const int columns = *rc::gen::inRange(2, 90), rows = *rc::gen::inRange(2, 60);
  const std::vector<Cell> cells = random_cells(columns, rows, *rc::gen::inRange(0, columns * rows));
  Mask mask(columns, rows, false);
  for (const Cell c : cells) mask.set(greedy::column_of(c), greedy::row_of(c), true);
  BitCoder writer;
  code_vertices(writer, columns, rows, cells.size(), cells);
  code_mask(writer, columns, rows, mask);
  const std::string bytes = writer.finish();
  BitCoder reader(bytes);
  RC_ASSERT(code_vertices(reader, columns, rows, cells.size(), {}) == cells);
  RC_ASSERT(code_mask(reader, columns, rows, {}) == mask);
}

bool on_one_line(const std::vector<Cell>& cells) {
  return std::all_of(cells.begin(), cells.end(),
                     [&](Cell c) { return greedy::area2(cells.front(), cells.back(), c) == 0; });
}

using Triangles = std::set<std::set<Cell>>;
Triangles triangles_of(const CellMesh& mesh) {
  Triangles result;
  for (const auto& t : mesh.triangles()) result.insert({mesh.cell(t[0]), mesh.cell(t[1]), mesh.cell(t[2])});
  return result;
}

RC_GTEST_PROP(CompactPartsProperty, LevelsHaveKnownNeighboursAndHoldAll, ()) {
  const std::vector<Cell> cells =
      random_cells(*rc::gen::inRange(3, 30), *rc::gen::inRange(3, 30), *rc::gen::inRange(4, 150));
  RC_PRE(cells.size() >= 3 && !on_one_line(cells));
  const std::vector<CellLevel> levels = make_levels(cells);
  std::set<std::uint32_t> known;
  for (std::size_t l = 0; l < levels.size(); ++l) {
    const CellLevel& level = levels[l];
    for (const std::uint32_t v : level.fresh) {
      CellMesh::Star star;
      level.mesh.star(level.number[v], star);
      for (const std::uint32_t w : star.ring) RC_ASSERT(l == 0 || known.contains(level.vertex[w]));
    }
    for (const std::uint32_t v : level.fresh) RC_ASSERT(known.insert(v).second);
    RC_ASSERT(known.size() == level.mesh.vertex_count());
  }
  RC_ASSERT(known.size() == cells.size());
}

RC_GTEST_PROP(CompactPartsProperty, TheTriangulationDependsOnTheSetAlone, ()) {
  // Few places: most sets have four vertices on a circle.
  std::vector<Cell> cells = random_cells(7, 7, *rc::gen::inRange(4, 40));
  const std::vector<Cell> box{cell_at(0, 0), cell_at(6, 0), cell_at(6, 6), cell_at(0, 6)};
  cells.insert(cells.end(), box.begin(), box.end());
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  const Triangles expected = triangles_of(triangulate_cells(cells).mesh);
  std::vector<Cell> order = cells;
  for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[*rc::gen::inRange<std::size_t>(0, k)]);
  CellMesh mesh(box);
  std::vector<Cell> passing;  // inserted, and removed again
  for (const Cell c : order) {
    mesh.insert(c, 0);
    const Cell other = cell_at(*rc::gen::inRange(0, 7), *rc::gen::inRange(0, 7));
    if (!std::binary_search(cells.begin(), cells.end(), other) && mesh.insert(other, 0) != kNone)
      passing.push_back(other);
  }
  for (const Cell c : passing) {
    const auto& all = mesh.cells();
    RC_ASSERT(mesh.remove(static_cast<std::uint32_t>(std::find(all.begin(), all.end(), c) - all.begin())));
  }
  RC_ASSERT(triangles_of(mesh) == expected);
}

Tin random_tin(test::Random& random) {
  std::set<Cell> set{cell_at(0, 0), cell_at(40, 0), cell_at(40, 30), cell_at(0, 30)};
  for (int k = 0; k < 60; ++k)
    set.insert(cell_at(static_cast<int>(random.index(41)), static_cast<int>(random.index(31))));
  const std::vector<Cell> cells(set.begin(), set.end());
  const CellTriangulation t = triangulate_cells(cells);
  Tin tin;
  for (std::uint32_t v = 0; v < t.mesh.vertex_count(); ++v) {
    tin.points.push_back(t.mesh.at(v));
    tin.heights.push_back(random.uniform(-50, 50));
  }
  tin.triangles = t.mesh.triangles();
  build_neighbors(tin);
  return tin;
}

TEST(CompactParts, PredictionsAreTheCloughTocherSurfaceOfTheFacetsNormals) {
  test::Random random;
  for (int round = 0; round < 20; ++round) {
    const Tin tin = random_tin(random);
    const Terrain terrain = make_terrain(tin, Georef{}, {.surface = SurfaceKind::clough_tocher});
    std::vector<VertexJet> data;
    for (const double z : tin.heights) data.push_back({z, 0, 0});
    facet_gradients(tin.points, tin.triangles, {}, data);
    for (std::size_t v = 0; v < data.size(); ++v) {
      ASSERT_NEAR(data[v][1], terrain.gradients[v].x, 1e-9);
      ASSERT_NEAR(data[v][2], terrain.gradients[v].y, 1e-9);
    }
    const TerrainEvaluator evaluator(terrain);
    for (int k = 0; k < 200; ++k) {
      const Vec2 p{random.uniform(0, 40), random.uniform(-30, 0)};
      const auto& t = tin.triangles[evaluator.locate(p)];
      const double z = clough_tocher_height({tin.points[t[0]], tin.points[t[1]], tin.points[t[2]]},
                                            {data[t[0]], data[t[1]], data[t[2]]}, p);
      ASSERT_NEAR(z, evaluator.value(p), 1e-8);
    }
  }
}

/// The bending of a surface by its second derivatives at many points.
double bending_of(const Terrain& terrain) {
  const TerrainEvaluator evaluator(terrain);
  double sum = 0;
  constexpr double kStep = 0.1;
  for (double x = kStep / 2; x < 40; x += kStep)
    for (double y = -30 + kStep / 2; y < 0; y += kStep) {
      const Jet jet = *evaluator.jet({x + 1e-4, y + 1e-4});
      sum += (jet.xx * jet.xx + 2 * jet.xy * jet.xy + jet.yy * jet.yy) * kStep * kStep;
    }
  return sum;
}

TEST(CompactParts, RelaxedGradientsBendLeastAndReproducePlanes) {
  test::Random random;
  Tin tin = random_tin(random);
  for (const bool plane : {true, false}) {
    if (plane)
      for (std::size_t v = 0; v < tin.points.size(); ++v)
        tin.heights[v] = 3 + 0.5 * tin.points[v].x - 0.25 * tin.points[v].y;
    else
      for (double& z : tin.heights) z = random.uniform(-5, 5);
    std::vector<VertexJet> data;
    for (const double z : tin.heights) data.push_back({z, 0.01, -0.02});
    std::vector<std::uint8_t> held(data.size(), 0);
    if (!plane) held[5] = 1;
    Bending(tin.points, tin.triangles).relax(data, held);
    const auto surface = [&] {
      std::vector<Vec2> gradients;
      gradients.reserve(data.size());
      for (const VertexJet& u : data) gradients.push_back({u[1], u[2]});
      return make_terrain(tin, Georef{}, {.gradients = GradientKind::given, .given = gradients});
    };
    if (plane) {
      for (const VertexJet& u : data) {
        EXPECT_NEAR(u[1], 0.5, 5e-3);  // the residual falls by 1e-5: what is left is enough to predict with
        EXPECT_NEAR(u[2], -0.25, 5e-3);
      }
      continue;
    }
    EXPECT_EQ(data[5][1], 0.01);
    EXPECT_EQ(data[5][2], -0.02);
    const double least = bending_of(surface());
    for (int k = 0; k < 12; ++k) {  // any other gradients bend more
      const std::vector<VertexJet> best = data;
      const std::size_t v = random.index(data.size());
      if (held[v] != 0) continue;
      data[v][1] += random.uniform(0.5, 1);
      data[v][2] -= random.uniform(0.5, 1);
      EXPECT_GT(bending_of(surface()), least);
      data = best;
    }
  }
}

}  // namespace
}  // namespace retalho
