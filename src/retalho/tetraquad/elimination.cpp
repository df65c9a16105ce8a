#include "retalho/tetraquad/elimination.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace retalho {
namespace {

using Lists = std::vector<std::vector<std::uint32_t>>;

Lists adjacency(const BlockMatrix& matrix) {
  Lists adjacent;
  adjacent.resize(matrix.rows());
  for (std::uint32_t v = 0; v < matrix.rows(); ++v)
    for (const std::uint32_t w : matrix.columns(v)) {
      if (w == v) continue;
      adjacent[v].push_back(w);
      adjacent[w].push_back(v);
    }
  return adjacent;
}

/// The vertices in order of approximate minimum degree.
std::vector<std::uint32_t> minimum_degree(const Lists& adjacent) {
  const auto size = static_cast<int>(adjacent.size());
  std::vector<Eigen::Triplet<double, int>> entries;
  for (int v = 0; v < size; ++v) {
    entries.emplace_back(v, v, 1.0);
    for (const std::uint32_t w : adjacent[static_cast<std::size_t>(v)])
      entries.emplace_back(v, static_cast<int>(w), 1.0);
  }
  Eigen::SparseMatrix<double> pattern(size, size);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(pattern, permutation);
  return {permutation.indices().data(), permutation.indices().data() + size};
}

/// For each step of the elimination, the later steps that it couples to, ascending; the first is its parent.
Lists symbolic(const Lists& adjacent, const std::vector<std::uint32_t>& order) {
  std::vector<std::uint32_t> step(order.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) step[order[k]] = k;
  Lists later, children;
  later.resize(order.size());
  children.resize(order.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) {
    std::vector<std::uint32_t>& list = later[k];
    for (const std::uint32_t w : adjacent[order[k]])
      if (step[w] > k) list.push_back(step[w]);
    for (const std::uint32_t c : children[k])
      for (const std::uint32_t s : later[c])
        if (s > k) list.push_back(s);
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    if (!list.empty()) children[list.front()].push_back(k);
  }
  return later;
}

/// Is it worth eliminating the child with its parent? The zeros that this adds against what there is.
bool worth_joining(std::size_t child_pivots, std::size_t child_border, std::size_t pivots, std::size_t border) {
  const auto zeros = static_cast<double>(child_pivots * (pivots + border - child_border));
  const auto all = static_cast<double>(child_pivots * (child_pivots + pivots + border) + pivots * (pivots + border));
  return zeros <= (child_pivots + pivots <= 2 ? 0.1 : 0.01) * all;
}

}  // namespace

std::vector<Supernode> plan_elimination(const BlockMatrix& matrix) {
  const Lists adjacent = adjacency(matrix);
  const std::vector<std::uint32_t> order = minimum_degree(adjacent);
  const Lists later = symbolic(adjacent, order);
  const auto size = static_cast<std::uint32_t>(order.size());

  // Joined from the leaves up: `joined[k]` are the steps eliminated with step k, k the last of them.
  Lists joined, children;
  joined.resize(size);
  children.resize(size);
  std::vector<char> gone(size, 0);
  for (std::uint32_t k = 0; k < size; ++k)
    if (!later[k].empty()) children[later[k].front()].push_back(k);
  for (std::uint32_t k = 0; k < size; ++k) {
    joined[k].push_back(k);
    std::vector<std::uint32_t> kept;
    // The child with the largest border first: it costs the fewest zeros.
    std::stable_sort(children[k].begin(), children[k].end(),
                     [&](std::uint32_t a, std::uint32_t b) { return later[a].size() > later[b].size(); });
    for (const std::uint32_t c : children[k]) {
      if (worth_joining(joined[c].size(), later[c].size(), joined[k].size(), later[k].size())) {
        joined[k].insert(joined[k].begin(), joined[c].begin(), joined[c].end());
        kept.insert(kept.end(), children[c].begin(), children[c].end());
        gone[c] = 1;
        joined[c] = {};
      } else {
        kept.push_back(c);
      }
    }
    children[k] = std::move(kept);
  }

  std::vector<Supernode> nodes;
  std::vector<std::uint32_t> rank(size, 0);  // of a step, in the order of the joined elimination
  std::uint32_t next = 0;
  const auto emit = [&](std::uint32_t root) {
    struct Visit {
      std::uint32_t step;
      std::size_t child = 0;
      std::vector<std::int32_t> numbers = {};
    };
    std::vector<Visit> stack = {{root}};
    while (!stack.empty()) {
      Visit& top = stack.back();
      if (top.child < children[top.step].size()) {
        stack.push_back({children[top.step][top.child++]});
        continue;
      }
      Supernode node;
      for (const std::uint32_t s : joined[top.step]) {
        node.pivots.push_back(order[s]);
        rank[s] = next++;
      }
      node.border = later[top.step];  // steps, for now
      node.children = std::move(top.numbers);
      stack.pop_back();
      if (!stack.empty()) stack.back().numbers.push_back(static_cast<std::int32_t>(nodes.size()));
      nodes.push_back(std::move(node));
    }
  };
  for (std::uint32_t k = 0; k < size; ++k)
    if (later[k].empty()) emit(k);
  for (Supernode& node : nodes) {
    std::sort(node.border.begin(), node.border.end(),
              [&](std::uint32_t a, std::uint32_t b) { return rank[a] < rank[b]; });
    for (std::uint32_t& s : node.border) s = order[s];
  }
  return nodes;
}

}  // namespace retalho
