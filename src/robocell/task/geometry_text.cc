#include "robocell/task/geometry_text.h"

#include <mujoco/mujoco.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <Eigen/Core>

namespace robocell::internal {

Pose RoundedPose(const Pose& pose) {
  constexpr double kStep = 1e-7;
  const auto round = [](double value) { return std::round(value / kStep) * kStep + 0.0; };
  const Eigen::Vector3d t = pose.translation().unaryExpr(round);
  Eigen::Vector4d q(pose.quaternion()[0], pose.quaternion()[1], pose.quaternion()[2],
                    pose.quaternion()[3]);
  // Of the two quaternions of a half turn, the same one.
  Eigen::Index largest = 0;
  q = q.unaryExpr(round);
  q.cwiseAbs().maxCoeff(&largest);
  if (q[largest] < 0) q = -q;
  q.normalize();
  return Pose(t, Quaternion{q[0], q[1], q[2], q[3]});
}

void AppendNumbers(std::span<const double> numbers, std::string* text) {
  text->append(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes());
}

void AppendPose(const Pose& pose, std::string* text) {
  const Eigen::Vector3d& t = pose.translation();
  const Quaternion& q = pose.quaternion();
  AppendNumbers(std::array{t.x(), t.y(), t.z(), q[0], q[1], q[2], q[3]}, text);
}

void AppendGeomShape(const mjModel* m, int geom, std::string* text) {
  AppendNumbers(std::array{static_cast<double>(m->geom_type[geom])}, text);
  AppendNumbers(std::span(m->geom_size + 3 * geom, 3), text);
  AppendNumbers(std::span(m->geom_aabb + 6 * geom, 6), text);
  const int mesh = m->geom_dataid[geom];
  if (m->geom_type[geom] != mjGEOM_MESH || mesh < 0) return;
  const float* vertices = m->mesh_vert + 3 * static_cast<ptrdiff_t>(m->mesh_vertadr[mesh]);
  text->append(reinterpret_cast<const char*>(vertices),
               sizeof(float) * 3 * static_cast<size_t>(m->mesh_vertnum[mesh]));
}

}  // namespace robocell::internal
