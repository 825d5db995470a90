#include "robocell/spec/tool_frame_spec.h"

#include <vector>

#include "robocell/spec/validate.h"

namespace robocell {

void ForceTorqueSensorSpec::Validate(Problems& problems) const {
  ValidateNotEmpty(name, "name",
                   "force-torque sensors are looked up by name; `wrist_ft` stands for the pair "
                   "wrist_ft_force and wrist_ft_torque",
                   problems);
}

void ToolFrameSpec::Validate(Problems& problems) const { ValidateFtSensors(ft_sensors, problems); }

void ValidateFtSensors(const List<ForceTorqueSensorSpec>& sensors, Problems& problems) {
  std::vector<std::string> names;
  for (const ForceTorqueSensorSpec& sensor : sensors) names.push_back(sensor.name);
  ValidateUnique(names, "ft_sensors", "name", problems);
}

}  // namespace robocell
