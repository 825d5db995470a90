#include "robocell/features/sensor_features.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "robocell/features/units.h"
#include "robocell/mujoco/actuators.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/compiled_scene.h"

namespace robocell::internal {
namespace {

std::string SensorNameOf(const RobotRecord& robot, const std::string& sensor) {
  return "robots/" + robot.name + "/sensors/" + sensor;
}

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

// Returns the body that a sensor is on; -1 for one of the whole model, such as a clock.
int BodyOfSensor(const mjModel* m, int sensor) {
  const auto kind = static_cast<mjtObj>(m->sensor_objtype[sensor]);
  const int id = m->sensor_objid[sensor];
  if (kind == mjOBJ_XBODY) return id;
  if (kind != mjOBJ_ACTUATOR) return BodyOf(m, kind, id);
  return ActsOnJoint(m, id) ? BodyOf(m, mjOBJ_JOINT, m->actuator_trnid[2 * id]) : -1;
}

// Returns what stands before the robot's own names: in a model of several robots each has a prefix
// there.
std::string PrefixOf(const CompiledScene& scene, const RobotRecord& robot) {
  for (const RobotSpec& spec : scene.spec().robots) {
    if (spec.name == robot.name) return robot.prefix + spec.model_prefix;
  }
  return robot.prefix;
}

struct SensorOwner {
  const RobotRecord* robot = nullptr;
  std::string name;  // name without the robot's prefix
};

// Returns the robot that a sensor belongs to by its name, else the one whose part it is on.
SensorOwner OwnerOf(const CompiledScene& scene, int sensor, const std::string& name) {
  SensorOwner owner{.name = name};
  size_t longest = 0;
  for (const RobotRecord& robot : scene.robots()) {
    const std::string prefix = PrefixOf(scene, robot);
    if (prefix.size() <= longest || !name.starts_with(prefix)) continue;
    longest = prefix.size();
    owner = {&robot, name.substr(longest)};
  }
  const mjModel* m = scene.model();
  const int body = BodyOfSensor(m, sensor);
  if (owner.robot || body < 0) return owner;
  int nearest = -1;  // a gripper's own base is behind that of its arm
  for (const RobotRecord& robot : scene.robots()) {
    const int base = FindId(m, mjOBJ_BODY, robot.base_body);
    if (base <= nearest || !IsInSubtree(m, body, base)) continue;
    nearest = base;
    owner.robot = &robot;
  }
  return owner;
}

}  // namespace

std::vector<std::string> SensorNames(const CompiledScene& scene) {
  std::set<std::string> taken;
  for (const RobotRecord& robot : scene.robots()) {
    for (const ForceTorqueSensorSpec& spec : robot.config.ft_sensors)
      taken.insert(SensorNameOf(robot, spec.name));
  }
  std::vector<std::string> names;
  for (int s = 0; s < scene.model()->nsensor; ++s) {
    const std::string name = ElementName(scene.model(), mjOBJ_SENSOR, s);
    std::string full = "sensors/" + (name.empty() ? fmt::format("sensor_{}", s) : name);
    const SensorOwner owner = OwnerOf(scene, s, name);
    if (owner.robot && !owner.name.empty()) {
      std::string of_robot = SensorNameOf(*owner.robot, owner.name);
      if (taken.insert(of_robot).second) full = std::move(of_robot);
    }
    names.push_back(std::move(full));
  }
  return names;
}

SensorFeatures::SensorFeatures(Scene given) : FeatureSource(std::move(given)) {
  const mjModel* m = scene().model();
  const std::vector<std::string> names = SensorNames(*scene().compiled());
  for (int s = 0; s < m->nsensor; ++s) {
    const int type = m->sensor_type[s], dim = m->sensor_dim[s];
    const bool quaternion = type == mjSENS_FRAMEQUAT || type == mjSENS_BALLQUAT;
    ColumnSpec spec{
        .name = names[static_cast<size_t>(s)], .units = Unit(m, s), .frame = Frame(m, s)};
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
    Add({.column = {.name = SensorNameOf(robot, sensor.name()),
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
