#include "retalho/tetraquad/energy.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "retalho/tetraquad/local_fit.h"

namespace retalho {
namespace {

using Row10 = Eigen::Matrix<double, 1, 10>;

Vec3 to_vec(const LatticePoint& l) {
  return {static_cast<double>(l[0]), static_cast<double>(l[1]), static_cast<double>(l[2])};
}

/// The ten monomials at `d` from the vertex, their gradient along `n`, and their second derivative along n and m.
Row10 monomials(Vec3 d) {
  Row10 r;
  r << 1, d.x, d.y, d.z, d.x * d.x, d.y * d.y, d.z * d.z, d.x * d.y, d.x * d.z, d.y * d.z;
  return r;
}
Row10 slopes(Vec3 d, Vec3 n) {
  Row10 r;
  r << 0, n.x, n.y, n.z, 2 * d.x * n.x, 2 * d.y * n.y, 2 * d.z * n.z, d.x * n.y + d.y * n.x, d.x * n.z + d.z * n.x,
      d.y * n.z + d.z * n.y;
  return r;
}
Row10 curvatures(Vec3 n, Vec3 m) {
  Row10 r;
  r << 0, 0, 0, 0, 2 * n.x * m.x, 2 * n.y * m.y, 2 * n.z * m.z, n.x * m.y + n.y * m.x, n.x * m.z + n.z * m.x,
      n.y * m.z + n.z * m.y;
  return r;
}

constexpr std::array<Vec3, 3> kAxes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

using TetPoints = std::array<Vec3, 4>;

TetFrame frame_of(const TetPoints& x) {
  return {x[0], x[1], x[2], x[3]};
}

/// INT |Hess F|^2 dV as a matrix of the 40 unknowns. The integrand is of degree two: four points are exact.
Eigen::MatrixXd bending_matrix(const TetPoints& x) {
  const TetFrame frame = frame_of(x);
  const double near = 0.5854101966249685, far = 0.1381966011250105;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(40, 40);
  for (std::size_t q = 0; q < 4; ++q) {
    TetBarycentric b = {far, far, far, far};
    b[q] = near;
    const Vec3 p = b[0] * x[0] + b[1] * x[1] + b[2] * x[2] + b[3] * x[3];
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = i; j < 3; ++j) {
        Eigen::Matrix<double, 1, 40> row;
        for (std::size_t k = 0; k < 4; ++k) {
          const Vec3 d = p - x[k], g = frame.gradients[k];
          row.segment<10>(static_cast<Eigen::Index>(10 * k)) = b[k] * curvatures(kAxes[i], kAxes[j]) +
                                                               dot(g, kAxes[i]) * slopes(d, kAxes[j]) +
                                                               dot(g, kAxes[j]) * slopes(d, kAxes[i]);
        }
        sum += (i == j ? 1.0 : 2.0) * std::abs(frame.volume6) / 24 * row.transpose() * row;
      }
  }
  return sum;
}

/// d^m F / dn^m in one tetrahedron, as factors of its 40 unknowns.
Eigen::Matrix<double, 1, 40> normal_derivative(const TetPoints& x, const TetFrame& frame, Vec3 p, Vec3 n, int m) {
  const TetBarycentric b = frame.barycentric(p);
  Eigen::Matrix<double, 1, 40> row;
  for (std::size_t k = 0; k < 4; ++k) {
    const double change = dot(frame.gradients[k], n);
    const Vec3 d = p - x[k];
    Row10 part;
    if (m == 1)
      part = b[k] * slopes(d, n) + change * monomials(d);
    else if (m == 2)
      part = b[k] * curvatures(n, n) + 2 * change * slopes(d, n);
    else
      part = 3 * change * curvatures(n, n);
    row.segment<10>(static_cast<Eigen::Index>(10 * k)) = part;
  }
  return row;
}

/// sum gamma_m INT [d^m F/dn^m]^2 dA over the face x0 x1 x2 between the apexes x3 and x4, a matrix of 50 unknowns. The
/// integrand is of degree four: Dunavant's six points are exact.
Eigen::MatrixXd jump_matrix(const std::array<Vec3, 5>& x, const std::array<double, 3>& gamma) {
  const TetPoints near = {x[0], x[1], x[2], x[3]}, far = {x[0], x[1], x[2], x[4]};
  const TetFrame near_frame = frame_of(near), far_frame = frame_of(far);
  const Vec3 normal2 = cross(x[1] - x[0], x[2] - x[0]);
  const Vec3 n = normalized(normal2);
  const double area = norm(normal2) / 2;
  struct Node {
    double weight, apart, rest;
  };
  constexpr std::array<Node, 2> nodes = {{{0.223381589678011466, 0.108103018168070227, 0.445948490915964886},
                                          {0.109951743655321868, 0.816847572980458513, 0.0915762135097707434}}};
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(50, 50);
  for (const Node& node : nodes)
    for (std::size_t q = 0; q < 3; ++q) {
      Vec3 p{};
      for (std::size_t i = 0; i < 3; ++i) p = p + (i == q ? node.apart : node.rest) * x[i];
      for (int m = 1; m <= 3; ++m) {
        const auto a = normal_derivative(near, near_frame, p, n, m);
        const auto b = normal_derivative(far, far_frame, p, n, m);
        Eigen::Matrix<double, 1, 50> row;
        row.head<30>() = a.head<30>() - b.head<30>();
        row.segment<10>(30) = a.tail<10>();
        row.segment<10>(40) = -b.tail<10>();
        sum += gamma[static_cast<std::size_t>(m - 1)] * node.weight * area * row.transpose() * row;
      }
    }
  return sum;
}

/// Adds a dense symmetric matrix of `vertices`' unknowns.
void scatter(BlockMatrix& matrix, std::span<const std::uint32_t> vertices, const Eigen::MatrixXd& value,
             double factor) {
  for (std::size_t a = 0; a < vertices.size(); ++a)
    for (std::size_t b = a; b < vertices.size(); ++b)
      matrix.add(vertices[a], vertices[b], [&](std::size_t i, std::size_t j) {
        return factor * value(static_cast<Eigen::Index>(10 * a + i), static_cast<Eigen::Index>(10 * b + j));
      });
}

/// Corner places less the first one: what a block depends on.
template <std::size_t Size>
std::array<std::int32_t, 3 * (Size - 1)> shape_of(const TetMesh& mesh,
                                                  const std::array<std::uint32_t, Size>& vertices) {
  std::array<std::int32_t, 3 * (Size - 1)> key;
  for (std::size_t i = 1; i < Size; ++i)
    for (std::size_t d = 0; d < 3; ++d)
      key[3 * (i - 1) + d] = mesh.lattice[vertices[i]][d] - mesh.lattice[vertices[0]][d];
  return key;
}
template <std::size_t Size>
std::array<Vec3, Size> points_of(const TetMesh& mesh, const std::array<std::uint32_t, Size>& vertices) {
  std::array<Vec3, Size> x;
  const Vec3 first = to_vec(mesh.lattice[vertices[0]]);
  for (std::size_t i = 0; i < Size; ++i) x[i] = to_vec(mesh.lattice[vertices[i]]) - first;
  return x;
}

/// The face's corners, then the apex of its own tetrahedron, then the one beyond.
std::array<std::uint32_t, 5> around_face(const HalfFaces& faces, std::size_t half_face) {
  std::array<std::uint32_t, 5> v{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < 4; ++i)
    if (i != half_face % 4) v[n++] = faces.corners(half_face / 4)[i];
  v[3] = faces.vertex(half_face);
  v[4] = faces.vertex(static_cast<std::size_t>(faces.opposite(half_face)));
  return v;
}

BlockMatrix empty_matrix(const TetMesh& mesh, const HalfFaces& faces) {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  pairs.reserve(8 * mesh.tets.size());
  for (const TetCorners& tet : mesh.tets)
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) pairs.push_back({tet[a], tet[b]});
  for (std::size_t f = 0; f < 4 * mesh.tets.size(); ++f)
    if (faces.opposite(f) > static_cast<std::int64_t>(f)) {
      const auto v = around_face(faces, f);
      pairs.push_back({v[3], v[4]});
    }
  return {mesh.lattice.size(), std::move(pairs)};
}

