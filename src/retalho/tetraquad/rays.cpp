#include "retalho/tetraquad/rays.h"

#include <cmath>

#include "retalho/tetraquad/ray_tree.h"

namespace retalho {

struct TetraQuadRays::Parts {
  RayTree tree;
  RayScene scene;
  RayWalk walk;
  Vec3 origin;       ///< of the lattice
  double scale = 1;  ///< 1 / the grid's step
};

TetraQuadRays::TetraQuadRays(const TetraQuadField& field, int halvings, const Context& context)
    : parts_(std::make_unique<Parts>()) {
  parts_->tree = make_ray_tree(field, halvings, context);
  parts_->scene = parts_->tree.scene();
  parts_->walk = ray_walk();
  parts_->origin = field.surface().mesh.origin;
  parts_->scale = 1 / field.surface().mesh.step;
}

TetraQuadRays::~TetraQuadRays() = default;
TetraQuadRays::TetraQuadRays(TetraQuadRays&&) noexcept = default;
TetraQuadRays& TetraQuadRays::operator=(TetraQuadRays&&) noexcept = default;

std::size_t TetraQuadRays::size() const {
  return parts_->tree.prims.size();
}

std::optional<TetraQuadRays::Hit> TetraQuadRays::first(Vec3 origin, Vec3 direction, double from, double to) const {
  // Along the ray, steps of the grid are counted.
  const Vec3 o = parts_->scale * (origin - parts_->origin) - parts_->tree.middle;
  const double length = norm(direction);
  if (!(length > 0) || !std::isfinite(length) || !std::isfinite(o.x + o.y + o.z) || parts_->tree.prims.empty())
    return {};
  const Vec3 d = (1 / length) * direction;
  const double scale = length * parts_->scale;
  RayQuery query{{o.x, o.y, o.z}, {d.x, d.y, d.z}, from * scale, to * scale, -1, {}};
  parts_->walk(parts_->scene, query);
  if (query.prim < 0) return {};
  return Hit{query.to / scale,
             parts_->tree.prims[static_cast<std::size_t>(query.prim)].tet,
             {query.b[0], query.b[1], query.b[2], query.b[3]}};
}

}  // namespace retalho
