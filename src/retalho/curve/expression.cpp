#include "retalho/curve/expression.h"

#include <fmt/format.h>
#include <muparserx/mpParser.h>
#include <muparserx/mpValReader.h>

#include <cmath>
#include <numbers>

#include "retalho/core/error.h"

namespace retalho {

namespace {

using Op = Expression::Op;
using Node = Expression::Node;

struct FunctionName {
  const char* name;
  Op op;
  int operands;
};
constexpr FunctionName kFunctions[] = {
    {"sqrt", Op::sqrt, 1}, {"cbrt", Op::cbrt, 1},   {"abs", Op::abs, 1},   {"exp", Op::exp, 1},   {"log", Op::log, 1},
    {"ln", Op::log, 1},    {"log10", Op::log10, 1}, {"sin", Op::sin, 1},   {"cos", Op::cos, 1},   {"tan", Op::tan, 1},
    {"asin", Op::asin, 1}, {"acos", Op::acos, 1},   {"atan", Op::atan, 1}, {"sinh", Op::sinh, 1}, {"cosh", Op::cosh, 1},
    {"tanh", Op::tanh, 1}, {"floor", Op::floor, 1}, {"sign", Op::sign, 1}, {"min", Op::min, 2},   {"max", Op::max, 2}};

/// muParserX computes with values; ours are references into the tree, carried as text ("@12"). A plain number becomes
/// a node when an operator meets it.
class Tree {
 public:
  std::vector<Node> nodes;

  std::int32_t read(mup::IValue& v) {
    if (v.GetType() == 's') return std::stoi(v.GetString().substr(1));
    nodes.push_back({Op::number, v.GetFloat()});
    return static_cast<std::int32_t>(nodes.size()) - 1;
  }
  static std::string reference(std::int32_t node) { return fmt::format("@{}", node); }
  std::string add(Op op, mup::ptr_val_type* operands, int count) {
    Node node{op};
    node.a = read(*operands[0]);
    if (count > 1) node.b = read(*operands[1]);
    nodes.push_back(node);
    return reference(static_cast<std::int32_t>(nodes.size()) - 1);
  }
};

class Binary : public mup::IOprtBin {
 public:
  Binary(Tree& tree, const char* name, Op op, int precedence, mup::EOprtAsct side)
      : IOprtBin(name, precedence, side), tree_(tree), op_(op) {}
  void Eval(mup::ptr_val_type& result, const mup::ptr_val_type* operands, int count) override {
    mup::ptr_val_type own[] = {operands[0], operands[1]};
    *result = tree_.add(op_, own, count);
  }
  const mup::char_type* GetDesc() const override { return ""; }
  mup::IToken* Clone() const override { return new Binary(*this); }

 private:
  Tree& tree_;
  Op op_;
};

class Sign : public mup::IOprtInfix {
 public:
  Sign(Tree& tree, const char* name, bool minus) : IOprtInfix(name, mup::prMUL_DIV), tree_(tree), minus_(minus) {}
  void Eval(mup::ptr_val_type& result, const mup::ptr_val_type* operands, int) override {
    mup::ptr_val_type own[] = {operands[0]};
    if (minus_)
      *result = tree_.add(Op::negate, own, 1);
    else
      *result = Tree::reference(tree_.read(*own[0]));
  }
  const mup::char_type* GetDesc() const override { return ""; }
  mup::IToken* Clone() const override { return new Sign(*this); }

 private:
  Tree& tree_;
  bool minus_;
};

class Function : public mup::ICallback {
 public:
  Function(Tree& tree, const FunctionName& f) : ICallback(mup::cmFUNC, f.name, f.operands), tree_(tree), op_(f.op) {}
  void Eval(mup::ptr_val_type& result, const mup::ptr_val_type* operands, int count) override {
    mup::ptr_val_type own[2] = {operands[0], count > 1 ? operands[1] : mup::ptr_val_type()};
    *result = tree_.add(op_, own, count);
  }
  const mup::char_type* GetDesc() const override { return ""; }
  mup::IToken* Clone() const override { return new Function(*this); }

