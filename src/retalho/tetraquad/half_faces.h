// The compact half-face structure (CHF) of a tetrahedral mesh: two arrays say everything (Lage, Lewiner, Lopes, Velho
// 2005). Half-face 4 t + i is the face of tetrahedron t opposite to its corner i; V[4 t + i] is that corner's vertex
// and O[4 t + i] the half-face on the other side, or -1 on the border.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace retalho {

using TetCorners = std::array<std::uint32_t, 4>;

class HalfFaces {
 public:
  HalfFaces() = default;
  /// Throws BadInput when three tetrahedra share a face, or a tetrahedron names a vertex twice or one that is not below
  /// `vertices`. Cost: a sort of the faces, about 0.2 us a face.
  HalfFaces(std::vector<TetCorners> tets, std::size_t vertices);

  std::size_t tets() const { return tets_.size(); }
  std::size_t vertices() const { return first_.size(); }
  const TetCorners& corners(std::size_t tet) const { return tets_[tet]; }
  std::uint32_t vertex(std::size_t half_face) const { return tets_[half_face / 4][half_face % 4]; }
  /// The half-face on the other side, or -1.
  std::int64_t opposite(std::size_t half_face) const { return opposite_[half_face]; }
  /// The tetrahedron on the other side, or -1.
  std::int64_t neighbour(std::size_t tet, std::size_t corner) const {
    const std::int64_t o = opposite_[4 * tet + corner];
    return o < 0 ? -1 : o / 4;
  }
  bool is_border(std::size_t half_face) const { return opposite_[half_face] < 0; }

  /// Tetrahedra that share the vertex, ascending: walks across faces from one of each fan. Cost: the star's size.
  std::vector<std::uint32_t> star(std::uint32_t vertex) const;
  /// Tetrahedra that share the edge, ascending.
  std::vector<std::uint32_t> star(std::uint32_t a, std::uint32_t b) const;
  /// The half-faces of the vertex's star that do not hold it: its link, ascending.
  std::vector<std::uint32_t> link(std::uint32_t vertex) const;
  /// Vertices that share an edge with this one, ascending.
  std::vector<std::uint32_t> neighbours(std::uint32_t vertex) const;
  /// All half-faces without another side, ascending.
  std::vector<std::uint32_t> border() const;
  /// A number for each tetrahedron: those that hang together through faces have the same, from 0 up.
  std::vector<std::uint32_t> components(std::size_t* count = nullptr) const;

 private:
  std::vector<TetCorners> tets_;
  std::vector<std::int32_t> opposite_;
  std::vector<std::vector<std::uint32_t>> first_;  ///< a tetrahedron of each face-connected fan of a vertex
};

}  // namespace retalho
