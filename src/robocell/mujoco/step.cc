#include "robocell/mujoco/step.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cmath>

#include "robocell/base/small_arrays.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"

namespace robocell {
namespace {

bool AllGood(const mjtNum* x, int n) { return AllWithin(mjMAXVAL, x, static_cast<size_t>(n)); }

int FirstBad(const mjtNum* x, int n) {
  for (int i = 0; i < n; ++i) {
    if (!(std::abs(x[i]) <= mjMAXVAL)) return i;
  }
  return -1;
}

bool TimeAdvanced(const mjModel* model, const mjData* data, double before) {
  const double moved = data->time - before;
  return moved > 0 && moved < 1.5 * model->opt.timestep;
}

int JointOfPosition(const mjModel* model, int index) {
  int joint = static_cast<int>(model->njnt) - 1;
  while (joint > 0 && model->jnt_qposadr[joint] > index) --joint;
  return joint;
}

struct BadValue {
  const char* quantity = nullptr;
  int joint = -1;
  double value = 0;
};

// The engine notes the first bad number it meets; by the end of the step the solver has spread it
// to other joints.
int NotedByEngine(const mjData* d, const EngineWarnings& before, mjtWarning kind) {
  return d->warning[kind].number > before.count(kind) ? d->warning[kind].lastinfo : -1;
}

BadValue Value(const mjModel* m, const char* quantity, int dof, const mjtNum* x) {
  return {quantity, m->dof_jntid[dof], x[dof]};
}

BadValue FindBadValue(const mjModel* m, const mjData* d, const EngineWarnings& before) {
  const int nq = static_cast<int>(m->nq), nv = static_cast<int>(m->nv);
  auto position = [&](int i) { return BadValue{"position", JointOfPosition(m, i), d->qpos[i]}; };
  if (int i = NotedByEngine(d, before, mjWARN_BADQPOS); i >= 0) return position(i);
  if (int i = NotedByEngine(d, before, mjWARN_BADQVEL); i >= 0)
    return Value(m, "velocity", i, d->qvel);
  if (int i = NotedByEngine(d, before, mjWARN_BADQACC); i >= 0)
    return Value(m, "acceleration", i, d->qacc);
  if (int i = FirstBad(d->qpos, nq); i >= 0) return position(i);
  if (int i = FirstBad(d->qvel, nv); i >= 0) return Value(m, "velocity", i, d->qvel);
  if (int i = FirstBad(d->qacc, nv); i >= 0) return Value(m, "acceleration", i, d->qacc);
  return {};
}

std::string Explain(const mjModel* model, const mjData* data, const StepStart& start,
                    const BadValue& bad) {
  std::string text = fmt::format("diverged at t={:.6g} s: ", start.time);
  if (bad.quantity) {
    const std::string joint = Describe(model, mjOBJ_JOINT, bad.joint);
    text += fmt::format("{} of {} ", bad.quantity, joint);
    // After a reset by the engine the value itself is gone.
    text +=
        std::abs(bad.value) <= mjMAXVAL ? "was a bad number" : fmt::format("is {:.4g}", bad.value);
  }
  if (!TimeAdvanced(model, data, start.time)) {
    text += fmt::format("{}time went to {:.6g} s in one step of {:.6g} s", bad.quantity ? ", " : "",
                        data->time, model->opt.timestep);
  }
  const std::string warnings = (ReadWarnings(data) - start.warnings).Text();
  return warnings.empty() ? text : text + " (engine warnings: " + warnings + ")";
}

}  // namespace

StepStart BeginStep(const mjData* data) { return {data->time, ReadWarnings(data)}; }

bool HasDiverged(const mjModel* m, const mjData* d, const StepStart& start) {
  const int nq = static_cast<int>(m->nq), nv = static_cast<int>(m->nv);
  return !(AllGood(d->qpos, nq) && AllGood(d->qvel, nv) && AllGood(d->qacc, nv) &&
           TimeAdvanced(m, d, start.time));
}

StepResult Diverged(const mjModel* model, const mjData* data, const StepStart& start, int steps) {
  const BadValue bad = FindBadValue(model, data, start.warnings);
  StepResult result;
  result.status = StepResult::kDiverged;
  result.steps = steps;
  result.time = start.time;
  result.joint = bad.joint;
  if (bad.joint >= 0) result.joint_name = ElementName(model, mjOBJ_JOINT, bad.joint);
  result.message = Explain(model, data, start, bad);
  return result;
}

StepResult Step(const mjModel* model, mjData* data, int n, std::string_view context) {
  int steps = 0;
  StepStart start;
  bool diverged = false;
  internal::Guarded(context, data, [&] {
    while (steps < n && !diverged) {
      start = BeginStep(data);
      mj_step(model, data);
      ++steps;
      diverged = HasDiverged(model, data, start);
    }
  });
  StepResult result;  // made once, directly in the caller's object
  if (diverged) {
    result = Diverged(model, data, start, steps);
  } else {
    result.steps = steps;
    result.time = data->time;
  }
  return result;
}

void Forward(const mjModel* model, mjData* data, std::string_view context) {
  internal::Guarded(context, data, [&] { mj_forward(model, data); });
}

}  // namespace robocell
