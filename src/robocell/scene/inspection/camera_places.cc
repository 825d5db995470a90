// Cameras that a robot's configuration adds or moves belong to it: a distant one was placed in
// other units, or in another frame. The places of cameras in the model's own file are its author's
// intention.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <limits>
#include <Eigen/Core>

#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/inspection/robot_inspection.h"

namespace robocell::internal {
namespace {

// The largest distance of a camera: it looks at the work of the robot, or, carried by the arm, at
// what is in front of the arm. In metres, and in sizes of the robot.
constexpr double kCameraFar = 3, kCarriedFar = 1;

using Eigen::Vector3d;

// A camera that the configuration places, and where.
struct GivenCamera {
  int id = -1;
  std::string name, place;
};

std::vector<GivenCamera> GivenCameras(const mjModel* model, const RobotRecord& robot) {
  std::vector<GivenCamera> out;
  const std::string place = "robot '" + robot.name + "'";
  const auto add = [&](const std::string& name, const std::string& where) {
    const int id = name.empty() ? -1 : FindId(model, mjOBJ_CAMERA, robot.prefix + name);
    const auto same = [&](const GivenCamera& other) { return other.id == id; };
    if (id >= 0 && model->cam_mode[id] == mjCAMLIGHT_FIXED && std::ranges::none_of(out, same))
      out.push_back({id, name, place + " / " + where});
  };
  const auto& edits = robot.config.edits;
  for (size_t i = edits.size(); i-- > 0;) {  // the last one counts
    const std::string where = fmt::format("edits[{}]", i);
    if (edits[i].add_camera) add(*edits[i].add_camera, where);
    if (edits[i].camera && edits[i].pos) add(edits[i].name.value_or(edits[i].camera->name), where);
  }
  for (const CameraSpec& camera : robot.config.cameras)
    add(camera.name, "camera '" + camera.name + "'");
  return out;
}

class CameraCheck {
 public:
  CameraCheck(const CompiledRobot& robot, const mjData* at_home, Findings& findings)
      : m_(robot.model), d_(at_home), robot_(robot.robot), findings_(findings) {}

  void Run(const std::vector<GivenCamera>& cameras) {
    const int base = FindId(m_, mjOBJ_BODY, robot_.base_body);
    const int root = FindId(m_, mjOBJ_BODY, robot_.root_body);
    if (base < 0 || root < 0) return;
    for (int g = 0; g < m_->ngeom; ++g) {
      if (IsInSubtree(m_, m_->geom_bodyid[g], base)) geoms_.push_back(g);
    }
    if (geoms_.empty()) return;
    const double size = Size();
    for (const GivenCamera& camera : cameras) {
      const int body = m_->cam_bodyid[camera.id];
      if (!IsInSubtree(m_, body, base)) continue;
      const bool carried = m_->body_weldid[body] != m_->body_weldid[root];
      const double distance = Distance(Vector3d(d_->cam_xpos + 3 * camera.id));
      if (distance > (carried ? kCarriedFar : kCameraFar) * std::max(1.0, size))
        Warn(camera, distance, size);
    }
  }

 private:
  Vector3d Centre(int geom) const { return Vector3d(d_->geom_xpos + 3 * geom); }

  double Size() const {
    Eigen::Array3d low = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Array3d high = -low;
    for (const int g : geoms_) {
      low = low.min(Centre(g).array() - m_->geom_rbound[g]);
      high = high.max(Centre(g).array() + m_->geom_rbound[g]);
    }
    return (high - low).matrix().norm();
  }

  // Returns the distance to the nearest geom.
  double Distance(const Vector3d& point) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const int g : geoms_)
      nearest = std::min(nearest, (point - Centre(g)).norm() - m_->geom_rbound[g]);
    return nearest;
  }

  void Warn(const GivenCamera& camera, double distance, double size) {
    findings_.WarnOf(
        camera.place, "pos",
        fmt::format("camera '{}' is {:.3g} m away from the robot, which is {:.2g} m large: "
                    "`pos` is in metres, in the frame of its parent",
                    camera.name, distance, size));
  }

  const mjModel* m_;
  const mjData* d_;
  const RobotRecord& robot_;
  Findings& findings_;
  std::vector<int> geoms_;
};

}  // namespace

void CheckCameraPlaces(const CompiledRobot& robot, Findings& findings) {
  const mjModel* m = robot.model;
  const std::vector<GivenCamera> cameras = GivenCameras(m, robot.robot);
  if (cameras.empty()) return;
  const DataPtr home = MakeData(m);
  Guarded("checking cameras", home.get(), [&] {
    mj_resetDataKeyframe(m, home.get(), robot.home_key);
    mj_kinematics(m, home.get());
    mj_camlight(m, home.get());
  });
  CameraCheck(robot, home.get(), findings).Run(cameras);
}

}  // namespace robocell::internal
