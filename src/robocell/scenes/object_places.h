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
inline constexpr double kRoomAbove = 0.2;  // metres that an object has above its support
// Returns the rectangles of a support, in its frame, on which something stands, or above which
// something hangs lower than kRoomAbove.
std::vector<Eigen::AlignedBox2d> OccupiedOn(const Support& support,
                                            std::span<const StillBox> boxes);

// Sets the poses of objects; `sizes` are theirs, in the same order. Those with a pose
// keep it, and the others keep clear of them and of what is `occupied`. False when no place was found
// for one of them; the objects before it have been moved.
bool PlaceOn(const Support& support, std::span<const ObjectSize> sizes,
             std::vector<SceneObject>& objects, Rng& rng,
             std::span<const Eigen::AlignedBox2d> occupied = {});

}  // namespace robocell::internal
