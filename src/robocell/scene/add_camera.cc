// Cameras of scenes and robots.
#include "robocell/scene/add_camera.h"

#include <mujoco/mujoco.h>

#include "robocell/scene/robot_parts.h"
#include "robocell/scene/spec_tree.h"

namespace robocell {

void AddCamera(const CameraSpec& camera, const Placement& placement, const std::string& place) {
  mjsCamera* added = mjs_addCamera(placement.parent, nullptr);
  SetSpecName(added->element, camera.name, place);
  added->fovy = *camera.fovy;
  SetPose(added, placement.pose);
}

void AddRobotCameras(const RobotConfig& config, Part& robot, Report& report) {
  for (size_t i = 0; i < config.cameras.size(); ++i) {
    const CameraSpec& camera = config.cameras[i];
    const std::string place = robot.place + " / camera '" + camera.name + "'";
    report.Locate(place, config.locations.Below("cameras[" + std::to_string(i) + "]"));
    const AttachTarget& target = camera.attach_to;
    if (ElementKindOf(target.kind) == mjOBJ_UNKNOWN) {
      report.Problem(place,
                     "a robot's camera is attached to a body, site or frame of the robot, not to " +
                         Describe(target),
                     "attach_to");
      continue;
    }
    if (const auto at =
            Place(target, camera.pose(), robot.spec.get(), SceneSpec{}, {}, place, report)) {
      AddCamera(camera, *at, place);
    }
  }
}

}  // namespace robocell
