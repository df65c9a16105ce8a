// BlockCholesky by our own multifrontal method. With SuiteSparse, block_cholesky_cholmod.cpp stands in its place.
#include <algorithm>
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
  std::vector<double> shares, front;
  std::vector<std::size_t> share_start(nodes.size(), 0);
  std::size_t top = 0;
  parts_->columns.resize(nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    context.check();
    const Supernode& node = nodes[k];
    std::size_t count = 0;
    for (const std::uint32_t v : node.pivots) local[v] = count++;
    for (const std::uint32_t v : node.border) local[v] = count++;
    const std::size_t n = kBlock * count, pivots = kBlock * node.pivots.size();
    if (front.size() < n * n) front.resize(n * n);
    for (std::size_t c = 0; c < n; ++c) std::fill_n(front.data() + c * n + c, n - c, 0.0);
    for (std::size_t c = 0; c < node.pivots.size(); ++c) {
      const std::uint32_t v = node.pivots[c];
      const auto row = matrix.columns(v);
      for (std::size_t b = 0; b < row.size(); ++b)
        if (local[row[b]] != absent && local[row[b]] >= c)
          place_block(front.data(), n, local[row[b]], c, matrix.block(v, b), true);
      for (const auto& [w, value] : mirrored[v])
        if (local[w] != absent && local[w] > c) place_block(front.data(), n, local[w], c, value, false);
    }
    for (const std::int32_t child : node.children) {
      at.clear();
      for (const std::uint32_t v : nodes[static_cast<std::size_t>(child)].border) at.push_back(local[v]);
      extend_add(front.data(), n, shares.data() + share_start[static_cast<std::size_t>(child)], at);
    }
    if (!node.children.empty()) top = share_start[static_cast<std::size_t>(node.children.front())];
    if (!factor_front(front.data(), n, pivots))
      throw Error(Error::Kind::internal,
                  "the fit's matrix is not positive definite: raise the smoothness or the ridge");
    std::vector<double>& columns = parts_->columns[k];
    columns.reserve(pivots * n - pivots * (pivots - 1) / 2);
    for (std::size_t c = 0; c < pivots; ++c)
      columns.insert(columns.end(), front.begin() + static_cast<std::ptrdiff_t>(c * n + c),
                     front.begin() + static_cast<std::ptrdiff_t>((c + 1) * n));
    parts_->numbers += columns.size();
    share_start[k] = top;
    const std::size_t rest = n - pivots;
    if (shares.size() < top + rest * (rest + 1) / 2) shares.resize(top + rest * (rest + 1) / 2);
    for (std::size_t c = pivots; c < n; ++c) {
      std::copy_n(front.data() + c * n + c, n - c, shares.data() + top);
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
      double value = part[c];
      for (std::size_t r = 1; r < n - c; ++r) value -= column[r] * part[c + r];
      part[c] = value / column[0];
    }
    scatter(parts_->nodes[k]);
  }
}

}  // namespace retalho
