// The scene's sensors as features of a cell, with unit and frame: `robots/<robot>/sensors/<name>`
// for those of a robot, by their names in the robot's own model, and `sensors/<name>` for others. A
// robot's force-torque sensors are among its own: the load on each (scene/ft_sensor.h), never
// tared. The values are the engine's, computed from the row's state with the controls that act
// until then; quaternions are xyzw like everywhere else.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "robocell/features/feature_source.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/ft_sensor.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

// Returns the names of all sensors of the model as features, wherever the cell is used. A sensor
// without a name is `sensors/sensor_<id>`; one whose name in its robot is taken, as by a
// force-torque sensor, keeps `sensors/` and its name in the scene.
std::vector<std::string> SensorNames(const CompiledScene& scene);

class SensorFeatures final : public FeatureSource {
 public:
  explicit SensorFeatures(Scene given);

 private:
  // Computes them in a separate simulation: the scene is only read, so that recording changes no
  // trajectory.
  void ReadNumbers(std::span<double> out) override;
  struct Column {
    int address, dim;
    bool quaternion;
  };
  void AddFtSensors(const RobotRecord& robot);

  DataPtr data_;
  std::vector<Column> columns_;
  std::vector<FtSensor> ft_sensors_;
  std::vector<double> state_;
};

}  // namespace robocell::internal
