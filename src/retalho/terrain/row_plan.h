// A split triangle made ready for rows of cells: on each piece that a row crosses the height is a polynomial in the
// column, whose coefficients are blossoms of the piece's net at the first cell and along the row. Nothing is carried
// from row to row or from piece to piece, so no error grows, and slivers are as exact as single queries.
#pragma once

#include <array>

#include "retalho/terrain/clough_tocher.h"
#include "retalho/terrain/evaluator_parts.h"
#include "retalho/terrain/powell_sabin.h"

namespace retalho {

/// The net of the derivative's blossom along direction `d` (whose coordinates sum to 0), without the factor Degree.
template <int Degree>
TriangleNet<Degree - 1> contract(const TriangleNet<Degree>& b, Barycentric d) {
  TriangleNet<Degree - 1> c{};
  for (int i = Degree - 1; i >= 0; --i)
    for (int j = Degree - 1 - i; j >= 0; --j) {
      const double last = b[static_cast<std::size_t>(ordinate_index(Degree, i, j))];
      c[static_cast<std::size_t>(ordinate_index(Degree - 1, i, j))] =
          d.r * (b[static_cast<std::size_t>(ordinate_index(Degree, i + 1, j))] - last) +
          d.s * (b[static_cast<std::size_t>(ordinate_index(Degree, i, j + 1))] - last);
    }
  return c;
}

/// Which piece lies behind the side of `piece` opposite to its coordinate 0, 1 or 2; -1: the triangle's own edge.
inline int piece_behind(const LinearElement*, int, int) {
  return -1;
}
inline int piece_behind(const CloughTocherElement*, int piece, int coordinate) {
  return coordinate == 2 ? -1 : (piece + 1 + coordinate) % 3;
}
inline int piece_behind(const PowellSabinElement*, int piece, int coordinate) {
  const int k = piece / 2, i = (k + 1) % 3, j = (k + 2) % 3;
  if (coordinate == 0) return -1;
  if (piece % 2 == 0) return coordinate == 1 ? piece + 1 : 2 * j + 1;  // across the rib, or the spoke of corner i
  return coordinate == 2 ? piece - 1 : 2 * i;                          // across the rib, or the spoke of corner j
}

template <class Element>
class RowPlan {
  static constexpr int kDegree = Element::kDegree;
  static constexpr std::size_t kPieces = Element::kPieces;

 public:
  /// Starts on another triangle. `column`: the change of the triangle's coordinates from one column to the next.
  void begin(const Element& element, Barycentric column) {
    element_ = &element;
    column_ = column;
    ready_ = 0;
  }

  /// Heights of `count` cells of a row, the first at `start`.
  void fill(Barycentric start, int count, double* out) {
    if (count == 1) {
      *out = element_value(*element_, start);
      return;
    }
    PiecePoint place = element_->find(start);
    for (int done = 0;;) {
      const Piece& piece = prepared(place.piece);
      const Reach ahead = reach(piece, place, count - done);
      const int run = ahead.run, next = ahead.next;
      write(piece, place.at, run, out + done);
      done += run;
      if (done >= count) return;
      const Barycentric at{start.r + done * column_.r, start.s + done * column_.s, start.t + done * column_.t};
      place = next < 0 ? element_->find(at) : PiecePoint{next, element_->within(next, at)};
    }
  }

 private:
  struct Piece {
    TriangleNet<kDegree> net;
    TriangleNet<kDegree - 1> first;                      // contracted once along the row
    TriangleNet<kDegree >= 2 ? kDegree - 2 : 0> second;  // twice
    double third = 0;
    Barycentric column;  // change of the piece's coordinates a column
    Barycentric lasts;   // columns until a coordinate of 1 is used up; 0: it grows
  };

  const Piece& prepared(int number) {
    Piece& piece = pieces_[static_cast<std::size_t>(number)];
    if (ready_ >> number & 1U) return piece;
    ready_ |= 1U << number;
    piece.net = element_->net(number);
    piece.column = element_->within(number, column_);
    const auto lasts = [](double change) { return change < 0 ? -1 / change : 0.0; };
    piece.lasts = {lasts(piece.column.r), lasts(piece.column.s), lasts(piece.column.t)};
    piece.first = contract<kDegree>(piece.net, piece.column);
    if constexpr (kDegree >= 2) piece.second = contract<kDegree - 1>(piece.first, piece.column);
    if constexpr (kDegree >= 3) piece.third = contract<1>(piece.second, piece.column)[0];
    return piece;
  }

  struct Reach {
    int run, next;
  };
  /// How many cells from `place` on lie in its piece (at least 1), and the piece behind; -1: to be looked for.
  static Reach reach(const Piece& piece, const PiecePoint& place, int most) {
    double columns = most;
    int behind = -1;
    const auto consider = [&](int coordinate, double lasts, double at) {
      const int next = piece_behind(static_cast<const Element*>(nullptr), place.piece, coordinate);
      if (next < 0 || lasts == 0) return;
      const double until = lasts * at;
      if (until < columns) {
        columns = until;
        behind = next;
      }
    };
    consider(0, piece.lasts.r, place.at.r);
    consider(1, piece.lasts.s, place.at.s);
    consider(2, piece.lasts.t, place.at.t);
    if (behind < 0) return {most, -1};
    if (columns < 0) return {1, -1};  // rounding put the cell just outside: take it, and look again
    return {std::min(most, static_cast<int>(columns) + 1), behind};
  }

  static void write(const Piece& piece, Barycentric at, int count, double* out) {
    const double c0 = evaluate<kDegree>(piece.net, at);
    if (count == 1) {
      *out = c0;
      return;
    }
    const double c1 = kDegree * evaluate<kDegree - 1>(piece.first, at);
    if constexpr (kDegree == 1) {
      for (int n = 0; n < count; ++n) out[n] = c0 + n * c1;
    } else if constexpr (kDegree == 2) {
      const double c2 = piece.second[0];
      for (int n = 0; n < count; ++n) out[n] = c0 + n * (c1 + n * c2);
    } else {
      const double c2 = 3 * evaluate<1>(piece.second, at), c3 = piece.third;
      for (int n = 0; n < count; ++n) out[n] = c0 + n * (c1 + n * (c2 + n * c3));
    }
  }

  const Element* element_ = nullptr;
  Barycentric column_;
  std::array<Piece, kPieces> pieces_;
  unsigned ready_ = 0;
};

}  // namespace retalho
