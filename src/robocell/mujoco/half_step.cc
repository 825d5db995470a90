#include "robocell/mujoco/half_step.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "robocell/base/few_numbers.h"
#include "robocell/mujoco/guard.h"

namespace robocell {
namespace {

// Of what the first half reads and writes, enough to notice that somebody else was there: the
// state, and the results that follow from all of it.
struct StateNumbers {
  const mjtNum* at;
  size_t n;
};
std::array<StateNumbers, 5> NumbersOf(const mjModel* m, const mjData* d) {
  const auto nq = static_cast<size_t>(m->nq), nv = static_cast<size_t>(m->nv);
  const auto nmocap = static_cast<size_t>(m->nmocap);
  return {{{d->qpos, nq},
           {d->qvel, nv},
           {d->qfrc_bias, nv},
           {d->mocap_pos, 3 * nmocap},
           {d->mocap_quat, 4 * nmocap}}};
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
  unsolved_ = true;
}

void HalfStep::SolveContacts(const mjModel* model, mjData* data, std::string_view context) {
  unsolved_ = unsolved_ && data == data_ && data->time == time_;
  if (!unsolved_) return;
  Begin(model, data, context);
  const std::array<std::span<mjtNum>, 5> others = {
      {{data->qacc_warmstart, static_cast<size_t>(model->nv)},
       {data->qacc, static_cast<size_t>(model->nv)},
       {data->qfrc_actuator, static_cast<size_t>(model->nv)},
       {data->actuator_force, static_cast<size_t>(model->nout)},
       {data->act_dot, static_cast<size_t>(model->na)}}};
  kept_.clear();
  for (const auto& values : others) kept_.insert(kept_.end(), values.begin(), values.end());
  Guarded(context, data, [&] {
    mj_fwdActuation(model, data);
    mj_fwdAcceleration(model, data);
    mj_fwdConstraint(model, data);
  });
  const mjtNum* from = kept_.data();
  for (const auto& values : others) {
    std::copy_n(from, values.size(), values.begin());
    from += values.size();
  }
}

bool HalfStep::Take(const mjModel* model, mjData* data, StepStart* start) {
  unsolved_ = false;  // a step follows
  if (!begun_) return false;
  begun_ = false;
  if (!can_go_on_ || HasCallbacks() || !IsAsLeft(model, data)) return false;
  Unmark(data);
  *start = start_;
  return true;
}

bool HalfStep::IsAsLeft(const mjModel* model, const mjData* data) const {
  // Another model may be where a smaller one was.
  if (model != model_ || data != data_ || numbers_.size() != NumberOfNumbers(model)) return false;
  if (data->time != time_ || data->ncon != ncon_ || data->nefc != nefc_) return false;
  uint64_t other = !IsMarked(data);
  const mjtNum* at = numbers_.data();
  for (const StateNumbers& now : NumbersOf(model, data)) {
    other |= DifferenceOfFew(now.at, at, now.n * sizeof *at);
    at += now.n;
  }
  other |= DifferenceOfFew(options_.data(), &model->opt, sizeof(mjOption));
  other |= DifferenceOfFew(are_active_.data(), data->eq_active, are_active_.size());
  return other == 0;
}

void HalfStep::Remember(const mjModel* model, mjData* data) {
  model_ = model;
  data_ = data;
  time_ = data->time;
  ncon_ = data->ncon;
  nefc_ = data->nefc;
  numbers_.resize(NumberOfNumbers(model));
  mjtNum* at = numbers_.data();
  for (const StateNumbers& now : NumbersOf(model, data)) {
    CopyFew(now.at, now.n * sizeof *at, at);
    at += now.n;
  }
  options_.resize(sizeof(mjOption));
  CopyFew(&model->opt, sizeof(mjOption), options_.data());
  are_active_.resize(static_cast<size_t>(model->neq));
  CopyFew(data->eq_active, are_active_.size(), are_active_.data());
  Mark(data);
}

}  // namespace robocell
