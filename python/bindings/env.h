// What the bindings of environments share.
#pragma once

#include <array>

#include "bindings.h"
#include "robocell/env/env.h"
#include "robocell/env/env_batch.h"

namespace robocell::python {

// "environment 'duo'", "batch of environment 'duo'".
std::string Place(const Env& env);
std::string Place(const EnvBatch& batch);

// The numbers of an ArmMotion by their keys in infos.
struct MotionField {
  const char* name;
  double ArmMotion::*value;
};
inline constexpr std::array kMotionFields = {
    MotionField{"joint_error", &ArmMotion::joint_error},
    MotionField{"joint_speed", &ArmMotion::joint_speed},
    MotionField{"position_error", &ArmMotion::position_error},
    MotionField{"rotation_error", &ArmMotion::rotation_error},
    MotionField{"linear_speed", &ArmMotion::linear_speed},
    MotionField{"angular_speed", &ArmMotion::angular_speed},
    MotionField{"position_shortfall", &ArmMotion::position_shortfall},
    MotionField{"rotation_shortfall", &ArmMotion::rotation_shortfall},
    MotionField{"joint_taken_back", &ArmMotion::joint_taken_back},
    MotionField{"position_taken_back", &ArmMotion::position_taken_back},
    MotionField{"rotation_taken_back", &ArmMotion::rotation_taken_back}};

// The last observation, as dictionaries of copies.
nb::dict Observation(const Env& env);

// ((path, begin, size), ...) of a vector's parts: where a path leads to in dictionaries.
nb::tuple ActionParts(const EnvLayout& layout);
nb::tuple ObservationParts(const EnvLayout& layout);

// The Python object of its task, for the collector; null for other tasks, and while something else
// in C++ shares that reference.
PyObject* TargetOfTask(const Env& env);

// "world" or "root". Raises for anything else.
StateFrame ToStateFrame(const std::string& text);

// EnvState, and what an environment does with it.
void BindEnvState(nb::module_& m);
void DefEnvState(nb::class_<Env>& env);

}  // namespace robocell::python