void add_samples(Energy& energy, const TetMesh& mesh, const SampleRuns& samples, const EnergyWeights& weights) {
  const double value_weight = std::sqrt(weights.point), slope_weight = std::sqrt(weights.point * weights.normal);
  Eigen::Matrix<double, 40, Eigen::Dynamic> rows;
  Eigen::VectorXd right;
  // One after the other in pieces, so that a crowded tetrahedron takes no more memory than others.
  constexpr std::size_t most = 256;
  for (std::size_t t = 0, begin = 0; t < samples.tets();) {
    const auto whole = samples.in(t);
    const auto run = whole.subspan(begin, std::min(most, whole.size() - begin));
    const std::size_t now = t;
    begin += run.size();
    if (begin == whole.size()) {
      begin = 0;
      ++t;
    }
    if (run.empty()) continue;
    const TetCorners& tet = mesh.tets[now];
    const TetFrame frame = mesh.frame(now);
    const double size = mesh.size(now), value_scale = value_weight / (size * size), slope_scale = slope_weight / size;
    rows.setZero(40, static_cast<Eigen::Index>(4 * run.size()));
    right.setZero(rows.cols());
    Eigen::Index column = 0;
    for (const std::uint32_t number : run) {
      const Sample sample = samples.samples()[number];
      const TetBarycentric b = frame.barycentric(sample.place);
      const bool has_normal = norm2(sample.normal) > 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec3 d = sample.place - to_vec(mesh.lattice[tet[k]]), g = frame.gradients[k];
        const Row10 value = monomials(d);
        const auto at = static_cast<Eigen::Index>(10 * k);
        rows.block<10, 1>(at, column) = value_scale * b[k] * value.transpose();
        if (!has_normal) continue;
        for (std::size_t axis = 0; axis < 3; ++axis)
          rows.block<10, 1>(at, column + 1 + static_cast<Eigen::Index>(axis)) =
              slope_scale * (b[k] * slopes(d, kAxes[axis]) + dot(g, kAxes[axis]) * value).transpose();
      }
      right[column + 1] = slope_scale * sample.normal.x;
      right[column + 2] = slope_scale * sample.normal.y;
      right[column + 3] = slope_scale * sample.normal.z;
      column += 4;
    }
    Eigen::MatrixXd square = Eigen::MatrixXd::Zero(40, 40);
    square.selfadjointView<Eigen::Lower>().rankUpdate(rows);
    square.triangularView<Eigen::StrictlyUpper>() = square.transpose();
    scatter(energy.matrix, tet, square, 1);
    const Eigen::Matrix<double, 40, 1> share = rows * right;
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t i = 0; i < 10; ++i)
        energy.right[kBlock * tet[k] + i] += share[static_cast<Eigen::Index>(10 * k + i)];
  }
}

