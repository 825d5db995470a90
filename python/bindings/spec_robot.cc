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
  BindSpecClass<TaskSpaceConfig>(m, "The part of a commanded pose that counts for an arm.");
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
      "A camera added to a scene or robot. MuJoCo's camera axes: x right, y up, looking along -z."
      "\n\nExamples:\n"
      "    >>> spec.cameras.append(rc.render.CameraSpec(name=\"above\", pos=[0.5, 0, 1.5], "
      "fovy=60))\n"
      "    >>> \"above\" in rc.Scene.build(spec).camera_names()\n"
      "    True");
  DefYamlFile(camera);
  auto config = BindSpecClass<RobotConfig>(
      m,
      "The configuration of a robot: model, move groups, home, base. Usually a YAML file."
      "\n\nExamples:\n"
      "    >>> config = rc.RobotConfig.load(rc.models.robot_file(\"rc7\"))\n"
      "    >>> list(config.move_groups)\n"
      "    ['arm', 'gripper']\n"
      "    >>> config.home[\"arm\"] = [0, 0.25, 0, 1.65, 0, 1.24, 0]\n"
      "    >>> config.edits.append(rc.robots.Edit(body=\"hand\", add_camera=\"palm\", pos=[0, 0, "
      "0.05]))");
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
  auto robot = BindSpecClass<RobotSpec>(
      m,
      "A robot in a scene, with its name and place."
      "\n\nExamples:\n"
      "    >>> left = rc.RobotSpec(name=\"left\", config=config, "
      "prefix=\"left_\", pos=[0, 0.5, 0])\n"
      "    >>> spec.robots.append(left)\n"
      "    >>> bare = rc.RobotSpec(name=\"bare\")\n"
      "    >>> bare.path = \"models/robots/rc7/rc7.xml\"  # a model without a configuration");
  DefYamlFile(robot);
}

}  // namespace robocell::python
