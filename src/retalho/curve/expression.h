// Formulas given as text, f(x) or f(x, y). The text is parsed by muParserX (behind expression.cpp and nowhere else);
// what it calls for each operator builds a tree of our own, since its numbers alone would not do: the tree is evaluated
// on numbers, on intervals with gradient (for proofs of absence), and turned into an exact polynomial where it is one.
//
// Operators + - * / ^ and brackets, numbers, the variables x and y, the constants pi and e, and
// sqrt cbrt abs exp log log10 sin cos tan asin acos atan sinh cosh tanh floor sign min max.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "retalho/core/interval.h"
#include "retalho/core/vec.h"

namespace retalho {

/// Value and gradient enclosed on a box. `defined`: f exists and is continuous everywhere on the box; `possible`: it
/// exists somewhere perhaps;
/// `smooth`: f is continuously differentiable on the box, so that the gradient's enclosure holds.
struct IntervalJet {
  Interval value, dx, dy;
  bool defined = true, possible = true, smooth = true;
};

class Expression {
 public:
  enum class Op : std::uint8_t {
    number,
    x,
    y,
    add,
    subtract,
    multiply,
    divide,
    negate,
    power,
    sqrt,
    cbrt,
    abs,
    exp,
    log,
    log10,
    sin,
    cos,
    tan,
    asin,
    acos,
    atan,
    sinh,
    cosh,
    tanh,
    floor,
    sign,
    min,
    max
  };
  struct Node {
    Op op = Op::number;
    double number = 0;
    std::int32_t a = -1, b = -1;  ///< operands, always earlier in the list
  };

  /// Throws BadInput with the position: syntax, an unknown name.
  static Expression parse(const std::string& text);

  /// NaN where f is not defined.
  double operator()(double x, double y = 0) const;
  /// Encloses f and its gradient on the box; rounding is outward, libm is trusted to 4 units in the last place.
  IntervalJet enclose(Interval x, Interval y) const;

  /// One node's operation on numbers.
  static double apply(const Node& node, double a, double b);

  bool uses_y() const;
  const std::vector<Node>& nodes() const { return nodes_; }  ///< the last one is the value
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::vector<Node> nodes_;
};

}  // namespace retalho
