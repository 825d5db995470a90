// RobotConfig, RobotSpec and what they hold.
#include "spec_class.h"
#include "spec_parts.h"
#include "robocell/spec/robot_spec.h"

namespace robocell::python {

void BindRobotSpecs(nb::module_& m) {
  BindSpecClass<BaseConfig>(m, "What a robot stands on.");
  BindSpecClass<GripperCtrl>(m, "Raw control values of a gripper's actuator, open and closed.");
  BindSpecClass<GripperJointRange>(
      m, "Values of a gripper's first joint when it is open and closed, metres or radians.");
  BindSpecClass<GripperDistance>(m, "Free distance between the fingers, closed and open, metres.");
  BindSpecClass<MoveGroupConfig>(m, "A named group of joints and actuators of a robot.");
  BindSpecClass<Edit>(m,
                      "A small change to a model while it is loaded: one element changed, added or "
                      "deleted.\n\nSI and radians; euler in degrees, quaternions xyzw.");
  auto attachment = BindSpecClass<AttachmentSpec>(
      m, "A tool, sensor or other model mounted on a robot or on an earlier attachment of it.");
  DefYamlFile(attachment);
  BindSpecClass<ForceTorqueSensorSpec>(
      m, "A force-torque sensor: the model's pair of a force and a torque sensor as one.");
  BindSpecClass<ToolFrameSpec>(m, "What is in a robot's hand.");
  auto camera = BindSpecClass<CameraSpec>(
      m,
      "A camera added to a scene or robot. MuJoCo's camera axes: x right, y up, looking along -z.");
  DefYamlFile(camera);
  auto config = BindSpecClass<RobotConfig>(
      m, "What a robot is: model, move groups, home, base. Usually a YAML file.");
  config.def_prop_ro(
      "source_dir", [](const RobotConfig& c) { return c.source_dir; },
      "Folder of the robot file, which its relative paths start at; '' without one.");
  DefYamlFile(config);
  config.def(
      "used_modes",
      [](const RobotConfig& c) {
        nb::list modes;
        for (const CtrlMode mode : c.used_modes()) modes.append(mode);
        return modes;
      },
      nb::sig("def used_modes(self) -> list[CtrlMode]"),
      "The modes that its `control` needs, position included: what a scene has to declare "
      "(RobotSpec.control_modes) where nobody switches.");
  auto robot =
      BindSpecClass<RobotSpec>(m, "A robot in a scene: which, called what, standing where.");
  DefYamlFile(robot);
}

}  // namespace robocell::python
