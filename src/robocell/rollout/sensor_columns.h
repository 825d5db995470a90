// The scene's sensors as columns of a recorded episode: `sensors/<name>`, one for each sensor of
// the model, with its unit and frame, and `robots/<robot>/sensors/<name>` for each force-torque
// sensor of a robot: the load on it (scene/ft_sensor.h), never tared. The values are the engine's,
// computed from the row's state with the controls that act until then; quaternions are xyzw like
// everywhere else.
#pragma once

#include <vector>

#include "robocell/data/episode_schema.h"
#include "robocell/data/episode_writer.h"
#include "robocell/mujoco/owners.h"
#include "robocell/scene/ft_sensor.h"
#include "robocell/scene/scene.h"

namespace robocell {

class SensorColumns {
 public:
  // A sensor without a name is `sensors/sensor_<id>`.
  SensorColumns(EpisodeSchema& schema, Scene scene);
  // Computed in a simulation of its own: the scene's is only read, so that recording changes no
  // trajectory.
  void PutState(EpisodeWriter& writer);

 private:
  struct Column {
    ColumnId id;
    int address, dim;
    bool quaternion;
  };
  struct FtColumn {
    ColumnId id;
    FtSensor sensor;
  };
  void AddFtSensors(EpisodeSchema& schema, const RobotRecord& robot);

  Scene scene_;
  DataPtr data_;
  std::vector<Column> columns_;
  std::vector<FtColumn> ft_columns_;
  std::vector<double> state_;
};

}  // namespace robocell
