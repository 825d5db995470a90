#include "robocell/features/sensor_features.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>

#include "robocell/features/units.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

// An actuator's length is that of its joint times the gear; elsewhere metres.
std::string ActuatorUnit(const mjModel* m, int actuator, const char* per) {
  if (ActsOnJoint(m, actuator)) return JointUnit(m, m->actuator_trnid[2 * actuator]) + per;
  return "m" + std::string(per);
}

std::string ForceUnit(const std::string& motion) { return motion == "m" ? "N" : "N m"; }

std::string Unit(const mjModel* m, int sensor) {
  const int id = m->sensor_objid[sensor];
  switch (m->sensor_type[sensor]) {
    case mjSENS_TOUCH:
    case mjSENS_FORCE:
    case mjSENS_TENDONACTFRC:
    case mjSENS_TENDONLIMITFRC:
      return "N";
    case mjSENS_TORQUE:
      return "N m";
    case mjSENS_ACCELEROMETER:
    case mjSENS_FRAMELINACC:
      return "m/s^2";
    case mjSENS_VELOCIMETER:
    case mjSENS_FRAMELINVEL:
    case mjSENS_SUBTREELINVEL:
    case mjSENS_TENDONVEL:
    case mjSENS_TENDONLIMITVEL:
      return "m/s";
    case mjSENS_GYRO:
    case mjSENS_BALLANGVEL:
    case mjSENS_FRAMEANGVEL:
      return "rad/s";
    case mjSENS_FRAMEANGACC:
      return "rad/s^2";
    case mjSENS_MAGNETOMETER:
      return "T";
    case mjSENS_RANGEFINDER:
      return m->sensor_dim[sensor] == 1 ? "m" : "";
    case mjSENS_TENDONPOS:
    case mjSENS_TENDONLIMITPOS:
    case mjSENS_FRAMEPOS:
    case mjSENS_SUBTREECOM:
    case mjSENS_GEOMDIST:
    case mjSENS_GEOMFROMTO:
      return "m";
    case mjSENS_CAMPROJECTION:
      return "px";
    case mjSENS_JOINTPOS:
    case mjSENS_JOINTLIMITPOS:
      return JointUnit(m, id);
    case mjSENS_JOINTVEL:
    case mjSENS_JOINTLIMITVEL:
      return JointUnit(m, id) + "/s";
    case mjSENS_JOINTACTFRC:
    case mjSENS_JOINTLIMITFRC:
      return ForceUnit(JointUnit(m, id));
    case mjSENS_ACTUATORPOS:
      return ActuatorUnit(m, id, "");
    case mjSENS_ACTUATORVEL:
      return ActuatorUnit(m, id, "/s");
    case mjSENS_ACTUATORFRC:
      return ForceUnit(ActuatorUnit(m, id, ""));
    case mjSENS_SUBTREEANGMOM:
      return "kg m^2/s";
    case mjSENS_E_POTENTIAL:
    case mjSENS_E_KINETIC:
      return "J";
    case mjSENS_CLOCK:
      return "s";
    case mjSENS_BALLQUAT:
    case mjSENS_FRAMEQUAT:
    case mjSENS_FRAMEXAXIS:
    case mjSENS_FRAMEYAXIS:
    case mjSENS_FRAMEZAXIS:
    case mjSENS_INSIDESITE:
    case mjSENS_GEOMNORMAL:
      return "1";
    default:  // contact, tactile, plugin, user: several kinds of numbers, or the user's own
      return "";
  }
}

