// Near and far clip planes. MuJoCo stores them as multiples of `stat.extent`, which it computes
// from the initial pose of the scene: a robot alone on an empty floor gets planes that cut away
// most of a room. Scenes set all three.
//
//   SetClipPlanes(spec, 2.0, 0.01, 50.0);      // before compiling: survives saving
//   ClipPlanes planes = GetClipPlanes(model);
//
// Depth is exact to far better than a millimetre over this range: the renderer's depth buffer is a
// reversed float one. The extent also scales fog, the shadows of directional lights and the size of
// drawn frames.
#pragma once

#include "robocell/mujoco/forward.h"

namespace robocell::internal {

struct ClipPlanes {
  double near_m = 0.01;
  double far_m = 50;
};

ClipPlanes GetClipPlanes(const mjModel* model);

// Keeps the extent. Throws ArgumentError unless 0 < near_m < far_m.
void SetClipPlanes(mjModel* model, double near_m, double far_m);
// Sets the clip planes and the extent (metres, > 0): half the size of the usual view.
void SetClipPlanes(mjSpec* spec, double extent_m, double near_m, double far_m);

}  // namespace robocell::internal
