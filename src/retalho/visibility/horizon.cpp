#include "retalho/visibility/horizon.h"

#include <algorithm>
#include <cmath>

namespace retalho::visibility_detail {
namespace {

/// One of the two functions during the walk: its values at the present event.
struct Side {
  const std::vector<Knot>& knots;
  std::size_t next = 0;  // first knot not yet passed

  double next_s() const { return knots[next].s; }

  /// Limits at `s`, at or before the next knot.
  void values(double s, double& left, double& at, double& right) const {
    const Knot& b = knots[next];
    if (b.s == s) {
      left = b.left;
      at = b.at;
      right = b.right;
      return;
    }
    const Knot& a = knots[next - 1];
    left = at = right = a.right + (b.left - a.right) * ((s - a.s) / (b.s - a.s));
  }
};

/// Appends a knot; first drops the one before it when that lies on the straight line to the new one. Without this a
/// flat lake at eye level would gather every fraction j / k there is.
void emit(std::vector<Knot>& out, const Knot& knot) {
  if (out.size() >= 2) {
    const Knot& middle = out.back();
    if (middle.left == middle.at && middle.at == middle.right) {
      const Knot& first = out[out.size() - 2];
      const double span = knot.s - first.s;
      const double off = (middle.at - first.right) * span - (knot.left - first.right) * (middle.s - first.s);
      if (std::abs(off) <= 4e-16 * std::abs(middle.at) * span) out.pop_back();
    }
  }
  out.push_back(knot);
}

}  // namespace

void merge_horizons(const std::vector<Knot>& a, const std::vector<Knot>& b, std::vector<Knot>& out) {
  out.clear();
  Side sa{a}, sb{b};
  double before_a = 0, before_b = 0;  // limits just behind the event before
  Knot before{};                      // the knot of the event before, and whether it was kept
  bool kept = false;
  for (bool first = true; sb.next < b.size(); first = false) {
    const bool own_b = sa.next >= a.size() || sb.next_s() <= sa.next_s();
    const bool own_a = sa.next < a.size() && sa.next_s() <= sb.next_s();
    const double s = own_b ? sb.next_s() : sa.next_s();
    double la = kNothing, pa = kNothing, ra = kNothing, lb, pb, rb;
    if (sa.next < a.size()) sa.values(s, la, pa, ra);
    sb.values(s, lb, pb, rb);
    bool forced = false;
    if (!first) {
      const double d0 = before_a - before_b, d1 = la - lb;
      if ((d0 > 0 && d1 < 0) || (d0 < 0 && d1 > 0)) {
        const double t = d0 / (d0 - d1), cross_s = before.s + t * (s - before.s), h = before_a + t * (la - before_a);
        // A crossing that rounds to an end of the interval is a knot there: it must not be hidden.
        if (cross_s >= s)
          forced = true;
        else if (cross_s > before.s)
          emit(out, {cross_s, h, h, h});
        else if (!kept)
          emit(out, before);
      }
    }
    // A knot is left out only when the other function passes strictly above it; ties are kept whoever owns the knot.
    const bool hidden = own_a != own_b && (own_a ? (lb > la && pb > pa && rb > ra) : (la > lb && pa > pb && ra > rb));
    const Knot knot{s, std::max(la, lb), std::max(pa, pb), std::max(ra, rb)};
    const bool nothing = knot.left == kNothing && knot.at == kNothing && knot.right == kNothing;
    const bool last = own_b && sb.next + 1 == b.size();
    kept = first || last || forced || (!hidden && !nothing);
    if (kept) emit(out, knot);
    before_a = ra;
    before_b = rb;
    before = knot;
    if (own_a) ++sa.next;
    if (own_b) ++sb.next;
  }
}

}  // namespace retalho::visibility_detail
