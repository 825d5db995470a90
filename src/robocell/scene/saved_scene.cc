#include "robocell/scene/saved_scene.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <array>
#include <string_view>

#include "robocell/base/error.h"

namespace robocell::internal {
namespace {

struct LookedUpKind {
  mjtObj type;
  const char* name;
  mjtSize mjModel::*count;
};

// The number of geoms may differ: nothing looks them up by name.
constexpr std::array<LookedUpKind, 6> kLookedUp = {
    {{mjOBJ_BODY, "body", &mjModel::nbody},
     {mjOBJ_JOINT, "joint", &mjModel::njnt},
     {mjOBJ_SITE, "site", &mjModel::nsite},
     {mjOBJ_CAMERA, "camera", &mjModel::ncam},
     {mjOBJ_ACTUATOR, "actuator", &mjModel::nactuator},
     {mjOBJ_KEY, "keyframe", &mjModel::nkey}}};

}  // namespace

void RequireSavedNames(const mjModel* built, const mjModel* saved, const std::string& place) {
  for (const LookedUpKind& kind : kLookedUp) {
    for (int i = 0; i < static_cast<int>(built->*kind.count); ++i) {
      const char* name = mj_id2name(built, kind.type, i);
      if (!name) continue;
      // Only `home` is required of the keyframes: a file may be older than the others.
      if (kind.type == mjOBJ_KEY && std::string_view(name) != "home") continue;
      const int there = mj_name2id(saved, kind.type, name);
      if (there < 0) {
        throw NotFoundError(fmt::format(
            "{}: has no {} '{}', which the scene of this spec has. Save the scene of the same "
            "configuration, and keep the names of its elements",
            place, kind.name, name));
      }
      if (kind.type == mjOBJ_JOINT && built->jnt_type[i] != saved->jnt_type[there])
        throw NotFoundError(fmt::format("{}: joint '{}' is of another kind there", place, name));
    }
  }
}

}  // namespace robocell::internal