std::string Frame(const mjModel* m, int sensor) {
  const auto described = [&](int type, int id) {
    return Describe(m, static_cast<mjtObj>(type), id);
  };
  switch (m->sensor_type[sensor]) {
    case mjSENS_ACCELEROMETER:
    case mjSENS_VELOCIMETER:
    case mjSENS_GYRO:
    case mjSENS_FORCE:
    case mjSENS_TORQUE:
    case mjSENS_MAGNETOMETER:
      return described(m->sensor_objtype[sensor], m->sensor_objid[sensor]);
    case mjSENS_FRAMEPOS:
    case mjSENS_FRAMEQUAT:
    case mjSENS_FRAMEXAXIS:
    case mjSENS_FRAMEYAXIS:
    case mjSENS_FRAMEZAXIS:
    case mjSENS_FRAMELINVEL:
    case mjSENS_FRAMEANGVEL:
      if (m->sensor_refid[sensor] >= 0)
        return described(m->sensor_reftype[sensor], m->sensor_refid[sensor]);
      return "world";
    case mjSENS_FRAMELINACC:
    case mjSENS_FRAMEANGACC:
    case mjSENS_SUBTREECOM:
    case mjSENS_SUBTREELINVEL:
    case mjSENS_SUBTREEANGMOM:
    case mjSENS_GEOMNORMAL:
    case mjSENS_GEOMFROMTO:
      return "world";
    default:
      return "";
  }
}

std::string NameOfSensor(const mjModel* m, int sensor) {
  const std::string name = ElementName(m, mjOBJ_SENSOR, sensor);
  return "sensors/" + (name.empty() ? fmt::format("sensor_{}", sensor) : name);
}

}  // namespace

SensorFeatures::SensorFeatures(Scene given) : FeatureSource(std::move(given)) {
  const mjModel* m = scene().model();
  for (int s = 0; s < m->nsensor; ++s) {
    const int type = m->sensor_type[s], dim = m->sensor_dim[s];
    const bool quaternion = type == mjSENS_FRAMEQUAT || type == mjSENS_BALLQUAT;
    ColumnSpec spec{.name = NameOfSensor(m, s), .units = Unit(m, s), .frame = Frame(m, s)};
    if (dim != 1) spec.shape = {dim};
    if (dim == 3) spec.names = {"x", "y", "z"};
    if (quaternion) spec.names = {"qx", "qy", "qz", "qw"};
    if (type == mjSENS_FORCE || type == mjSENS_TORQUE)
      spec.description = "What the parent exerts on the site's body: the load's negative.";
    Add({.column = std::move(spec), .source = "sensor"});
    columns_.push_back({m->sensor_adr[s], dim, quaternion});
  }
  for (const RobotRecord& robot : scene().compiled()->robots()) AddFtSensors(robot);
  if (columns_.empty()) return;  // no force-torque sensors either
  data_ = MakeData(m);
  state_.resize(static_cast<size_t>(mj_stateSize(m, mjSTATE_INTEGRATION)));
}

void SensorFeatures::AddFtSensors(const RobotRecord& robot) {
  for (const ForceTorqueSensorSpec& spec : robot.config.ft_sensors) {
    FtSensor sensor(scene().model(), robot, spec);
    Add({.column = {.name = "robots/" + robot.name + "/sensors/" + sensor.name(),
                    .shape = {6},
                    .units = "N, N m",
                    .frame = "site '" + sensor.frame_site() + "'",
                    .names = {"fx", "fy", "fz", "tx", "ty", "tz"},
                    .description =
                        "Load on the force-torque sensor: force, then torque about the site."},
         .source = "robot " + robot.name});
    ft_sensors_.push_back(std::move(sensor));
  }
}

void SensorFeatures::ReadNumbers(std::span<double> out) {
  if (columns_.empty()) return;
  const mjModel* m = scene().model();
  mj_getState(m, scene().data(), state_.data(), mjSTATE_INTEGRATION);
  mj_setState(m, data_.get(), state_.data(), mjSTATE_INTEGRATION);
  Guarded("sensors", data_.get(), [&] { mj_forward(m, data_.get()); });
  for (const Column& column : columns_) {
    double* values = data_->sensordata + column.address;
    if (column.quaternion) std::rotate(values, values + 1, values + 4);
    std::copy_n(values, column.dim, out.begin());
    out = out.subspan(static_cast<size_t>(column.dim));
  }
  for (const FtSensor& sensor : ft_sensors_) {
    const Eigen::Matrix<double, 6, 1> load = sensor.Read(m, data_.get()).vector();
    std::copy_n(load.data(), 6, out.begin());
    out = out.subspan(6);
  }
}

}  // namespace robocell::internal
