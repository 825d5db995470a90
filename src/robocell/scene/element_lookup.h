// Finds elements of a robot in a compiled model, by the names that its configuration uses (without
// the robot's prefix).
//
//   const ElementId leaf = FindElement(model, robot, *group.leaf, {mjOBJ_SITE, mjOBJ_BODY});
//
// Throws NotFoundError "robot 'left': no site 'link_tpc'. Its sites: ... Did you mean 'link_tcp'?".
#pragma once

#include <mujoco/mjtype.h>

#include <initializer_list>
#include <string>
#include <vector>

#include "robocell/mujoco/forward.h"
#include "robocell/scene/compiled_scene.h"
#include "robocell/spec/element_ref.h"

namespace robocell::internal {

struct ElementId {
  mjtObj kind = mjOBJ_UNKNOWN;
  int id = -1;
};

// Finds a named element among the kinds in order (only the ref's own kind if it has one), or the
// index-th element of its kind directly in a body (for bodies: its child bodies).
ElementId FindElement(const mjModel* model, const RobotRecord& robot, const ElementRef& ref,
                      std::initializer_list<mjtObj> kinds);

// Returns the id of the robot's element of this kind and name.
int FindElement(const mjModel* model, const RobotRecord& robot, mjtObj kind,
                const std::string& name);

// Returns the names, without the prefix, of the robot's elements of a kind: elements of the bodies
// below its base, and actuators and sensors that have its prefix.
std::vector<std::string> RobotElementNames(const mjModel* model, const RobotRecord& robot,
                                           mjtObj kind);

// Convert between the engine's kind and the spec's.
mjtObj EngineKind(ElementKind kind);

// Returns a hint for a failed look-up in a model that leaves `count` elements of this kind unnamed,
// the first of them in `body`: " 9 have no name; write for example {geom: {body: palm, index: 0}}".
std::string UnnamedHint(std::string_view kind, size_t count, const std::string& body);

}  // namespace robocell::internal
