// Places for objects on a support: random, without overlap, upright with a random rotation.
#pragma once

#include <span>
#include <vector>
#include <Eigen/Geometry>

#include "robocell/base/rng.h"
#include "robocell/math/pose.h"
#include "robocell/mujoco/forward.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/support.h"
#include "robocell/spec/scene_object.h"

namespace robocell::internal {

inline constexpr double kObjectGap = 0.03;   // metres between objects
inline constexpr double kEdgeMargin = 0.03;  // distance from the support's edge

inline bool IsFixed(const SceneObject& object) { return object.fixed == true; }
// Returns true if an object stays where its spec puts it: it is fixed, or has a pose.
inline bool KeepsPose(const SceneObject& object) { return IsFixed(object) || object.has_pose(); }

// Removes the object's pose.
inline void ForgetPose(SceneObject& object) {
  object.pos.reset();
  object.euler = {};
  object.quat = kIdentityQuat;
}

// A box around something that stays where it is.
struct StillBox {
  Pose frame_to_world;  // of its middle
  Eigen::Vector3d half;
};
// Returns the box around a geom, whose pose is up to date; not for planes.
StillBox StillBoxOf(const mjModel* model, const mjData* data, int geom);
// Metres that are free above a support where an object stands: for a hand too, where there is such a
// place, and else for the object alone.
inline constexpr double kRoomAbove = 0.2, kGapAbove = 0.02;

// Something that stands on a support or hangs over it.
struct OverSupport {
  Eigen::AlignedBox2d outline;  // in the support's frame
  double bottom;                // metres above it
};
std::vector<OverSupport> FindOver(const Support& support, std::span<const StillBox> boxes);

// Sets the poses of objects; `sizes` are theirs, in the same order. Those with a pose keep it, and
// the others keep clear of them and of what is `over` the support: of what hangs lower than
// kRoomAbove, or than the object needs if that is more. An object without such a place is put where
// just itself fits. False when no place was found for one of them; the objects before it have been
// moved.
bool PlaceOn(const Support& support, std::span<const ObjectSize> sizes,
             std::vector<SceneObject>& objects, Rng& rng, std::span<const OverSupport> over = {});

}  // namespace robocell::internal
