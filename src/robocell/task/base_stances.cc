#include "robocell/task/base_stances.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "robocell/base/units.h"
#include "robocell/motion/clearance.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/motion/robot_outline.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/spec/robot_config.h"
#include "robocell/task/door_swings.h"

namespace robocell::internal {
namespace {

constexpr int kBearings = 72;  // directions in which a base pose is searched

Pose PoseOfGeom(const mjData* d, int geom) {
  return Pose::FromTranslationAndMatrix(d->geom_xpos + 3 * geom, d->geom_xmat + 9 * geom);
}

void WriteGeom(mjData* d, int geom, const Pose& pose) {
  Eigen::Map<Eigen::Vector3d>(d->geom_xpos + 3 * geom) = pose.translation();
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(d->geom_xmat + 9 * geom) =
      pose.rotation();
}

// Returns the box in the world around a box in a geom's frame.
Eigen::AlignedBox3d BoxAround(const Pose& geom, const Eigen::Vector3d& middle,
                              const Eigen::Vector3d& half) {
  const Eigen::Matrix3d axes = geom.rotation();
  const Eigen::Vector3d at = geom.translation() + axes * middle;
  const Eigen::Vector3d around = axes.cwiseAbs() * half;
  return {at - around, at + around};
}

Eigen::AlignedBox3d BoxOf(const mjModel* m, int geom, const Pose& pose, double margin) {
  if (m->geom_type[geom] == mjGEOM_PLANE) {
    const Eigen::Vector3d endless =
        Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    return {-endless, endless};
  }
  const mjtNum* box = m->geom_aabb + 6 * geom;
  return BoxAround(pose, Eigen::Vector3d(box),
                   Eigen::Vector3d(box + 3) + Eigen::Vector3d::Constant(margin));
}

}  // namespace

std::vector<Pose> BasesAround(const Robot& robot, const Support& support, const Pose& target,
                              const BasePlacement& placement, const StartConfig& start, Rng& rng) {
  const RobotOutline outline(robot);
  const double first = rng.Uniform(-kPi, kPi);
  const double height = robot.config().base.kind == BaseKind::kPlanar
                            ? robot.base().pose().translation().z()
                            : target.translation().z() + placement.height;
  const Pose mount = robot.base().pose().inverse() * robot.base_in_world();
  // An object on a high shelf is out of reach of an arm whose base stays on the floor. What is low does
  // not count: the origin of furniture lies at its foot, far from its handles.
  const auto reaches = [&](const Pose& base) {
    const Eigen::Vector3d away = target.translation() - (base * mount).translation();
    return robot.config().base.kind != BaseKind::kPlanar || away.z() <= 0 ||
           away.norm() <= kReachShare * robot.reach();
  };
  std::vector<Pose> bases;
  for (int i = 0; i < kBearings; ++i) {
    const double bearing = first + 2 * kPi * i / kBearings;
    const double turn = kPi + rng.Uniform(-start.base_facing_noise, start.base_facing_noise);
    const Eigen::Vector3d at(target.translation().x() + placement.distance * std::cos(bearing),
                             target.translation().y() + placement.distance * std::sin(bearing),
                             height);
    const Pose base = Pose::FromRpy(at, {0, 0, bearing + turn});
    if (reaches(base) && outline.IsClearOf(support.area(), base, start.base_clearance))
      bases.push_back(base);
  }
  return bases;
}

void PutBase(const Robot& robot, const Pose& base_in_world) {
  BaseGroup& base = robot.base();
  base.SetPose(base_in_world);
  if (robot.config().base.kind == BaseKind::kPlanar && robot.is_driven(base.name()))
    robot.controller(base.name()).Reset();
}

BaseStances::BaseStances(const Robot& robot, double clearance,
                         const std::vector<Articulation>& doors)
    : scene_(robot.scene()), clearance_(clearance) {
  const mjModel* m = scene_.model();
  const mjData* d = scene_.data();
  const Pose base = robot.base().pose();
  std::vector<char> own(static_cast<size_t>(m->ngeom), 0);
  for (const int g : robot.geom_ids()) own[static_cast<size_t>(g)] = 1;
  const FloorContact contact(robot);
  for (const int g : robot.collision_geom_ids()) {
    const bool on_mocap = m->body_mocapid[m->geom_bodyid[g]] >= 0;
    if (!IsCollisionGeom(m, g) && !on_mocap) continue;
    const mjtNum* box = m->geom_aabb + 6 * g;
    const Part part{.geom = g,
                    .in_base = base.inverse() * PoseOfGeom(d, g),
                    .box_middle = Eigen::Vector3d(box),
                    .box_half = Eigen::Vector3d(box + 3),
                    .may_touch_floor = contact.StandsOnFloors(g)};
    radius_ = std::max(
        radius_, part.in_base.translation().norm() + part.box_middle.norm() + part.box_half.norm());
    parts_.push_back(part);
  }
  for (int g = 0; g < m->ngeom; ++g) {
    if (own[static_cast<size_t>(g)] || !IsCollisionGeom(m, g)) continue;
    const Pose pose = PoseOfGeom(d, g);
    obstacles_.push_back({.geom = g,
                          .in_world = pose,
                          .box = BoxOf(m, g, pose, clearance),
                          .is_floor = contact.IsFloor(g)});
  }
  for (const Articulation& door : doors) AddSwing(door);
}

void BaseStances::AddSwing(const Articulation& door) {
  const mjModel* m = scene_.model();
  const mjData* d = scene_.data();
  const int joint = RequireId(m, mjOBJ_JOINT, door.joint, "a door of the scene");
  const int body = RequireId(m, mjOBJ_BODY, door.body, "a door of the scene");
  const double present = d->qpos[m->jnt_qposadr[joint]];
  const Eigen::Vector3d axis(d->xaxis + 3 * joint), anchor(d->xanchor + 3 * joint);
  for (const int g : CollisionGeomsOf(m, body)) {
    const Pose leaf = PoseOfGeom(d, g);
    for (const double at : SwingOf(door)) {
      const Pose turn(Eigen::Vector3d::Zero(),
                      Eigen::AngleAxisd(at - present, axis).toRotationMatrix());
      const Pose pose = Pose(anchor) * turn * Pose(-anchor) * leaf;
      obstacles_.push_back(
          {.geom = g, .in_world = pose, .box = BoxOf(m, g, pose, clearance_), .is_floor = false});
    }
  }
}

std::vector<bool> BaseStances::AreFree(std::span<const Pose> bases) {
  std::vector<bool> free(bases.size(), true);
  if (bases.empty() || parts_.empty()) return free;
  mjData* d = scene_.data();
  Eigen::AlignedBox3d asked;
  for (const Pose& base : bases) asked.extend(base.translation());
  asked.min().array() -= radius_;
  asked.max().array() += radius_;
  std::vector<const Obstacle*> near;
  for (const Obstacle& obstacle : obstacles_)
    if (obstacle.box.intersects(asked)) near.push_back(&obstacle);
  // Poses that are written for the engine's distances, and restored.
  struct Saved {
    int geom;
    std::array<mjtNum, 3> pos;
    std::array<mjtNum, 9> mat;
  };
  std::vector<Saved> saved;
  const auto save = [&](int g) {
    Saved each{.geom = g};
    std::copy_n(d->geom_xpos + 3 * g, 3, each.pos.begin());
    std::copy_n(d->geom_xmat + 9 * g, 9, each.mat.begin());
    saved.push_back(each);
  };
  for (const Part& part : parts_) save(part.geom);
  for (const Obstacle* obstacle : near) save(obstacle->geom);
  const std::shared_ptr<void> restore(nullptr, [&](void*) {
    for (const Saved& each : saved) {
      std::ranges::copy(each.pos, d->geom_xpos + 3 * each.geom);
      std::ranges::copy(each.mat, d->geom_xmat + 9 * each.geom);
    }
  });
  for (size_t i = 0; i < bases.size(); ++i) free[i] = IsFree(bases[i], near);
  return free;
}

bool BaseStances::IsFree(const Pose& base, std::span<const Obstacle* const> near) {
  const mjModel* m = scene_.model();
  mjData* d = scene_.data();
  for (const Part& part : parts_) {
    const Pose pose = base * part.in_base;
    const Eigen::AlignedBox3d box = BoxAround(pose, part.box_middle, part.box_half);
    bool is_written = false;
    for (const Obstacle* obstacle : near) {
      if (!obstacle->box.intersects(box)) continue;
      if (part.may_touch_floor && obstacle->is_floor) continue;
      if (!is_written) WriteGeom(d, part.geom, pose);
      is_written = true;
      WriteGeom(d, obstacle->geom, obstacle->in_world);
      const double distance = Guarded("distance of a robot at a stance", d, [&] {
        return mj_geomDistance(m, d, part.geom, obstacle->geom, clearance_, nullptr);
      });
      if (distance < clearance_) return false;
    }
  }
  return true;
}

}  // namespace robocell::internal
