#include "retalho/tin/greedy_mesh.h"

#include <sys/mman.h>

#include <algorithm>
#include <new>

namespace retalho::greedy {
namespace {

constexpr int next(int k) {
  return k == 2 ? 0 : k + 1;
}
constexpr int previous(int k) {
  return k == 0 ? 2 : k - 1;
}

}  // namespace

void Cavity::grow() {
  for (auto* list : {&ring, &outside, &removed, &made, &stack}) list->resize(2 * list->size());
}

Mesh::Mesh(int columns, int rows, int quarter, const std::vector<Cell>& hull)
    : quarter_(quarter),
      quarters_across_((columns + quarter - 1) / quarter),
      wide_(std::max(columns, rows) > kNarrowSide) {
  const std::size_t quarters =
      static_cast<std::size_t>(quarters_across_) * static_cast<std::size_t>((rows + quarter - 1) / quarter);
  initial_ = static_cast<std::uint32_t>(hull.size() - 2);
  first_quarter_ = (initial_ + 127U) & ~127U;  // whole pages a quarter
  ids_a_quarter_ = static_cast<std::uint32_t>(2 * quarter * quarter);
  used_.assign(quarters, 0);
  const std::size_t ids = first_quarter_ + quarters * ids_a_quarter_;
  if (ids >= (std::size_t{1} << 30)) throw TooManyCells();  // a link holds 30 bits of id
  bytes_ = ids * sizeof(Record);
  void* memory = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  records_ = static_cast<Record*>(memory);
  for (std::uint32_t i = 0; i < initial_; ++i) {  // a fan of the hull
    Record& t = records_[i];
    t.corner[0] = hull[0];
    t.corner[1] = hull[i + 1];
    t.corner[2] = hull[i + 2];
    t.link[0] = i > 0 ? (i - 1) << 2 | 2 : kNone;
    t.link[1] = kNone;
    t.link[2] = i + 1 < initial_ ? (i + 1) << 2 : kNone;
    t.error = 0;
  }
  make_delaunay(initial_);
}

Mesh::~Mesh() {
  ::munmap(records_, bytes_);
}

void Mesh::make_delaunay(std::uint32_t count) {
  for (bool changed = true; changed;) {  // a few dozen triangles: plain flips will do
    changed = false;
    for (std::uint32_t i = 0; i < count; ++i)
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t link = records_[i].link[k];
        if (link == kNone) continue;
        Record &a = records_[i], &b = records_[link >> 2];
        const std::uint32_t j = link >> 2;
        const int m = static_cast<int>(link & 3U);
        const Cell u = a.corner[k], v = a.corner[next(k)], p = a.corner[previous(k)], q = b.corner[previous(m)];
        if (!in_circle(v, u, q, p)) continue;
        const std::uint32_t vp = a.link[next(k)], pu = a.link[previous(k)], uq = b.link[next(m)],
                            qv = b.link[previous(m)];
        a = {{p, u, q}, {pu, uq, j << 2}, 0, 0};
        b = {{p, q, v}, {i << 2 | 2, qv, vp}, 0, 0};
        const auto relink = [&](std::uint32_t outside, std::uint32_t to) {
          if (outside != kNone) records_[outside >> 2].link[outside & 3U] = to;
        };
        relink(pu, i << 2);
        relink(uq, i << 2 | 1);
        relink(qv, j << 2 | 1);
        relink(vp, j << 2 | 2);
        changed = true;
      }
  }
}

