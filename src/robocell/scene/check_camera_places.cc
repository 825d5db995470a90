// A robot's cameras belong to it: one that is far away was placed in other units, or in the frame
// of something else.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <limits>
#include <Eigen/Core>

#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/owners.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scene/check_robot.h"

namespace robocell {
namespace {

// How far away a camera may be: it looks at what the robot does, or, carried by the arm, at what is
// in front of it. In metres, and in sizes of the robot.
constexpr double kFar = 3, kFarCarried = 1;

using Eigen::Vector3d;

class CameraCheck {
 public:
  CameraCheck(const mjModel* model, const mjData* data, const RobotRecord& robot, Report& report)
      : m_(model), d_(data), robot_(robot), report_(report) {}

  void Run() {
    const int base = FindId(m_, mjOBJ_BODY, robot_.base_body);
    const int root = FindId(m_, mjOBJ_BODY, robot_.root_body);
    if (base < 0 || root < 0) return;
    for (int g = 0; g < m_->ngeom; ++g) {
      if (IsInSubtree(m_, m_->geom_bodyid[g], base)) geoms_.push_back(g);
    }
    if (geoms_.empty()) return;
    const double size = Size();
    for (int c = 0; c < m_->ncam; ++c) {
      if (!IsInSubtree(m_, m_->cam_bodyid[c], base)) continue;
      const bool carried = m_->body_weldid[m_->cam_bodyid[c]] != m_->body_weldid[root];
      const double distance = Distance(Vector3d(d_->cam_xpos + 3 * c));
      if (distance > (carried ? kFarCarried : kFar) * std::max(1.0, size)) Warn(c, distance, size);
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

  // To the nearest geom.
  double Distance(const Vector3d& point) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const int g : geoms_)
      nearest = std::min(nearest, (point - Centre(g)).norm() - m_->geom_rbound[g]);
    return nearest;
  }

  void Warn(int camera, double distance, double size) {
    const std::string full = ElementName(m_, mjOBJ_CAMERA, camera);
    const std::string name =
        full.starts_with(robot_.prefix) ? full.substr(robot_.prefix.size()) : full;
    const std::string message = fmt::format(
        "is {:.3g} m away from the robot, which is {:.2g} m large: `pos` is in metres, in the "
        "frame "
        "of what it is attached to",
        distance, size);
    const std::string place = "robot '" + robot_.name + "'";
    const auto& edits = robot_.config.edits;
    for (size_t i = 0; i < edits.size(); ++i) {
      if (edits[i].add_camera == name || (edits[i].camera && edits[i].camera->name == name))
        return report_.Warn(fmt::format("{} / edits[{}]", place, i),
                            fmt::format("camera '{}' {}", name, message), "pos");
    }
    report_.Warn(fmt::format("{} / camera '{}'", place, name), message, "pos");
  }

  const mjModel* m_;
  const mjData* d_;
  const RobotRecord& robot_;
  Report& report_;
  std::vector<int> geoms_;
};

}  // namespace

void CheckCameraPlaces(const mjModel* model, int home_key, const RobotRecord& robot,
                       Report& report) {
  const DataPtr data = MakeData(model);
  Guarded("checking cameras", data.get(), [&] {
    mj_resetDataKeyframe(model, data.get(), home_key);
    mj_kinematics(model, data.get());
    mj_camlight(model, data.get());
  });
  CameraCheck(model, data.get(), robot, report).Run();
}

}  // namespace robocell
