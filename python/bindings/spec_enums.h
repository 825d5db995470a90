// Names of the specs' enums in Python.
#pragma once

#include <string>
#include <string_view>

#include "robocell/spec/env_action.h"
#include "robocell/spec/randomize_config.h"
#include "robocell/spec/robot_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_object.h"
#include "robocell/spec/sim_options.h"
#include "robocell/spec/types.h"

namespace robocell::python {

// Converts "shared_base" to "SHARED_BASE".
std::string UpperCase(std::string_view name);
// Converts "shared_base" to "SharedBase".
std::string CamelCase(std::string_view name);

template <HasEnumNames E>
inline constexpr const char* kEnumName = nullptr;
template <>
inline constexpr const char* kEnumName<AttachKind> = "AttachKind";
template <>
inline constexpr const char* kEnumName<ElementKind> = "ElementKind";
template <>
inline constexpr const char* kEnumName<Shape> = "Shape";
template <>
inline constexpr const char* kEnumName<Condim> = "Condim";
template <>
inline constexpr const char* kEnumName<Integrator> = "Integrator";
template <>
inline constexpr const char* kEnumName<FrictionCone> = "FrictionCone";
template <>
inline constexpr const char* kEnumName<Solver> = "Solver";
template <>
inline constexpr const char* kEnumName<JacobianKind> = "JacobianKind";
template <>
inline constexpr const char* kEnumName<BaseKind> = "BaseKind";
template <>
inline constexpr const char* kEnumName<MoveGroupKind> = "MoveGroupKind";
template <>
inline constexpr const char* kEnumName<TaskSpaceKind> = "TaskSpaceKind";
template <>
inline constexpr const char* kEnumName<ControlKind> = "ControlKind";
template <>
inline constexpr const char* kEnumName<CtrlMode> = "CtrlMode";
template <>
inline constexpr const char* kEnumName<Keep> = "Keep";
template <>
inline constexpr const char* kEnumName<RenderWhen> = "RenderWhen";
template <>
inline constexpr const char* kEnumName<ControlMode> = "ControlMode";
template <>
inline constexpr const char* kEnumName<RelativeTo> = "RelativeTo";
template <>
inline constexpr const char* kEnumName<OnCollision> = "OnCollision";
template <>
inline constexpr const char* kEnumName<Relation> = "Relation";
template <>
inline constexpr const char* kEnumName<RandomizeEvery> = "RandomizeEvery";

}  // namespace robocell::python
