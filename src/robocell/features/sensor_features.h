// The scene's sensors as features of a cell: `sensors/<name>` for each sensor of the model, with
// its unit and frame, and `robots/<robot>/sensors/<name>` for each force-torque sensor of a robot:
// the load on it (scene/ft_sensor.h), never tared. The values are the engine's, computed from the
// row's state with the controls that act until then; quaternions are xyzw like everywhere else.
#pragma once

#include <span>
#include <vector>

#include "robocell/features/feature_source.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/ft_sensor.h"
#include "robocell/scene/scene.h"

namespace robocell::internal {

class SensorFeatures final : public FeatureSource {
 public:
  // A sensor without a name is `sensors/sensor_<id>`.
  explicit SensorFeatures(Scene given);

 private:
  // Computes them in a simulation of its own: the scene is only read, so that recording changes no
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
