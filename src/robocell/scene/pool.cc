#include "robocell/scene/pool.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

constexpr double kParkingHeight = 1000;  // metres; images end at 100
constexpr double kParkingSpace = 10;

// Bodies of a subtree are contiguous, and so are their geoms, joints and degrees of freedom.
int LastOfSubtree(const mjModel* m, int root) {
  int last = root;
  while (last + 1 < m->nbody && IsInSubtree(m, last + 1, root)) ++last;
  return last;
}

// Returns true for contact masks of a parked object.
bool IsSwitchedOff(std::span<const int> contype, std::span<const int> conaffinity,
                   std::span<const mjtNum> gravcomp) {
  const auto none = [](int mask) { return mask == 0; };
  return std::all_of(contype.begin(), contype.end(), none) &&
         std::all_of(conaffinity.begin(), conaffinity.end(), none) &&
         std::all_of(gravcomp.begin(), gravcomp.end(), [](mjtNum share) { return share == 1; });
}

}  // namespace

FreeJointPos ParkingPlace(size_t object) {
  return {kParkingSpace * static_cast<double>(object), 0, kParkingHeight, 1, 0, 0, 0};
}

PooledObject::PooledObject(const mjModel* m, const ObjectRecord& record, size_t number)
    : parked(record.pool && record.pool->parked), record_(&record), place_(ParkingPlace(number)) {
  const int root = FindId(m, mjOBJ_BODY, record.root_body), last = LastOfSubtree(m, root);
  bodies_ = {root, last - root + 1};
  for (int b = root; b <= last; ++b) {
    if (m->body_geomnum[b] > 0 && geoms_.count == 0) geoms_.first = m->body_geomadr[b];
    geoms_.count += m->body_geomnum[b];
    dofs_.count += m->body_dofnum[b];
  }
  const int joint = m->body_jntadr[root];  // the free one, which is always alone
  qpos_.first = m->jnt_qposadr[joint];
  dofs_.first = m->jnt_dofadr[joint];
  int next = joint;
  while (next < m->njnt && m->jnt_bodyid[next] <= last) ++next;
  qpos_.count = (next < m->njnt ? m->jnt_qposadr[next] : static_cast<int>(m->nq)) - qpos_.first;
  for (int a = 0; a < m->nactuator; ++a) {
    const int body = BodyOfActuator(m, a);
    if (body >= root && body <= last) actuators_.push_back(a);
  }
}

bool PooledObject::IsParkedAt(const mjtNum* qpos) const {
  return std::abs(qpos[qpos_.first + 2] - place_[2]) < kParkingSpace / 2;
}

void PooledObject::Switch(mjModel* m, bool off) const {
  const PoolRecord& inside = *record_->pool;
  for (int i = 0; i < geoms_.count; ++i) {
    m->geom_contype[geoms_.first + i] = off ? 0 : inside.contype[i];
    m->geom_conaffinity[geoms_.first + i] = off ? 0 : inside.conaffinity[i];
  }
  for (int i = 0; i < bodies_.count; ++i) {
    const int body = bodies_.first + i, geom = m->body_geomadr[body];
    m->body_gravcomp[body] = off ? 1 : inside.gravcomp[i];
    m->body_contype[body] = m->body_conaffinity[body] = 0;
    for (int g = geom; g < geom + m->body_geomnum[body]; ++g) {
      m->body_contype[body] |= m->geom_contype[g];
      m->body_conaffinity[body] |= m->geom_conaffinity[g];
    }
  }
  CountCompensatedBodies(m);
  m->flg_gravcomp = true;
}

bool PooledObject::IsAsAfterReset(const mjModel* m) const {
  const PoolRecord& inside = *record_->pool;
  if (IsSwitchedOff(inside.contype, inside.conaffinity, inside.gravcomp)) return true;
  const auto geoms = static_cast<size_t>(geoms_.count);
  const bool off = IsSwitchedOff({m->geom_contype + geoms_.first, geoms},
                                 {m->geom_conaffinity + geoms_.first, geoms},
                                 {m->body_gravcomp + bodies_.first, inside.gravcomp.size()});
  return off == inside.parked;
}

void PooledObject::Put(const mjModel* m, mjData* d, int home_key, const mjtNum* pos) const {
  const mjtNum* home = m->key_qpos + home_key * m->nq;
  std::copy_n(home + qpos_.first, qpos_.count, d->qpos + qpos_.first);
  std::copy_n(pos, 7, d->qpos + qpos_.first);
  for (mjtNum* values : {d->qvel, d->qacc_warmstart, d->qfrc_applied})
    std::fill_n(values + dofs_.first, dofs_.count, 0.0);
  std::fill_n(d->xfrc_applied + 6 * bodies_.first, 6 * bodies_.count, 0.0);
  for (const int a : actuators_) {
    const int ctrl = m->actuator_ctrladr[a], act = m->actuator_actadr[a];
    std::copy_n(m->key_ctrl + home_key * m->nu + ctrl, m->actuator_ctrlnum[a], d->ctrl + ctrl);
    if (act >= 0)
      std::copy_n(m->key_act + home_key * m->na + act, m->actuator_actnum[a], d->act + act);
  }
}

PoolRecord ReadPoolRecord(const mjModel* m, const ObjectRecord& record, bool parked) {
  PoolRecord inside{.parked = parked};
  const int root = FindId(m, mjOBJ_BODY, record.root_body), last = LastOfSubtree(m, root);
  for (int b = root; b <= last; ++b) {
    inside.gravcomp.push_back(m->body_gravcomp[b]);
    for (int g = m->body_geomadr[b]; g < m->body_geomadr[b] + m->body_geomnum[b]; ++g) {
      inside.contype.push_back(m->geom_contype[g]);
      inside.conaffinity.push_back(m->geom_conaffinity[g]);
    }
  }
  return inside;
}

std::vector<PooledObject> PoolOf(const CompiledScene& compiled) {
  std::vector<PooledObject> pool;
  for (size_t i = 0; i < compiled.objects().size(); ++i) {
    if (compiled.objects()[i].pool) pool.emplace_back(compiled.model(), compiled.objects()[i], i);
  }
  return pool;
}

void CountCompensatedBodies(mjModel* m) {
  m->ngravcomp = m->nbody - std::count(m->body_gravcomp, m->body_gravcomp + m->nbody, 0.0);
}

}  // namespace robocell::internal
