// Names and ids of a compiled model's elements. Look-ups are exact; a miss lists what there is and
// the nearest name.
//
//   const int joint = RequireId(model, mjOBJ_JOINT, "joint1", "scene 'pick'");
//   for (const std::string& name : ElementNames(model, mjOBJ_BODY)) ...
//
// Elements need no name in MuJoCo: ElementNames has "" for these, Describe says what they belong to
// instead. Do not look names up in loops: resolve once, keep the id. All functions may be called
// from any thread.
#pragma once

#include <mujoco/mjtype.h>

#include <string>
#include <string_view>
#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell {

// "joint", "camera", ...
const char* KindName(mjtObj kind);

// How many elements of this kind the model has.
int ElementCount(const mjModel* model, mjtObj kind);

// Indexed by id; "" for elements without a name.
std::vector<std::string> ElementNames(const mjModel* model, mjtObj kind);

// "" for an element without a name.
std::string ElementName(const mjModel* model, mjtObj kind, int id);

// -1 when there is none. An empty name finds nothing.
int FindId(const mjModel* model, mjtObj kind, std::string_view name);

// Throws NotFoundError("<place>: no joint 'joint8'. Its joints: joint1 ... joint7. Did you mean
// 'joint7'?").
int RequireId(const mjModel* model, mjtObj kind, std::string_view name, std::string_view place);

// For messages: "joint 'joint1'", or for an element without a name "geom 5 (unnamed, of body
// 'hand')".
std::string Describe(const mjModel* model, mjtObj kind, int id);

}  // namespace robocell
