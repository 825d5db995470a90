// Private to scene: reads and changes the tree of an mjSpec: element lists, names, and poses with
// everything resolved that an author may have used (frames around an element, Euler angles, axes).
//
// Poses are in the parent body unless a name indicates otherwise. Nothing here checks for null
// elements: the engine treats a null as a fatal error.
#pragma once

#include <mujoco/mujoco.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "robocell/math/pose.h"

namespace robocell::internal {

// Returns every element of a kind, in the engine's order.
std::vector<mjsElement*> SpecElements(const mjSpec* spec, mjtObj kind);
// Returns "" for an element without a name.
std::string SpecName(mjsElement* element);
// Returns the names of a kind, without unnamed elements.
std::vector<std::string> SpecNames(const mjSpec* spec, mjtObj kind);
// Returns "light 'lamp'"; "light 1 (unnamed, of body 'hand')" for the second light of that body,
// "light 1 (unnamed)" in the world.
std::string DescribeSpecElement(mjsElement* element);
void SetSpecName(mjsElement* element, const std::string& name, const std::string& context);
// Returns elements of a kind directly in a body, or in its whole subtree.
std::vector<mjsElement*> BodyElements(mjsBody* body, mjtObj kind, bool whole_subtree = false);
// Returns the body's own free joint; null if it has none.
mjsElement* FreeJointOf(mjsBody* body);

// Returns the kind of the target of an actuator with this transmission; mjOBJ_UNKNOWN for kinds
// that robocell does not handle.
mjtObj TargetKind(mjtTrn transmission);

// Returns the named element, null if there is none. Frames are a kind like the others.
mjsElement* FindSpecElement(const mjSpec* spec, mjtObj kind, const std::string& name);
mjsBody* WorldBody(mjSpec* spec);

// Returns the pose of a body, site, geom, camera or frame as written, without the frames around it.
// Throws SpecError for a site with fromto.
Pose OwnPose(mjsElement* element);
// Returns the pose, in the body, of the frames around an element of the body.
Pose FramePoseInParent(mjsElement* element);
// Returns the pose in the parent body, including the frames around the element.
Pose PoseInParent(mjsElement* element);
// Returns the same in the world, with all joints at their reference.
Pose PoseInWorld(mjsElement* element);
// Returns true if neither the body nor any body above it can move (no joints, not a mocap body).
bool IsStatic(mjsBody* body);
// Returns the child of the world that a body hangs on.
mjsBody* TopBody(mjsBody* body);

// Sets a pose as position and quaternion; the author's other attributes of it are dropped.
template <class Placed>
void SetPose(Placed* element, const Pose& pose) {
  pose.ToWxyz(element->pos, element->quat);
  mjs_defaultOrientation(&element->alt);
}

// Replaces the ends (fromto) of a geom or site by the pose and size that the engine makes of them.
template <class Stretched>
void ResolveFromTo(Stretched* element) {
  if (std::isnan(element->fromto[0])) return;
  const double *from = element->fromto, *to = from + 3;
  double along[3];
  for (int i = 0; i < 3; ++i) {
    along[i] = from[i] - to[i];
    element->pos[i] = (from[i] + to[i]) / 2;
  }
  const double half_length = mju_normalize3(along) / 2;
  mju_quatZ2Vec(element->quat, along);
  mjs_defaultOrientation(&element->alt);
  const bool across = element->type == mjGEOM_BOX || element->type == mjGEOM_ELLIPSOID;
  if (across) element->size[1] = element->size[0];
  element->size[across ? 2 : 1] = half_length;
  element->fromto[0] = std::numeric_limits<double>::quiet_NaN();
}

// Attaches a copy of a body of another spec, with its subtree and all elements that refer to it, to
// a body. Its pose in the parent becomes `pose`. Throws SpecError with the engine's text if the
// engine rejects it.
void AttachBody(mjsBody* parent, mjsBody* child, const Pose& pose, const std::string& prefix,
                const std::string& context);

}  // namespace robocell::internal
