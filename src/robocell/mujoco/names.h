// Names and ids of a compiled model's elements. Look-ups are exact; a failed one lists the existing
// names and the nearest one.
//
//   const int joint = RequireId(model, mjOBJ_JOINT, "joint1", "scene 'pick'");
//   for (const std::string& name : ElementNames(model, mjOBJ_BODY)) ...
//
// Elements need no name in MuJoCo: ElementNames has "" for these, and Describe names their body
// instead. Do not look names up in loops: resolve once, keep the id. All functions may be called
// from any thread.
#pragma once

#include <mujoco/mjtype.h>

#include <string>
#include <string_view>
#include <vector>

#include "robocell/mujoco/forward.h"

namespace robocell {

// Returns "joint", "camera", ...
const char* KindName(mjtObj kind);

// Returns the number of elements of this kind.
int ElementCount(const mjModel* model, mjtObj kind);

// Returns the names by id; "" for elements without a name.
std::vector<std::string> ElementNames(const mjModel* model, mjtObj kind);

// Returns "" for an element without a name.
std::string ElementName(const mjModel* model, mjtObj kind, int id);

// Returns -1 if there is none. An empty name finds nothing.
int FindId(const mjModel* model, mjtObj kind, std::string_view name);

// Throws NotFoundError("<place>: no joint 'joint8'. Its joints: joint1 ... joint7. Did you mean
// 'joint7'?").
int RequireId(const mjModel* model, mjtObj kind, std::string_view name, std::string_view place);

// Describes an element for messages: "joint 'joint1'", or without a name "geom 5 (unnamed, of body
// 'hand')".
std::string Describe(const mjModel* model, mjtObj kind, int id);

}  // namespace robocell
