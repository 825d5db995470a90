#include "robocell/spec/env_parts.h"

#include <fmt/format.h>

#include "robocell/spec/timestep.h"
#include "robocell/spec/validate.h"

namespace robocell {

namespace {

constexpr double kMostSteps = 1e6;  // of the engine: such a step hardly ends

void CheckDuration(const char* field, double seconds, double timestep, Problems& problems) {
  if (!(timestep > 0 && seconds / timestep > kMostSteps)) return;
  problems.AddAt(field, fmt::format("a step of the environment could take {:g} s, {:g} steps of "
                                    "the engine; at most {:g}",
                                    seconds, seconds / timestep, kMostSteps));
}

}  // namespace

void EnvObject::Validate(Problems& problems) const {
  CheckNotEmpty(mjcf_path, "mjcf_path", "the object's model file", problems);
}

void CameraAdderConfig::Validate(Problems& problems) const {
  if (robot_name.empty() && !attachment_site.empty()) {
    problems.AddAt("attachment_site",
                   "is a site of a robot, but without robot_name the offset is in the root frame; "
                   "set robot_name, or leave the site out");
  }
}

void SimSettings::Validate(Problems& problems) const {
  CheckTimestep(timestep, 1, "timestep", problems);
  if (frequency > 0 && timestep > 0 && frequency * timestep > 1) {
    problems.AddAt("frequency",
                   fmt::format("{:g} Hz is more often than the engine steps, every {:g} "
                               "s; at most {:g} Hz",
                               frequency, timestep, 1 / timestep));
  }
  if (async_control && frequency > 0) CheckDuration("frequency", 1 / frequency, timestep, problems);
  CheckDuration("max_convergence_time", max_convergence_time, timestep, problems);
}

}  // namespace robocell