void add_guides(Energy& energy, const TetMesh& mesh, std::span<const Guide> guides) {
  for (const Guide& guide : guides) {
    const TetCorners& tet = mesh.tets[guide.tet];
    const TetBarycentric b = mesh.frame(guide.tet).barycentric(guide.place);
    const double scale = std::sqrt(guide.weight) / mesh.size(guide.tet);
    Eigen::Matrix<double, 40, 1> row;
    for (std::size_t k = 0; k < 4; ++k)
      row.segment<10>(static_cast<Eigen::Index>(10 * k)) =
          scale * b[k] * monomials(guide.place - to_vec(mesh.lattice[tet[k]])).transpose();
    scatter(energy.matrix, tet, row * row.transpose(), 1);
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t i = 0; i < 10; ++i)
        energy.right[kBlock * tet[k] + i] += scale * guide.value * row[static_cast<Eigen::Index>(10 * k + i)];
  }
}

/// What an unknown of a vertex of size h is multiplied by to be the quadric's coefficient.
double unit_at(double h, std::size_t n) {
  return n == 0 ? h : n < 4 ? 1 : 1 / h;
}

void scale_unknowns(Energy& energy, const TetMesh& mesh) {
  energy.sizes = vertex_sizes(mesh);
  for (std::size_t v = 0; v < energy.sizes.size(); ++v) {
    const auto columns = energy.matrix.columns(v);
    for (std::size_t n = 0; n < columns.size(); ++n) {
      double* block = energy.matrix.block(v, n);
      for (std::size_t i = 0; i < kBlock; ++i)
        for (std::size_t j = 0; j < kBlock; ++j)
          block[10 * i + j] *= unit_at(energy.sizes[v], i) * unit_at(energy.sizes[columns[n]], j);
    }
    for (std::size_t i = 0; i < kBlock; ++i) energy.right[kBlock * v + i] *= unit_at(energy.sizes[v], i);
  }
}

}  // namespace