 private:
  Tree& tree_;
  Op op_;
};

/// The nodes that the root needs, in order: the parser may evaluate an expression more than once.
std::vector<Node> reachable(const std::vector<Node>& all, std::int32_t root) {
  std::vector<std::int32_t> place(all.size(), -1);
  std::vector<Node> out;
  std::vector<char> wanted(all.size(), 0);
  wanted[static_cast<std::size_t>(root)] = 1;
  for (auto i = static_cast<std::size_t>(root) + 1; i-- > 0;) {
    if (!wanted[i]) continue;
    if (all[i].a >= 0) wanted[static_cast<std::size_t>(all[i].a)] = 1;
    if (all[i].b >= 0) wanted[static_cast<std::size_t>(all[i].b)] = 1;
  }
  for (std::size_t i = 0; i <= static_cast<std::size_t>(root); ++i) {
    if (!wanted[i]) continue;
    Node node = all[i];
    if (node.a >= 0) node.a = place[static_cast<std::size_t>(node.a)];
    if (node.b >= 0) node.b = place[static_cast<std::size_t>(node.b)];
    place[i] = static_cast<std::int32_t>(out.size());
    out.push_back(node);
  }
  return out;
}

}  // namespace

double Expression::apply(const Node& node, double a, double b) {
  switch (node.op) {
    case Op::add:
      return a + b;
    case Op::subtract:
      return a - b;
    case Op::multiply:
      return a * b;
    case Op::divide:
      return a / b;
    case Op::negate:
      return -a;
    case Op::power:
      return std::pow(a, b);
    case Op::sqrt:
      return std::sqrt(a);
    case Op::cbrt:
      return std::cbrt(a);
    case Op::abs:
      return std::abs(a);
    case Op::exp:
      return std::exp(a);
    case Op::log:
      return std::log(a);
    case Op::log10:
      return std::log10(a);
    case Op::sin:
      return std::sin(a);
    case Op::cos:
      return std::cos(a);
    case Op::tan:
      return std::tan(a);
    case Op::asin:
      return std::asin(a);
    case Op::acos:
      return std::acos(a);
    case Op::atan:
      return std::atan(a);
    case Op::sinh:
      return std::sinh(a);
    case Op::cosh:
      return std::cosh(a);
    case Op::tanh:
      return std::tanh(a);
    case Op::floor:
      return std::floor(a);
    case Op::sign:
      return a > 0 ? 1 : a < 0 ? -1 : a;
    case Op::min:
      return std::isnan(a) || std::isnan(b) ? std::nan("") : std::min(a, b);
    case Op::max:
      return std::isnan(a) || std::isnan(b) ? std::nan("") : std::max(a, b);
    case Op::number:
      return node.number;
    case Op::x:
    case Op::y:
      break;
  }
  return std::nan("");
}

Expression Expression::parse(const std::string& text) {
  // To muParserX a new line begins another formula, whose value is all that is left, and a NUL behind a '#' is an end.
  for (std::size_t k = 0; k < text.size(); ++k)
    if (const auto c = static_cast<unsigned char>(text[k]); (c < ' ' && c != '\t') || c == 127)
      throw BadInput(
          fmt::format("the formula has a control character (code {}) at place {}: write it on one line", c, k + 1));
  Tree tree;
  tree.nodes = {{Op::x}, {Op::y}, {Op::number, std::numbers::pi}, {Op::number, std::numbers::e}};
  mup::ParserX parser(0U);  // none of its own functions: every name is ours
  parser.AddValueReader(new mup::DblValReader());
  parser.EnableOptimizer(false);
  parser.EnableAutoCreateVar(false);
  const auto constant = [&](const char* name, std::int32_t node) {
    parser.DefineConst(name, mup::Value(Tree::reference(node)));
  };
  constant("x", 0);
  constant("y", 1);
  constant("pi", 2);
  constant("e", 3);
  parser.DefineOprt(mup::TokenPtr<mup::IOprtBin>(new Binary(tree, "+", Op::add, mup::prADD_SUB, mup::oaLEFT)));
  parser.DefineOprt(mup::TokenPtr<mup::IOprtBin>(new Binary(tree, "-", Op::subtract, mup::prADD_SUB, mup::oaLEFT)));
  parser.DefineOprt(mup::TokenPtr<mup::IOprtBin>(new Binary(tree, "*", Op::multiply, mup::prMUL_DIV, mup::oaLEFT)));
  parser.DefineOprt(mup::TokenPtr<mup::IOprtBin>(new Binary(tree, "/", Op::divide, mup::prMUL_DIV, mup::oaLEFT)));
  parser.DefineOprt(mup::TokenPtr<mup::IOprtBin>(new Binary(tree, "^", Op::power, mup::prPOW, mup::oaRIGHT)));
  parser.DefineInfixOprt(mup::TokenPtr<mup::IOprtInfix>(new Sign(tree, "-", true)));
  parser.DefineInfixOprt(mup::TokenPtr<mup::IOprtInfix>(new Sign(tree, "+", false)));
  for (const FunctionName& f : kFunctions) parser.DefineFun(mup::TokenPtr<mup::ICallback>(new Function(tree, f)));
  Expression result;
  result.text_ = text;
  try {
    parser.SetExpr(text);
    mup::Value value = parser.Eval();
    const std::int32_t root = tree.read(value);
    result.nodes_ = reachable(tree.nodes, root);
  } catch (const mup::ParserError& error) {
    const int at = error.GetPos();
    const std::string where = at >= 0 ? fmt::format("character {}", at + 1) : std::string();
    throw BadInput(fmt::format("formula \"{}\"{}{}: {}", text, where.empty() ? "" : ", ", where, error.GetMsg()), {},
                   where);
  }
  return result;
}

double Expression::operator()(double x, double y) const {
  // Formulas are short: a small buffer on the stack serves all but monsters.
  constexpr std::size_t kSmall = 64;
  double stack[kSmall];
  std::vector<double> heap(nodes_.size() > kSmall ? nodes_.size() : 0);
  double* v = heap.empty() ? stack : heap.data();
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& n = nodes_[i];
    v[i] = n.op == Op::number ? n.number
           : n.op == Op::x    ? x
           : n.op == Op::y    ? y
                              : apply(n, v[n.a], n.b >= 0 ? v[n.b] : 0);
  }
  return v[nodes_.size() - 1];
}

bool Expression::uses_y() const {
  for (const Node& n : nodes_)
    if (n.op == Op::y) return true;
  return false;
}

}  // namespace retalho
