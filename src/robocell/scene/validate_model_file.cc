#include "robocell/scene/validate_model_file.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <filesystem>
#include <vector>

#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/compile_problem.h"
#include "robocell/scene/spec_tree.h"

namespace robocell::internal {
void ValidateIsModel(const std::string& file, const std::string& place, const std::string& field,
                     CompileLog& log) {
  const std::string extension = std::filesystem::path(file).extension().string();
  if (extension == ".yaml" || extension == ".yml") {
    log.Problem(
        place,
        fmt::format("{0} is YAML, and models are MJCF or URDF. If it is a robot's configuration, "
                    "it goes into the `config` of a RobotSpec, without a `path`: "
                    "config: {0} in YAML, RobotConfig.load('{0}') in Python",
                    file),
        field);
  }
}

void ValidateActuatorTargets(const Part& part, CompileLog& log) {
  const mjSpec* spec = part.spec.get();
  for (mjsElement* element : SpecElements(spec, mjOBJ_ACTUATOR)) {
    const mjsActuator* actuator = mjs_asActuator(element);
    const mjtObj kind = TargetKind(actuator->trntype);
    const std::string target = mjs_getString(actuator->target);
    if (kind == mjOBJ_UNKNOWN || FindSpecElement(spec, kind, target)) continue;
    const std::string name = SpecName(element);
    log.Thrown(part.place,
               PlaceInModel(part, mjOBJ_ACTUATOR, name) + ": " +
                   NoSuchName(fmt::format("the target of actuator '{}'", name), KindName(kind),
                              target, SpecNames(spec, kind)),
               part.field);
  }
}

// The engine leaves joints without numbers in the keyframe at their reference, including those of
// an attached model, which the author may have intended.
void ValidateHomeKeyLength(const Part& part, CompileLog& log) {
  mjsElement* element = FindSpecElement(part.spec.get(), mjOBJ_KEY, "home");
  if (!element) return;
  int given = 0;
  mjs_getDouble(mjs_asKey(element)->qpos, &given);
  int wanted = 0;
  std::vector<std::string> names, left_out;
  for (const JointPositions& joint : PositionsInOrder(part.spec.get())) {
    wanted += joint.count;
    names.push_back(joint.count == 1 ? joint.name
                                     : fmt::format("{} ({})", joint.name, joint.count));
    if (wanted > given) left_out.push_back(joint.name);
  }
  if (given == 0 || given == wanted) return;  // none: all joints at their reference
  const std::string message = fmt::format(
      "the keyframe 'home' has {} in qpos, and the model's joints need {}, in this order: {}",
      Counted(given, "number"), wanted, ListNames(names, 40));
  if (given > wanted) return log.Thrown(part.place, part.file + ": " + message, part.field);
  log.WarnAt(part.file, part.place,
             fmt::format("{}. Without a number, and at their reference: {}", message,
                         ListNames(left_out, 40)));
}

void ValidateHomeKeyControls(const Part& part, CompileLog& log) {
  mjsElement* element = FindSpecElement(part.spec.get(), mjOBJ_KEY, "home");
  if (!element) return;
  int given = 0;
  mjs_getDouble(mjs_asKey(element)->ctrl, &given);
  std::vector<std::string> actuators;
  for (mjsElement* actuator : SpecElements(part.spec.get(), mjOBJ_ACTUATOR))
    actuators.push_back(DescribeSpecElement(actuator));
  // The actuators with several inputs are only known after compiling: more numbers may be correct.
  if (given == 0 || given >= static_cast<int>(actuators.size())) return;
  const std::vector<std::string> left_out(actuators.begin() + given, actuators.end());
  log.WarnAt(part.file, part.place,
             fmt::format("the keyframe 'home' has {} in ctrl for {}. Without a number, and at "
                         "the control that holds home: {}",
                         Counted(given, "number"), Counted(std::ssize(actuators), "actuator"),
                         ListNames(left_out, 40)));
}

void ValidatePresetSizes(Part& part, CompileLog& log) {
  int wanted = 0;
  for (const JointPositions& joint : PositionsInOrder(part.spec.get())) wanted += joint.count;
  for (mjsElement* element : SpecElements(part.spec.get(), mjOBJ_KEY)) {
    const std::string name = SpecName(element);
    int given = 0;
    mjs_getDouble(mjs_asKey(element)->qpos, &given);
    if (name.empty() || name == "home" || given == 0 || given == wanted) continue;
    log.WarnAt(part.file, part.place,
               fmt::format("the keyframe '{}' has {} in qpos, and the model's joints need {}: it "
                           "is left out",
                           name, Counted(given, "number"), wanted));
    part.keys.Remove(name);
  }
}

void ValidateResistances(mjSpec* scene, CompileLog& log) {
  const auto require = [&](mjsElement* element, const char* what, double value) {
    if (!(value < 0)) return;
    log.Problem("", fmt::format("the {} of {} is {:g}, and a negative one adds energy; correct its "
                                "model, or give another value in `edits`",
                                what, DescribeSpecElement(element), value));
  };
  const auto require_all = [&](mjsElement* element, const auto& resisting) {
    require(element, "damping", resisting.damping[0]);
    require(element, "armature", resisting.armature);
    require(element, "frictionloss", resisting.frictionloss);
  };
  for (mjsElement* joint : SpecElements(scene, mjOBJ_JOINT))
    require_all(joint, *mjs_asJoint(joint));
  for (mjsElement* tendon : SpecElements(scene, mjOBJ_TENDON))
    require_all(tendon, *mjs_asTendon(tendon));
}

std::string OtherKeys(const Part& part) {
  const std::vector<mjsElement*> keys = SpecElements(part.spec.get(), mjOBJ_KEY);
  if (keys.empty() || FindSpecElement(part.spec.get(), mjOBJ_KEY, "home")) return "";
  std::vector<std::string> names, values;
  for (mjsElement* key : keys) {
    const std::string name = SpecName(key);
    names.push_back(name.empty() ? fmt::format("the {}. (unnamed)", names.size() + 1)
                                 : "'" + name + "'");
  }
  int given = 0, at = 0;
  const double* qpos = mjs_getDouble(mjs_asKey(keys[0])->qpos, &given);
  for (const JointPositions& joint : PositionsInOrder(part.spec.get())) {
    if (joint.count == 1 && at < given)
      values.push_back(fmt::format("{} {:.6g}", joint.name, qpos[at]));
    at += joint.count;
  }
  return fmt::format(
      "{} has no keyframe 'home', only {}: the robot starts with all joints at their reference. "
      "To start at a keyframe, write its numbers as `home`{}",
      part.file, ListNames(names),
      values.empty() ? "" : fmt::format(": {} has {}", names[0], ListNames(values, 40)));
}

}  // namespace robocell::internal
