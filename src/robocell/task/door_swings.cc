#include "robocell/task/door_swings.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <Eigen/Core>

#include "robocell/base/units.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"

namespace robocell::internal {
namespace {

constexpr double kLeastSwing = 0.2;  // rad; a hinge that moves less is no door
constexpr double kSwingStep = 0.04;  // rad between the postures of a door that are checked
constexpr double kSlideStep = 0.02;  // m
constexpr double kTurn = 2 * kPi;
constexpr double kUpright = 0.95;  // of the axis along the vertical

std::vector<int> GeomsOf(const mjModel* m, int body) {
  const std::vector<bool> bodies = SubtreeMask(m, body);
  std::vector<int> geoms;
  for (int g = 0; g < m->ngeom; ++g) {
    if (bodies[m->geom_bodyid[g]] && IsCollisionGeom(m, g)) geoms.push_back(g);
  }
  return geoms;
}

// Calls `look` with the corners of the geoms' boxes in the world.
template <class F>
void ForEachCorner(const mjModel* m, const mjData* d, const std::vector<int>& geoms,
                   const F& look) {
  for (const int g : geoms) {
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> turn(d->geom_xmat + 9 * g);
    const Eigen::Vector3d at(d->geom_xpos + 3 * g);
    const mjtNum* box = m->geom_aabb + 6 * g;
    for (int corner = 0; corner < 8; ++corner) {
      Eigen::Vector3d point;
      for (int i = 0; i < 3; ++i)
        point[i] = box[i] + (((corner >> i) & 1) != 0 ? box[3 + i] : -box[3 + i]);
      look(Eigen::Vector3d(at + turn * point));
    }
  }
}

// Returns positions from one to another, at most `step` apart.
std::vector<double> Positions(double from, double to, double step) {
  const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(to - from) / step)));
  std::vector<double> positions;
  for (int i = 0; i <= steps; ++i)
    positions.push_back(std::lerp(from, to, static_cast<double>(i) / steps));
  return positions;
}

// Returns why a joint that takes some positions is too near to a robot's geoms; "" if it is not. The
// state stays.
std::string WhyInTheWay(Scene& scene, const std::vector<int>& near, const std::vector<int>& leaf,
                        int joint, const std::vector<double>& positions, double clearance) {
  const mjModel* m = scene.model();
  mjData* d = scene.data();
  double& pos = d->qpos[m->jnt_qposadr[joint]];
  const double before = pos;
  const std::shared_ptr<void> restore(nullptr, [&](void*) {
    pos = before;
    mj_kinematics(m, d);
  });
  for (const double position : positions) {
    pos = position;
    mj_kinematics(m, d);
    for (const int a : near) {
      for (const int b : leaf) {
        const Eigen::Vector3d apart =
            Eigen::Vector3d(d->geom_xpos + 3 * a) - Eigen::Vector3d(d->geom_xpos + 3 * b);
        if (apart.norm() > m->geom_rbound[a] + m->geom_rbound[b] + clearance) continue;
        const double distance = Guarded("distance of a robot to a door", d, [&] {
          return mj_geomDistance(m, d, a, b, clearance, nullptr);
        });
        if (distance >= clearance) continue;
        return fmt::format("{} would be {:.3f} m from the door '{}'", Describe(m, mjOBJ_GEOM, a),
                           distance, ElementName(m, mjOBJ_BODY, m->jnt_bodyid[joint]));
      }
    }
  }
  return "";
}

double HeightOf(const mjModel* m, const mjData* d, const std::vector<int>& geoms) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  ForEachCorner(m, d, geoms, [&](const Eigen::Vector3d& corner) {
    low = std::min(low, corner.z());
    high = std::max(high, corner.z());
  });
  return high - low;
}

}  // namespace

std::vector<Articulation> DoorsOf(const SceneAnnotations& annotations, const Scene& scene) {
  const mjModel* m = scene.model();
  std::vector<Articulation> doors;
  for (const Articulation& joint : annotations.articulations) {
    const double range = joint.range[1] - joint.range[0];
    if (joint.kind != ArticulationKind::kHinge || !(range >= kLeastSwing) ||
        !std::isfinite(range) || std::abs(joint.axis.normalized().z()) < kUpright)
      continue;
    const int body = FindId(m, mjOBJ_BODY, joint.body);
    if (body < 0 || FindId(m, mjOBJ_JOINT, joint.joint) < 0) continue;
    if (HeightOf(m, scene.data(), GeomsOf(m, body)) >= kLeastDoorHeight) doors.push_back(joint);
  }
  return doors;
}

std::vector<double> SwingOf(const Articulation& door) {
  const double last = door.range[0] + std::min(door.range[1] - door.range[0], kTurn);
  return Positions(door.range[0], last, kSwingStep);
}

std::optional<Refusal> ValidateDoorSwings(Scene& scene, const Robot& robot,
                                          const std::vector<Articulation>& doors,
                                          double clearance) {
  const mjModel* m = scene.model();
  mjData* d = scene.data();
  for (const Articulation& door : doors) {
    const std::vector<int> leaf =
        GeomsOf(m, RequireId(m, mjOBJ_BODY, door.body, "a door of the scene"));
    const int joint = RequireId(m, mjOBJ_JOINT, door.joint, "a door of the scene");
    double radius = 0;
    ForEachCorner(m, d, leaf, [&](const Eigen::Vector3d& corner) {
      radius = std::max(radius, (corner - door.anchor).head<2>().norm());
    });
    std::vector<int> near;
    for (const int g : robot.collision_geom_ids()) {
      const Eigen::Vector3d at(d->geom_xpos + 3 * g);
      if ((at - door.anchor).head<2>().norm() < radius + m->geom_rbound[g] + clearance)
        near.push_back(g);
    }
    if (near.empty()) continue;
    const std::string why = WhyInTheWay(scene, near, leaf, joint, SwingOf(door), clearance);
    if (!why.empty()) return Refusal{Refusal::kInDoorSwing, why};
  }
  return std::nullopt;
}

std::optional<Refusal> ValidateMovedJoint(Scene& scene, const Robot& robot,
                                          const JointOpening& opening, double share,
                                          double clearance) {
  const mjModel* m = scene.model();
  const int joint = opening.joint_id();
  // What the arm moves goes along.
  int arm = -1;
  if (!robot.joint_names().empty())
    arm = m->jnt_bodyid[RequireId(m, mjOBJ_JOINT, robot.joint_names().front(),
                                  "robot '" + robot.name() + "'")];
  std::vector<int> base;
  for (const int g : robot.collision_geom_ids())
    if (arm < 0 || !IsInSubtree(m, m->geom_bodyid[g], arm)) base.push_back(g);
  const double step = m->jnt_type[joint] == mjJNT_HINGE ? kSwingStep : kSlideStep;
  const std::string why =
      WhyInTheWay(scene, base, GeomsOf(m, opening.body_id()), joint,
                  Positions(opening.position(), opening.PositionAt(share), step), clearance);
  if (why.empty()) return std::nullopt;
  return Refusal{Refusal::kInDoorSwing, why};
}

}  // namespace robocell::internal