template <class Wide>
bool Mesh::open_as(std::uint32_t t, Cell p, const Square* within, Cavity& cavity) const {
  const int x = column_of(p), y = row_of(p);
  int ring = 0, removed = 0, depth = 0;
  cavity.opening = -1;
  const Record& start = records_[t];
  if (within && !(within->holds(start.corner[0]) && within->holds(start.corner[1]) && within->holds(start.corner[2])))
    return false;
  cavity.removed[removed++] = t;
  for (const std::uint32_t k : {2U, 1U, 0U}) cavity.stack[depth++] = t << 2 | k;
  while (depth > 0) {  // depth first, so that the ring comes out in order
    const std::uint32_t half = cavity.stack[--depth];
    const Record& inside = records_[half >> 2];
    const int k = static_cast<int>(half & 3U);
    const std::uint32_t link = inside.link[k];
    const Cell a = inside.corner[k], b = inside.corner[next(k)];
    const std::int64_t ax = column_of(a) - x, ay = row_of(a) - y, bx = column_of(b) - x, by = row_of(b) - y;
    if (link == kNone) {
      if (ax * by == ay * bx) cavity.opening = ring;
      cavity.ring[ring] = a;
      cavity.outside[ring++] = kNone;
      continue;
    }
    const Record& beyond = records_[link >> 2];
    const int m = static_cast<int>(link & 3U);
    const Cell apex = beyond.corner[previous(m)];
    if (in_circle<Wide>(bx, by, ax, ay, column_of(apex) - x, row_of(apex) - y)) {
      if (within && !within->holds(apex)) return false;
      cavity.removed[removed++] = link >> 2;
      cavity.stack[depth++] = (link & ~3U) | static_cast<std::uint32_t>(previous(m));
      cavity.stack[depth++] = (link & ~3U) | static_cast<std::uint32_t>(next(m));
    } else {
      cavity.ring[ring] = a;
      cavity.outside[ring++] = link;
    }
    if (std::max({ring, removed, depth}) + 4 >= cavity.room()) cavity.grow();
  }
  cavity.ring_size = ring;
  cavity.removed_size = removed;
  return true;
}

bool Mesh::open(std::uint32_t t, Cell p, const Square* within, Cavity& cavity) const {
  return wide_ ? open_as<__int128>(t, p, within, cavity) : open_as<std::int64_t>(t, p, within, cavity);
}

void Mesh::fill(Cell p, Cavity& cavity) {
  int made = cavity.ring_size;
  const int corners = made;
  const bool border = cavity.opening >= 0;
  if (border) {  // the fan opens at the border edge that p lies on
    for (auto* list : {&cavity.ring, &cavity.outside})
      std::rotate(list->begin(), list->begin() + cavity.opening + 1, list->begin() + corners);
    --made;
  }
  const std::size_t quarter =
      static_cast<std::size_t>(row_of(p) / quarter_) * static_cast<std::size_t>(quarters_across_) +
      static_cast<std::size_t>(column_of(p) / quarter_);
  for (int i = 0; i < made; ++i)
    cavity.made[i] = i < cavity.removed_size
                         ? cavity.removed[i]
                         : first_quarter_ + static_cast<std::uint32_t>(quarter) * ids_a_quarter_ + used_[quarter]++;
  cavity.made_size = made;
  for (int i = 0; i < made; ++i) {
    const std::uint32_t id = cavity.made[i];
    Record& t = records_[id];
    t.corner[0] = p;
    t.corner[1] = cavity.ring[i];
    t.corner[2] = cavity.ring[i + 1 < corners ? i + 1 : 0];
    t.link[0] = i > 0 ? cavity.made[i - 1] << 2 | 2 : (border ? kNone : cavity.made[made - 1] << 2 | 2);
    t.link[1] = cavity.outside[i];
    if (cavity.outside[i] != kNone) records_[cavity.outside[i] >> 2].link[cavity.outside[i] & 3U] = id << 2 | 1;
    t.link[2] = i + 1 < made ? cavity.made[i + 1] << 2 : (border ? kNone : cavity.made[0] << 2);
  }
}

std::size_t Mesh::triangle_count() const {
  std::size_t n = initial_;
  for (const std::uint32_t u : used_) n += u;
  return n;
}

void Mesh::block(std::size_t index, std::uint32_t& first, std::uint32_t& last) const {
  if (index == 0) {
    first = 0;
    last = initial_;
  } else {
    first = first_quarter_ + static_cast<std::uint32_t>(index - 1) * ids_a_quarter_;
    last = first + used_[index - 1];
  }
}

}  // namespace retalho::greedy
