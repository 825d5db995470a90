#include "robocell/scene/ft_sensor.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <Eigen/Geometry>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/gravity.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/element_lookup.h"

namespace robocell::internal {
namespace {

using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Eigen::Map<const Eigen::Vector3d> Vector(const mjtNum* numbers) {
  return Eigen::Map<const Eigen::Vector3d>(numbers);
}

Eigen::Map<const RowMajor3d> SiteRotation(const mjData* data, int site) {
  return Eigen::Map<const RowMajor3d>(data->site_xmat + 9 * site);
}

// Finds one of the two sensors by name, or lists the available ones.
class PairSearch {
 public:
  PairSearch(const mjModel* model, const RobotRecord& robot, const ForceTorqueSensorSpec& spec)
      : model_(model),
        robot_(robot),
        place_(fmt::format("robot '{}': ft sensor '{}'", robot.name, spec.name)) {}

  int Find(mjtSensor type, const std::string& name) const {
    const char* kind = type == mjSENS_FORCE ? "force" : "torque";
    std::vector<std::string> there, ending;
    for (const std::string& known : RobotElementNames(model_, robot_, mjOBJ_SENSOR)) {
      if (model_->sensor_type[Id(known)] != type) continue;
      there.push_back(known);
      if (known.ends_with(name)) ending.push_back(known);
    }
    const int id = Id(name);
    if (id >= 0 && model_->sensor_type[id] == type) return id;
    if (id >= 0) {
      throw ArgumentError(fmt::format("{}: sensor '{}' is no {} sensor. Its {} sensors: {}", place_,
                                      name, kind, kind, ListNames(there)));
    }
    const std::string next =
        ending.size() > 1
            ? fmt::format(" Several end so: write `{}_sensor` with the attachment's prefix", kind)
            : fmt::format(
                  " A force-torque sensor `x` is the pair x_force and x_torque; where they "
                  "are called otherwise, set `force_sensor` and `torque_sensor`");
    throw NotFoundError(NoSuchName(place_, std::string(kind) + " sensor", name, there) + next);
  }

  // Returns the site whose axes the reading has.
  int FrameSite(const std::string& name) const {
    try {
      return FindElement(model_, robot_, mjOBJ_SITE, name);
    } catch (const NotFoundError& error) {
      const std::string text = error.what();  // "robot 'left': no site ..."
      throw NotFoundError(place_ + ": frame_site" + text.substr(text.find("': ") + 1));
    }
  }

  int RequireSameSite(int force, int torque) const {
    const int site = model_->sensor_objid[force];
    if (model_->sensor_objid[torque] == site) return site;
    const auto at = [&](int sensor) {
      return Describe(model_, mjOBJ_SENSOR, sensor) + " measures at " +
             Describe(model_, mjOBJ_SITE, model_->sensor_objid[sensor]);
    };
    throw ArgumentError(fmt::format("{}: {}, but {}; the two of a pair measure at one site", place_,
                                    at(force), at(torque)));
  }

 private:
  int Id(const std::string& name) const {
    return FindId(model_, mjOBJ_SENSOR, robot_.prefix + name);
  }

  const mjModel* model_;
  const RobotRecord& robot_;
  std::string place_;
};

}  // namespace

FtSensor::FtSensor(const mjModel* model, const RobotRecord& robot,
                   const ForceTorqueSensorSpec& spec)
    : name_(spec.name), compensate_tool_(spec.compensate_tool) {
  const PairSearch search(model, robot, spec);
  const int force = search.Find(mjSENS_FORCE, spec.force());
  const int torque = search.Find(mjSENS_TORQUE, spec.torque());
  force_address_ = model->sensor_adr[force];
  torque_address_ = model->sensor_adr[torque];
  site_ = search.RequireSameSite(force, torque);
  frame_ = spec.frame_site.empty() ? site_ : search.FrameSite(spec.frame_site);
  frame_site_ = ElementName(model, mjOBJ_SITE, frame_);
  body_ = model->site_bodyid[site_];
}

Wrench FtSensor::Read(const mjModel* model, const mjData* data) const {
  Wrench load{.force = -Vector(data->sensordata + force_address_),
              .torque = -Vector(data->sensordata + torque_address_)};
  if (compensate_tool_) load = load - ToolWeight(model, data);
  if (frame_ == site_) return load;
  // Transforms to the axes and the origin of the other site.
  const auto site = SiteRotation(data, site_), frame = SiteRotation(data, frame_);
  const Eigen::Vector3d arm =
      Vector(data->site_xpos + 3 * site_) - Vector(data->site_xpos + 3 * frame_);
  const Eigen::Vector3d force = site * load.force;
  const Eigen::Vector3d torque = site * load.torque + arm.cross(force);
  return {.force = frame.transpose() * force, .torque = frame.transpose() * torque};
}

// The weight at the site of measurement.
Wrench FtSensor::ToolWeight(const mjModel* model, const mjData* data) const {
  const Eigen::Vector3d force = model->body_subtreemass[body_] * Vector(EffectiveGravity(model));
  const Eigen::Vector3d arm =
      Vector(data->subtree_com + 3 * body_) - Vector(data->site_xpos + 3 * site_);
  const auto site = SiteRotation(data, site_);
  return {.force = site.transpose() * force, .torque = site.transpose() * arm.cross(force)};
}

Pose FtSensor::frame_in_world(const mjData* data) const {
  return Pose::FromTranslationAndMatrix(data->site_xpos + 3 * frame_, data->site_xmat + 9 * frame_);
}

}  // namespace robocell::internal
