// RobotConfig, RobotSpec and their parts.
#include "spec_class.h"
#include "spec_parts.h"
#include "robocell/spec/robot_spec.h"

namespace robocell::python {

void BindRobotSpecs(nb::module_& m) {
  BindSpecClass<BaseConfig>(m, "The base of a robot.");
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
  BindSpecClass<ToolFrameSpec>(m, "The tool frame of a robot.");
  auto camera = BindSpecClass<CameraSpec>(
      m,
      "A camera added to a scene or robot. MuJoCo's camera axes: x right, y up, looking along -z.");
  DefYamlFile(camera);
  auto config = BindSpecClass<RobotConfig>(
      m, "The configuration of a robot: model, move groups, home, base. Usually a YAML file.");
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
      "Returns the modes that its `control` needs, including position: what a scene must declare "
      "(RobotSpec.control_modes) without switching.");
  auto robot = BindSpecClass<RobotSpec>(m, "A robot in a scene, with its name and place.");
  DefYamlFile(robot);
}

}  // namespace robocell::python
