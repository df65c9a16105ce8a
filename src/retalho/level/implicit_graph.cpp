#include "retalho/level/implicit_graph.h"

#include "retalho/curve/convert.h"

namespace retalho {

std::optional<Curve> polynomial_graph(const Expression& f, double from, double to) {
  if (f.uses_y() || !(from < to)) return std::nullopt;
  const auto p = polynomial_on_box(f, {from, 0, to, 1});
  if (!p) return std::nullopt;
  std::vector<double> b;
  for (int i = 0; i <= p->degree_x; ++i) b.push_back(p->at(i, 0));
  return from_graph(b, from, to);
}

}  // namespace retalho
