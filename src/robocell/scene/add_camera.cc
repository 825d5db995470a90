// Cameras of scenes and robots.
#include "robocell/scene/add_camera.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "robocell/base/suggestions.h"
#include "robocell/base/units.h"
#include "robocell/scene/robot_parts.h"
#include "robocell/scene/spec_tree.h"
#include "robocell/spec/scene_object.h"

namespace robocell::internal {
namespace {

bool NameIsTaken(const CameraSpec& camera, const mjSpec* spec, const std::string& place,
                 CompileLog& log) {
  if (!FindSpecElement(spec, mjOBJ_CAMERA, camera.name)) return false;
  log.Problem(place,
              fmt::format("there is already a camera of this name; choose another one. The "
                          "model's cameras: {}",
                          ListNames(SpecNames(spec, mjOBJ_CAMERA))),
              "name");
  return true;
}

// Returns the only camera of the model, with a name; null and an entry in the log without one.
mjsElement* OnlyCamera(const Part& model, mjsBody* root, CompileLog& log) {
  const std::vector<mjsElement*> cameras = BodyElements(root, mjOBJ_CAMERA, true);
  if (cameras.size() == 1) {
    if (SpecName(cameras[0]).empty()) SetSpecName(cameras[0], "camera", model.place);
    return cameras[0];
  }
  std::vector<std::string> names;
  for (mjsElement* camera : cameras) names.push_back(SpecName(camera));
  log.Problem(model.place,
              fmt::format("a camera's model holds one camera, {} holds {}: {}", model.file,
                          names.size(), ListNames(names)),
              model.field);
  return nullptr;
}

void AddHousing(const CameraSpec& camera, const Placement& placement, const Part& model,
                CompileLog& log) {
  mjsBody* root = ChooseRoot(model, std::nullopt, log);
  mjsElement* own = root ? OnlyCamera(model, root, log) : nullptr;
  if (!own) return;
  const std::string prefix = SceneObjectElementName(camera.name, "");
  AttachPart(placement.parent, model, root, placement.pose, prefix, log);
  mjsElement* added =
      FindSpecElement(mjs_getSpec(placement.parent->element), mjOBJ_CAMERA, prefix + SpecName(own));
  SetSpecName(added, camera.name, model.place);
  if (camera.fovy) SetFovy(mjs_asCamera(added), *camera.fovy, model.place, log);
}

}  // namespace

void SetFovy(mjsCamera* camera, double fovy, const std::string& place, CompileLog& log) {
  camera->fovy = fovy;
  if (fovy >= kPi) return;  // no angle in radians is as large
  log.Warn(place, fmt::format("fovy is in degrees, and {:g} degrees see next to nothing; {:g} "
                              "radians are {:.1f} degrees",
                              fovy, fovy, fovy * 180 / kPi));
}

void AddCamera(const CameraSpec& camera, const Placement& placement, const std::string& directory,
               const SimOptions& options, const std::string& place, CompileLog& log) {
  if (NameIsTaken(camera, mjs_getSpec(placement.parent->element), place, log)) return;
  if (!camera.mjcf_path.empty()) {
    const auto model = LoadPart(camera.mjcf_path, directory, place, "mjcf_path", options, "", log);
    if (model) AddHousing(camera, placement, *model, log);
    return;
  }
  mjsCamera* added = mjs_addCamera(placement.parent, nullptr);
  SetSpecName(added->element, camera.name, place);
  SetFovy(added, *camera.fovy, place, log);
  SetPose(added, placement.pose);
}

void AddRobotCameras(const RobotConfig& config, const std::string& directory, Part& robot,
                     const SceneSpec& scene, CompileLog& log) {
  for (size_t i = 0; i < config.cameras.size(); ++i) {
    const CameraSpec& camera = config.cameras[i];
    const std::string place = robot.place + " / camera '" + camera.name + "'";
    log.Locate(place, config.locations.Below("cameras[" + std::to_string(i) + "]"));
    const AttachTarget& target = camera.attach_to;
    if (ElementKindOf(target.kind) == mjOBJ_UNKNOWN) {
      log.Problem(place,
                  "a robot's camera is attached to a body, site or frame of the robot, not to " +
                      DescribeTarget(target),
                  "attach_to");
      continue;
    }
    if (const auto at =
            Place(target, camera.pose(), robot.spec.get(), SceneSpec{}, {}, place, log)) {
      AddCamera(camera, *at, directory, scene.options, place, log);
    }
  }
}

}  // namespace robocell::internal
