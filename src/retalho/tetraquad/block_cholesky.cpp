// BlockCholesky by our own multifrontal method. With SuiteSparse, block_cholesky_cholmod.cpp stands in its place.
#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "retalho/core/error.h"
#include "retalho/tetraquad/block_matrix.h"
#include "retalho/tetraquad/dense_front.h"
#include "retalho/tetraquad/elimination.h"

namespace retalho {

struct BlockCholesky::Parts {
  std::vector<Supernode> nodes;
  /// Per node: the columns of its pivots one after the other, each from its diagonal on; rows: pivots, then border.
  std::vector<std::vector<double>> columns;
  std::size_t numbers = 0;
};

namespace {

/// Adds block (v, w) of the matrix at rows `r`, columns `c` (block indices) of the front's lower triangle.
void place_block(double* front, std::size_t n, std::size_t r, std::size_t c, const double* value, bool transposed) {
  for (std::size_t j = 0; j < kBlock; ++j)
    for (std::size_t i = 0; i < kBlock; ++i)
      front[(kBlock * c + j) * n + kBlock * r + i] += transposed ? value[10 * j + i] : value[10 * i + j];
}

/// A child's share of the rest (columns one after the other, each from its diagonal on), added to its parent's front at
/// the blocks `at`.
void extend_add(double* front, std::size_t n, const double* share, const std::vector<std::size_t>& at) {
  for (std::size_t c = 0; c < at.size(); ++c)
    for (std::size_t j = 0; j < kBlock; ++j) {
      double* column = front + (kBlock * at[c] + j) * n;
      for (std::size_t i = j; i < kBlock; ++i) column[kBlock * at[c] + i] += *share++;
      for (std::size_t r = c + 1; r < at.size(); ++r, share += kBlock)
        for (std::size_t i = 0; i < kBlock; ++i) column[kBlock * at[r] + i] += share[i];
    }
}

/// Sum of a[i] b[i], in eight partial sums: one after the other each would wait for the last.
double dot(const double* a, const double* b, std::size_t n) {
  constexpr std::size_t lanes = 8;
  std::array<double, lanes> sums = {};
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes)
    for (std::size_t k = 0; k < lanes; ++k) sums[k] += a[i + k] * b[i + k];
  for (; i < n; ++i) sums[i % lanes] += a[i] * b[i];
  return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

/// The largest front, and the most that children's shares take at any time.
struct Room {
  std::size_t front = 0, shares = 0;
};

Room room_of(const std::vector<Supernode>& nodes) {
  Room room;
  std::vector<std::size_t> start(nodes.size(), 0);
  std::size_t top = 0;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const std::size_t rest = kBlock * nodes[k].border.size(), n = kBlock * nodes[k].pivots.size() + rest;
    if (!nodes[k].children.empty()) top = start[static_cast<std::size_t>(nodes[k].children.front())];
    start[k] = top;
    top += rest * (rest + 1) / 2;
    room.front = std::max(room.front, n * n);
    room.shares = std::max(room.shares, top);
  }
  return room;
}

}  // namespace

