#include "robocell/kinematics/chain_source.h"

#include <mujoco/mujoco.h>

#include <cstring>

#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {

ChainSource::ChainSource(const mjModel* m, const Chain& chain) : model_(m) {
  const int base = FindId(m, mjOBJ_BODY, chain.base_body());
  const int first = m->jnt_bodyid[chain.link_joints()[0].id];
  for (int body = m->body_parentid[first]; body != base; body = m->body_parentid[body])
    fixed_.push_back(body);
  bodies_ = {first, 0};
  while (first + bodies_.count < m->nbody && IsInSubtree(m, first + bodies_.count, first))
    ++bodies_.count;
  for (int joint = 0; joint < m->njnt; ++joint) {
    const int body = m->jnt_bodyid[joint];
    if (body < first || body >= first + bodies_.count) continue;
    if (joints_.count++ == 0) joints_.first = joint;
  }
  if (joints_.count > 0) {
    const int last = joints_.first + joints_.count;
    dofs_.first = m->jnt_dofadr[joints_.first];
    dofs_.count = (last < m->njnt ? m->jnt_dofadr[last] : m->nv) - dofs_.first;
    positions_.first = m->jnt_qposadr[joints_.first];
    positions_.count = (last < m->njnt ? m->jnt_qposadr[last] : m->nq) - positions_.first;
  }
  couplings_.count = chain.coupled() ? static_cast<int>(m->neq) : 0;
  if (chain.tip().kind == ChainTip::Kind::kSite) site_ = FindId(m, mjOBJ_SITE, chain.tip().name);
  VisitParts(m, [this](const void* values, size_t bytes) {
    const auto* begin = static_cast<const std::byte*>(values);
    numbers_.insert(numbers_.end(), begin, begin + bytes);
    return true;
  });
}

// Visits the numbers that chain_builder.cc reads.
template <class Visit>
bool ChainSource::VisitParts(const mjModel* m, Visit&& visit) const {
  const auto part = [&](const auto* values, int columns, const Range& rows) {
    const size_t bytes = sizeof(*values) * static_cast<size_t>(columns * rows.count);
    return bytes == 0 || visit(values + columns * rows.first, bytes);
  };
  for (const int body : fixed_) {
    if (!part(m->body_pos, 3, Range{body, 1}) || !part(m->body_quat, 4, Range{body, 1}))
      return false;
  }
  const Range site{site_ < 0 ? 0 : site_, site_ < 0 ? 0 : 1};
  const auto all = [](mjtSize count) { return Range{0, static_cast<int>(count)}; };
  return part(m->body_pos, 3, bodies_) && part(m->body_quat, 4, bodies_) &&
         part(m->body_ipos, 3, bodies_) && part(m->body_iquat, 4, bodies_) &&
         part(m->body_mass, 1, bodies_) && part(m->body_inertia, 3, bodies_) &&
         part(m->body_gravcomp, 1, bodies_) && part(m->jnt_pos, 3, joints_) &&
         part(m->jnt_axis, 3, joints_) && part(m->jnt_limited, 1, joints_) &&
         part(m->jnt_range, 2, joints_) && part(m->dof_armature, 1, dofs_) &&
         part(m->qpos0, 1, positions_) && part(m->site_pos, 3, site) &&
         part(m->site_quat, 4, site) &&
         part(m->nactuator > 0 ? Gears(m, 0) : nullptr, 6, all(m->nout)) &&
         part(m->actuator_armature, 1, all(m->nactuator)) &&
         part(m->tendon_armature, 1, all(m->ntendon)) && part(m->wrap_prm, 1, all(m->nwrap)) &&
         part(m->eq_active0, 1, all(m->neq)) && part(m->eq_data, mjNEQDATA, couplings_) &&
         visit(&m->opt.disableflags, sizeof m->opt.disableflags);
}

bool ChainSource::IsStale(const mjModel* m) const {
  if (m != model_ || numbers_.empty()) return false;
  const std::byte* at = numbers_.data();
  return !VisitParts(m, [&at](const void* values, size_t bytes) {
    const bool same = std::memcmp(at, values, bytes) == 0;
    at += bytes;
    return same;
  });
}

}  // namespace robocell::internal
