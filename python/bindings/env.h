// The common part of the bindings of environments.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bindings.h"
#include "robocell/env/env.h"
#include "robocell/env/env_batch.h"

namespace robocell::python {

// Returns "environment 'duo'" or "batch of environment 'duo'".
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

// Returns ids of bodies in the form of observations: -1 where there is no surface.
std::vector<int32_t> BodyIds(std::span<const uint16_t> segments);

// Returns the last observation, as dictionaries of copies.
nb::dict Observation(const Env& env);

// Returns ((path, begin, size), ...) of a vector's parts: the place of each path of the
// dictionaries.
nb::tuple ActionParts(const EnvLayout& layout);
nb::tuple ObservationParts(const EnvLayout& layout);

// Returns the Python object of its task, for the garbage collector; null for other tasks, and while
// another C++ object shares that reference.
PyObject* TargetOfTask(const Env& env);
// Visits what an environment keeps of Python's, for tp_traverse of its owner: its task, and the
// node of its scene, whose hooks may refer to the environment.
int VisitEnv(const Env& env, visitproc visit, void* arg);

// Converts "world" or "root". Raises for anything else.
StateFrame ToStateFrame(const std::string& text);

// EnvState, and the functions of an environment that use it.
void BindEnvState(nb::module_& m);
void DefEnvState(nb::class_<Env>& env);

}  // namespace robocell::python
