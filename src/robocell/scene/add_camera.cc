// Cameras of scenes and robots.
#include "robocell/scene/add_camera.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "robocell/base/names.h"
#include "robocell/base/units.h"
#include "robocell/scene/robot_parts.h"
#include "robocell/scene/spec_tree.h"

namespace robocell {

void SetFovy(mjsCamera* camera, double fovy, const std::string& place, Report& report) {
  camera->fovy = fovy;
  if (fovy >= kPi) return;  // no angle in radians is as large
  report.Warn(place, fmt::format("fovy is in degrees, and {:g} degrees see next to nothing; {:g} "
                                 "radians are {:.1f} degrees",
                                 fovy, fovy, fovy * 180 / kPi));
}

void AddCamera(const CameraSpec& camera, const Placement& placement, const std::string& place,
               Report& report) {
  const mjSpec* spec = mjs_getSpec(placement.parent->element);
  if (FindSpecElement(spec, mjOBJ_CAMERA, camera.name)) {
    report.Problem(place,
                   fmt::format("there is already a camera of this name; choose another one. The "
                               "model's cameras: {}",
                               ListNames(SpecNames(spec, mjOBJ_CAMERA))),
                   "name");
    return;
  }
  mjsCamera* added = mjs_addCamera(placement.parent, nullptr);
  SetSpecName(added->element, camera.name, place);
  SetFovy(added, *camera.fovy, place, report);
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
      AddCamera(camera, *at, place, report);
    }
  }
}

}  // namespace robocell
