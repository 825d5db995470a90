// The tool at the end of a robot's chain, and its force-torque sensors.
//
//   ToolFrameSpec tool{.tool_body = "g_base",
//                      .tcp_site = "g_pinch",
//                      .ft_sensors = {{.name = "wrist_ft", .frame_site = "wrist_ft_site"}}};
#pragma once

#include <string>

#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/problems.h"

namespace robocell {

// The engine has a force sensor and a torque sensor at one site; a robot combines the two, and the
// reading is the load on the sensor (robot/robot.h). Names are without the robot's prefix.
struct ForceTorqueSensorSpec {
  std::string name = {};
  std::string force_sensor = {};
  std::string torque_sensor = {};
  std::string frame_site = {};
  bool compensate_tool = false;

  static constexpr const char* kTypeName = "ForceTorqueSensorSpec";
  template <class V>
  static void Fields(V&& v) {
    v("name", &ForceTorqueSensorSpec::name,
      "Name of the sensor, which stands for the pair <name>_force and <name>_torque.");
    v("force_sensor", &ForceTorqueSensorSpec::force_sensor,
      "The model's force sensor. Unset: <name>_force.");
    v("torque_sensor", &ForceTorqueSensorSpec::torque_sensor,
      "The model's torque sensor at the same site. Unset: <name>_torque.");
    v("frame_site", &ForceTorqueSensorSpec::frame_site,
      "Site of the reading's axes and origin. Unset: the site of the sensors.");
    v("compensate_tool", &ForceTorqueSensorSpec::compensate_tool,
      "Subtract the weight of the robot's parts beyond the sensor (gripper, tool) from the "
      "reading.");
  }
  // Return the names of the two engine sensors.
  std::string force() const { return force_sensor.empty() ? name + "_force" : force_sensor; }
  std::string torque() const { return torque_sensor.empty() ? name + "_torque" : torque_sensor; }
  std::string Label() const { return LabelOf("sensor", name); }
  void Validate(Problems& problems) const;
};

struct ToolFrameSpec {
  std::string tool_body = {};
  std::string tcp_site = {};
  List<ForceTorqueSensorSpec> ft_sensors = {};

  static constexpr const char* kTypeName = "ToolFrameSpec";
  template <class V>
  static void Fields(V&& v) {
    v("tool_body", &ToolFrameSpec::tool_body,
      "Body whose subtree's inertia is added to the chain.");
    v("tcp_site", &ToolFrameSpec::tcp_site, "Site that becomes the TCP.");
    v("ft_sensors", &ToolFrameSpec::ft_sensors, "Force-torque sensors of the robot.");
  }
  void Validate(Problems& problems) const;
};

// Reports two force-torque sensors of the same name.
void ValidateFtSensors(const List<ForceTorqueSensorSpec>& sensors, Problems& problems);

}  // namespace robocell