BlockCholesky::BlockCholesky(const BlockMatrix& matrix, const Context& context) : parts_(std::make_unique<Parts>()) {
  std::vector<Supernode>& nodes = parts_->nodes;
  nodes = plan_elimination(matrix);
  // Blocks of the lower rows of the upper triangle: (v, w) with w > v is needed by whichever is eliminated first.
  std::vector<std::vector<std::pair<std::uint32_t, const double*>>> mirrored(matrix.rows());
  for (std::uint32_t v = 0; v < matrix.rows(); ++v) {
    const auto row = matrix.columns(v);
    for (std::size_t n = 1; n < row.size(); ++n) mirrored[row[n]].emplace_back(v, matrix.block(v, n));
  }
  constexpr std::size_t absent = ~std::size_t{0};
  std::vector<std::size_t> local(matrix.rows(), absent), at;
  // What children leave for their parents is a stack, since they come right before them.
  std::vector<std::size_t> share_start(nodes.size(), 0);
  const Room room = room_of(nodes);
  // Not filled: what is read of them is written first.
  const auto shares = std::make_unique_for_overwrite<double[]>(room.shares);
  const auto front = std::make_unique_for_overwrite<double[]>(room.front);
  std::size_t top = 0;
  parts_->columns.resize(nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    context.check();
    const Supernode& node = nodes[k];
    std::size_t count = 0;
    for (const std::uint32_t v : node.pivots) local[v] = count++;
    for (const std::uint32_t v : node.border) local[v] = count++;
    const std::size_t n = kBlock * count, pivots = kBlock * node.pivots.size();
    for (std::size_t c = 0; c < n; ++c) std::fill_n(front.get() + c * n + c, n - c, 0.0);
    for (std::size_t c = 0; c < node.pivots.size(); ++c) {
      const std::uint32_t v = node.pivots[c];
      const auto row = matrix.columns(v);
      for (std::size_t b = 0; b < row.size(); ++b)
        if (local[row[b]] != absent && local[row[b]] >= c)
          place_block(front.get(), n, local[row[b]], c, matrix.block(v, b), true);
      for (const auto& [w, value] : mirrored[v])
        if (local[w] != absent && local[w] > c) place_block(front.get(), n, local[w], c, value, false);
    }
    for (const std::int32_t child : node.children) {
      at.clear();
      for (const std::uint32_t v : nodes[static_cast<std::size_t>(child)].border) at.push_back(local[v]);
      extend_add(front.get(), n, shares.get() + share_start[static_cast<std::size_t>(child)], at);
    }
    if (!node.children.empty()) top = share_start[static_cast<std::size_t>(node.children.front())];
    if (!factor_front(front.get(), n, pivots))
      throw Error(Error::Kind::internal,
                  "the fit's matrix is not positive definite: raise the smoothness or the ridge");
    std::vector<double>& columns = parts_->columns[k];
    columns.reserve(pivots * n - pivots * (pivots - 1) / 2);
    for (std::size_t c = 0; c < pivots; ++c)
      columns.insert(columns.end(), front.get() + c * n + c, front.get() + (c + 1) * n);
    parts_->numbers += columns.size();
    share_start[k] = top;
    for (std::size_t c = pivots; c < n; ++c) {
      std::copy_n(front.get() + c * n + c, n - c, shares.get() + top);
      top += n - c;
    }
    for (const std::uint32_t v : node.pivots) local[v] = absent;
    for (const std::uint32_t v : node.border) local[v] = absent;
    context.report("factorise", static_cast<double>(k + 1) / static_cast<double>(nodes.size()));
  }
}

BlockCholesky::~BlockCholesky() = default;
BlockCholesky::BlockCholesky(BlockCholesky&&) noexcept = default;
BlockCholesky& BlockCholesky::operator=(BlockCholesky&&) noexcept = default;

std::size_t BlockCholesky::numbers() const {
  return parts_->numbers;
}

void BlockCholesky::solve(std::span<double> x) const {
  std::vector<double> part;
  const auto gather = [&](const Supernode& node) {
    part.clear();
    for (const auto* list : {&node.pivots, &node.border})
      for (const std::uint32_t v : *list) part.insert(part.end(), x.begin() + kBlock * v, x.begin() + kBlock * (v + 1));
  };
  const auto scatter = [&](const Supernode& node) {
    const double* from = part.data();
    for (const auto* list : {&node.pivots, &node.border})
      for (const std::uint32_t v : *list) {
        std::copy_n(from, kBlock, x.begin() + kBlock * v);
        from += kBlock;
      }
  };
  for (std::size_t k = 0; k < parts_->nodes.size(); ++k) {
    gather(parts_->nodes[k]);
    const std::size_t n = part.size(), pivots = kBlock * parts_->nodes[k].pivots.size();
    const double* column = parts_->columns[k].data();
    for (std::size_t c = 0; c < pivots; ++c) {
      const double value = part[c] /= column[0];
      for (std::size_t r = 1; r < n - c; ++r) part[c + r] -= column[r] * value;
      column += n - c;
    }
    scatter(parts_->nodes[k]);
  }
  for (std::size_t k = parts_->nodes.size(); k-- > 0;) {
    gather(parts_->nodes[k]);
    const std::size_t n = part.size(), pivots = kBlock * parts_->nodes[k].pivots.size();
    const double* column = parts_->columns[k].data() + parts_->columns[k].size();
    for (std::size_t c = pivots; c-- > 0;) {
      column -= n - c;
      part[c] = (part[c] - dot(column + 1, part.data() + c + 1, n - c - 1)) / column[0];
    }
    scatter(parts_->nodes[k]);
  }
}

}  // namespace retalho
