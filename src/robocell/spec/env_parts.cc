#include "robocell/spec/env_parts.h"

#include <fmt/format.h>

#include <cmath>

#include "robocell/spec/timestep.h"
#include "robocell/spec/validate.h"

namespace robocell {

namespace {

constexpr double kMostSteps = 1e6;  // engine steps: a longer step hardly ends

void ValidateDuration(const char* field, double seconds, double timestep, Problems& problems) {
  if (!(timestep > 0 && seconds / timestep > kMostSteps)) return;
  problems.AddAt(field, fmt::format("a step of the environment could take {:g} s, {:g} steps of "
                                    "the engine; at most {:g}",
                                    seconds, seconds / timestep, kMostSteps));
}

}  // namespace

void EnvObject::Validate(Problems& problems) const {
  if (!shape) {
    ValidateNotEmpty(mjcf_path, "mjcf_path", "the object's model file, or `shape` for a primitive",
                     problems);
    if (size || mass || rgba || friction)
      problems.Add("size, mass, rgba and friction describe a primitive; name its `shape`");
    return;
  }
  SceneObject object = AsSceneObject();
  object.name = "object";  // the map's key, which is checked with the frames
  object.Validate(problems);
}

SceneObject EnvObject::AsSceneObject() const {
  SceneObject object{.mjcf_path = mjcf_path, .reset_root_pose = true, .fixed = fixed};
  if (!shape) return object;
  object.shape = shape;
  object.size = size;
  object.mass = mass;
  object.rgba = rgba.value_or(kRgba);
  object.friction = friction.value_or(kFriction);
  return object;
}

void ObjectVariation::Validate(Problems& problems) const {
  for (const auto& [range, field] : {std::pair{mass, "mass"}, std::pair{friction, "friction"}}) {
    if (range[0] > range[1])
      problems.AddAt(field, "is [least, largest] factor; the least is above the largest");
  }
}

void CameraAdderConfig::Validate(Problems& problems) const {
  ValidateFovy(fovy, problems);
  if (robot_name.empty() && !attachment_site.empty()) {
    problems.AddAt("attachment_site",
                   "is a site of a robot, but without robot_name the offset is in the root frame; "
                   "set robot_name, or leave the site out");
  }
}

void SimSettings::Validate(Problems& problems) const {
  internal::ValidateTimestep(timestep, 1, "timestep", problems);
  // Only these steps end at the frequency. The reader reports values that are not numbers.
  if (async_control && frequency > 0 && timestep > 0 && std::isfinite(timestep) &&
      frequency * timestep > 1) {
    problems.AddAt("frequency",
                   fmt::format("{:g} Hz is more often than the engine steps, every {:g} "
                               "s; at most {:g} Hz",
                               frequency, timestep, 1 / timestep));
  }
  if (async_control && frequency > 0)
    ValidateDuration("frequency", 1 / frequency, timestep, problems);
  ValidateDuration("max_convergence_time", max_convergence_time, timestep, problems);
}

}  // namespace robocell
