#include "robocell/mujoco/half_step.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "robocell/mujoco/guard.h"

namespace robocell {
namespace {

// Of what the first half reads and writes, enough to notice that somebody else was there: the
// state, and the results that follow from all of it.
template <class Visit>
void ForNumbers(const mjModel* m, const mjData* d, Visit visit) {
  visit(d->qpos, m->nq);
  visit(d->qvel, m->nv);
  visit(d->qfrc_bias, m->nv);
  visit(d->mocap_pos, 3 * m->nmocap);
  visit(d->mocap_quat, 4 * m->nmocap);
}

size_t NumberOfNumbers(const mjModel* m) {
  return static_cast<size_t>(m->nq + 2 * m->nv + 7 * m->nmocap);
}

// The world's position, 0: every computation of poses writes it anew. What is left there is a mark,
// 0 as well, that poses are still those of the first half.
void Mark(mjData* d) { d->xpos[0] = -0.0; }
void Unmark(mjData* d) { d->xpos[0] = 0; }
bool IsMarked(const mjData* d) { return d->xpos[0] == 0 && std::signbit(d->xpos[0]); }

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

bool HalfStep::Take(const mjModel* model, mjData* data, StepStart* start) {
  if (!begun_) return false;
  begun_ = false;
  if (!can_go_on_ || HasCallbacks() || !IsAsLeft(model, data)) return false;
  Unmark(data);
  *start = start_;
  return true;
}

// In place: calls for so few numbers each would take longer than what they compare or copy.
bool HalfStep::IsAsLeft(const mjModel* model, const mjData* data) const {
  // Another model may be where a smaller one was.
  if (model != model_ || numbers_.size() != NumberOfNumbers(model)) return false;
  if (data->time != time_ || data->ncon != ncon_ || data->nefc != nefc_) return false;
  uint64_t other = !IsMarked(data);
  const mjtNum* at = numbers_.data();
  ForNumbers(model, data, [&](const mjtNum* now, mjtSize n) {
    for (mjtSize i = 0; i < n; ++i)
      other |= std::bit_cast<uint64_t>(now[i]) ^ std::bit_cast<uint64_t>(at[i]);
    at += n;
  });
  return other == 0 && std::memcmp(options_.data(), &model->opt, sizeof(mjOption)) == 0 &&
         std::equal(are_active_.begin(), are_active_.end(), data->eq_active,
                    data->eq_active + model->neq);
}

void HalfStep::Remember(const mjModel* model, mjData* data) {
  model_ = model;
  time_ = data->time;
  ncon_ = data->ncon;
  nefc_ = data->nefc;
  numbers_.resize(NumberOfNumbers(model));
  mjtNum* at = numbers_.data();
  ForNumbers(model, data, [&](const mjtNum* now, mjtSize n) {
    for (mjtSize i = 0; i < n; ++i) at[i] = now[i];
    at += n;
  });
  options_.resize(sizeof(mjOption));
  std::memcpy(options_.data(), &model->opt, sizeof(mjOption));
  are_active_.assign(data->eq_active, data->eq_active + model->neq);
  Mark(data);
}

}  // namespace robocell
