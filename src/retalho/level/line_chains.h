// Internal to level/: lines put together from pieces that come one after the other and meet at numbered places.
#pragma once

#include <cstdint>
#include <list>
#include <span>
#include <unordered_map>
#include <vector>

#include "retalho/level/raw_lines.h"

namespace retalho {

class LineChains {
 public:
  using Place = std::uint64_t;
  static constexpr Place kEnd = ~Place{0};  ///< the line goes on nowhere

  struct Piece {
    int level;
    Place head, tail;           ///< what comes before its first point, and after its last one
    std::uint32_t start, stop;  ///< what its ends are called
    std::span<const Vec2> points;
  };
  /// A piece with an end that is not kEnd. At each place one piece ends and one starts.
  void add(const Piece& piece);
  /// Nothing more comes at this place.
  void close(Place place);
  /// Moves the lines that have become whole since the last call behind those of `lines`. A closed one begins with its
  /// piece of the smallest start.
  void move_done(RawLines& lines);

 private:
  struct Part {
    std::uint32_t start;
    std::vector<Vec2> points;  ///< the last one is the next part's first
  };
  struct Chain {
    int level;
    std::list<Part> parts;
    std::uint32_t stop;
    Place head, tail;
  };
  static constexpr std::uint32_t kNone = 0xffffffffU;

  std::uint32_t take_waiting(Place place);
  void wait(Place place, std::uint32_t chain);
  std::uint32_t new_chain(int level);
  void finish_if_whole(std::uint32_t chain);
  void finish(std::uint32_t chain, bool closed);

  std::vector<Chain> chains_;
  std::vector<std::uint32_t> free_;
  std::unordered_map<Place, std::uint32_t> waiting_;  ///< the chain that goes on there
  RawLines done_;
};

}  // namespace retalho
