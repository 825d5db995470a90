#include "robocell/mujoco/half_step.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstring>

#include "robocell/mujoco/guard.h"

namespace robocell {
namespace {

// Of what the first half reads and writes, enough to notice that somebody else was there: the
// state, and the results that follow from all of it.
template <class Visit>
bool ForWatched(const mjModel* m, const mjData* d, Visit visit) {
  const auto numbers = [&](const mjtNum* x, mjtSize n) {
    return visit(x, sizeof(mjtNum) * static_cast<size_t>(n));
  };
  return numbers(d->qpos, m->nq) && numbers(d->qvel, m->nv) && numbers(d->xpos, 3 * m->nbody) &&
         numbers(d->qfrc_bias, m->nv) && visit(&m->opt, sizeof(m->opt)) &&
         (m->nmocap == 0 ||
          (numbers(d->mocap_pos, 3 * m->nmocap) && numbers(d->mocap_quat, 4 * m->nmocap))) &&
         (m->neq == 0 || visit(d->eq_active, sizeof(*d->eq_active) * static_cast<size_t>(m->neq)));
}

// What ForWatched visits when nothing stops it.
size_t WatchedSize(const mjModel* m) {
  const mjtSize numbers = m->nq + 2 * m->nv + 3 * m->nbody + 7 * m->nmocap;
  return sizeof(mjtNum) * static_cast<size_t>(numbers) + sizeof(m->opt) +
         sizeof(mjtBool) * static_cast<size_t>(m->neq);
}

bool HasCallbacks() {
  return mjcb_control || mjcb_passive || mjcb_sensor || mjcb_contactfilter || mjcb_act_dyn ||
         mjcb_act_gain || mjcb_act_bias;
}

bool SecondHalfIsTheRest(const mjModel* m) {
  const int integrator = m->opt.integrator;
  const bool known =
      integrator == mjINT_EULER || integrator == mjINT_IMPLICIT || integrator == mjINT_IMPLICITFAST;
  return known && m->nplugin == 0 && !(m->opt.enableflags & mjENBL_SLEEP) && !HasCallbacks();
}

}  // namespace

void HalfStep::Begin(const mjModel* model, mjData* data, std::string_view context) {
  if (begun_ && IsAsLeft(model, data)) return;
  begun_ = false;
  can_go_on_ = SecondHalfIsTheRest(model);
  start_ = BeginStep(data);
  const bool first_half = can_go_on_;
  Guarded(context, data, [&] {
    if (first_half) {
      mj_step1(model, data);
    } else {  // without mjcb_control, from which we may have been called
      mj_fwdPosition(model, data);
      mj_fwdVelocity(model, data);
    }
  });
  // Of contacts that have not been solved yet; what was there belongs to others.
  std::fill_n(data->efc_force, data->nefc, 0.0);
  Remember(model, data);
  begun_ = true;
  solved_ = false;
}

void HalfStep::SolveContacts(const mjModel* model, mjData* data, std::string_view context) {
  if (!begun_ || solved_ || !IsAsLeft(model, data)) return;
  warm_start_.assign(data->qacc_warmstart, data->qacc_warmstart + model->nv);
  Guarded(context, data, [&] {
    mj_fwdActuation(model, data);
    mj_fwdAcceleration(model, data);
    mj_fwdConstraint(model, data);
  });
  std::copy(warm_start_.begin(), warm_start_.end(), data->qacc_warmstart);
  solved_ = true;
}

bool HalfStep::Take(const mjModel* model, const mjData* data, StepStart* start) {
  if (!begun_) return false;
  begun_ = false;
  if (!can_go_on_ || HasCallbacks() || !IsAsLeft(model, data)) return false;
  *start = start_;
  return true;
}

bool HalfStep::IsAsLeft(const mjModel* model, const mjData* data) const {
  const std::byte* at = left_.data();
  // Another model may be where a smaller one was.
  if (model != model_ || left_.size() != WatchedSize(model)) return false;
  if (data->time != time_ || data->ncon != ncon_ || data->nefc != nefc_) return false;
  return ForWatched(model, data, [&](const void* now, size_t size) {
    const bool same = std::memcmp(at, now, size) == 0;
    at += size;
    return same;
  });
}

void HalfStep::Remember(const mjModel* model, const mjData* data) {
  model_ = model;
  time_ = data->time;
  ncon_ = data->ncon;
  nefc_ = data->nefc;
  left_.resize(WatchedSize(model));
  std::byte* at = left_.data();
  ForWatched(model, data, [&](const void* now, size_t size) {
    std::memcpy(at, now, size);
    at += size;
    return true;
  });
}

}  // namespace robocell