double unit_of(const Energy& energy, std::size_t vertex, std::size_t n) {
  return energy.sizes.empty() ? 1 : unit_at(energy.sizes[vertex], n);
}

void solve_energy(Energy energy, std::vector<Quadric>& quadrics, std::size_t* factor_numbers, const Context& context) {
  const BlockCholesky factors(energy.matrix, context);
  if (factor_numbers != nullptr) *factor_numbers = factors.numbers();
  std::vector<double> x = std::move(energy.right);
  solve_past_ridge(factors, energy.ridge, x);
  quadrics.resize(x.size() / kBlock);
  for (std::size_t v = 0; v < quadrics.size(); ++v)
    for (std::size_t i = 0; i < kBlock; ++i) quadrics[v][i] = x[kBlock * v + i] * unit_of(energy, v, i);
}

CgNotes solve_energy_by_cg(const Energy& energy, std::vector<Quadric>& quadrics, double tolerance,
                           const Context& context) {
  std::vector<double> x(energy.right.size());
  for (std::size_t v = 0; v < quadrics.size(); ++v)
    for (std::size_t i = 0; i < kBlock; ++i) x[kBlock * v + i] = quadrics[v][i] / unit_of(energy, v, i);
  const CgNotes notes = solve_cg(energy.matrix, energy.right, x, {.tolerance = tolerance}, context);
  for (std::size_t v = 0; v < quadrics.size(); ++v)
    for (std::size_t i = 0; i < kBlock; ++i) quadrics[v][i] = x[kBlock * v + i] * unit_of(energy, v, i);
  return notes;
}

Energy assemble_energy(const TetMesh& mesh, const HalfFaces& faces, const SampleRuns& samples,
                       const EnergyWeights& weights, const Context& context, std::span<const Guide> guides) {
  Energy energy{empty_matrix(mesh, faces), std::vector<double>(kBlock * mesh.lattice.size(), 0.0), 0, {}};
  add_samples(energy, mesh, samples, weights);
  add_guides(energy, mesh, guides);
  context.check();
  context.report("assemble", 0.5);
  std::map<std::array<std::int32_t, 9>, Eigen::MatrixXd> bending;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const TetCorners& tet = mesh.tets[t];
    const auto [at, fresh] = bending.try_emplace(shape_of(mesh, tet));
    if (fresh) at->second = bending_matrix(points_of(mesh, tet)) / mesh.size(t);
    scatter(energy.matrix, tet, at->second, weights.bending);
  }
  context.check();
  std::map<std::array<std::int32_t, 12>, Eigen::MatrixXd> jumps;
  for (std::size_t f = 0; f < 4 * mesh.tets.size(); ++f) {
    if (faces.opposite(f) <= static_cast<std::int64_t>(f)) continue;
    const auto vertices = around_face(faces, f);
    const auto [at, fresh] = jumps.try_emplace(shape_of(mesh, vertices));
    if (fresh) {
      const double size2 = mesh.size(f / 4) * mesh.size(static_cast<std::size_t>(faces.opposite(f)) / 4);
      at->second =
          jump_matrix(points_of(mesh, vertices), {weights.jump[0] / size2, weights.jump[1], weights.jump[2] * size2});
    }
    scatter(energy.matrix, vertices, at->second, 1);
  }
  if (mesh.forest) scale_unknowns(energy, mesh);
  energy.ridge = weights.ridge * energy.matrix.mean_diagonal();
  energy.matrix.add_ridge(energy.ridge);
  context.report("assemble", 1);
  return energy;
}

}  // namespace retalho
