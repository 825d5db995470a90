#include "robocell/task/hand_geometry.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include "robocell/base/rng.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/guard.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/robot/finger.h"
#include "robocell/robot/gripper_group.h"
#include "robocell/task/convex_solid.h"
#include "robocell/task/geometry_text.h"
#include "robocell/task/surface_points.h"

namespace robocell::internal {
namespace {

void WriteGeom(mjData* d, int geom, const Pose& at) {
  Eigen::Map<Eigen::Vector3d>(d->geom_xpos + 3 * geom) = at.translation();
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(d->geom_xmat + 9 * geom) = at.rotation();
}

}  // namespace

HandGeometry::HandGeometry(const Robot& robot, std::shared_ptr<const GripperShape> shape)
    : robot_(robot), shape_(std::move(shape)), model_(robot.scene().model()) {
  const mjModel* m = model_;
  const std::string place = "robot '" + robot.name() + "'";
  const int last = m->jnt_bodyid[RequireId(m, mjOBJ_JOINT, robot.joint_names().back(), place)];
  is_robot_.assign(static_cast<size_t>(m->ngeom), 0);
  for (const int g : robot.geom_ids()) is_robot_[static_cast<size_t>(g)] = 1;
  for (const int g : robot.collision_geom_ids()) {
    if (IsCollisionGeom(m, g) && IsInSubtree(m, m->geom_bodyid[g], last)) geoms_.push_back(g);
  }
  FindFingers();
  thinnest_ = geoms_.empty() ? 0 : std::numeric_limits<double>::infinity();
  for (const int g : geoms_)  // the half sizes of its box follow the centre
    thinnest_ = std::min(thinnest_,
                         2 * *std::min_element(m->geom_aabb + 6 * g + 3, m->geom_aabb + 6 * g + 6));
  data_ = MakeData(m);
  Update();
  std::vector<int> addresses;
  for (const std::string& name : shape_->joint_names())
    addresses.push_back(m->jnt_qposadr[RequireId(m, mjOBJ_JOINT, robot.prefix() + name, place)]);
  const Pose world_in_tcp = robot.tcp_in_world().inverse();
  mjData* d = data_.get();
  for (const GripperShape::Row& row : shape_->rows()) {
    for (size_t i = 0; i < addresses.size(); ++i) d->qpos[addresses[i]] = row.joints[i];
    Guarded("hand geometry: kinematics", d, [&] { mj_kinematics(m, d); });
    std::vector<Pose>& poses = in_tcp_.emplace_back();
    for (const int g : geoms_) {
      poses.push_back(RoundedPose(world_in_tcp * Pose::FromTranslationAndMatrix(
                                                     d->geom_xpos + 3 * g, d->geom_xmat + 9 * g)));
    }
  }
  Update();
}

// Fingers are the branches of the hand's tree that carry a gripping part.
void HandGeometry::FindFingers() {
  finger_of_.assign(geoms_.size(), -1);
  const auto* gripper = dynamic_cast<const ActuatedGripper*>(&robot_.gripper());
  if (!gripper) return;
  const mjModel* m = model_;
  const int hand = gripper->hand_body();
  const auto branch_of = [&](int body) {
    while (body > 0 && m->body_parentid[body] != hand) body = m->body_parentid[body];
    return body;
  };
  std::vector<int> branches;
  for (const int side : {0, 1}) {
    const Finger& finger = gripper->finger(side);
    for (const int g : finger.geoms) {
      const int branch = branch_of(m->geom_bodyid[g]);
      if (branch > 0 && std::ranges::find(branches, branch) == branches.end())
        branches.push_back(branch);
    }
  }
  finger_count_ = static_cast<int>(branches.size());
  for (size_t i = 0; i < geoms_.size(); ++i) {
    const auto at = std::ranges::find(branches, branch_of(m->geom_bodyid[geoms_[i]]));
    if (at != branches.end()) finger_of_[i] = static_cast<int>(at - branches.begin());
  }
}

void HandGeometry::Update() {
  robot_.scene().SyncPoses();
  const mjData* now = robot_.scene().data();
  mjData* d = data_.get();
  const mjModel* m = model_;
  std::copy_n(now->qpos, m->nq, d->qpos);
  std::copy_n(now->mocap_pos, 3 * m->nmocap, d->mocap_pos);
  std::copy_n(now->mocap_quat, 4 * m->nmocap, d->mocap_quat);
  Guarded("hand geometry: kinematics", d, [&] {
    mj_kinematics(m, d);
    mj_comPos(m, d);
  });
}

void HandGeometry::PlaceIn(const Pose& frame, const std::vector<int>& others) {
  mjData* d = data_.get();
  for (const int g : others) {
    const Pose at = RoundedPose(frame.inverse() * Pose::FromTranslationAndMatrix(
                                                      d->geom_xpos + 3 * g, d->geom_xmat + 9 * g));
    WriteGeom(d, g, at);
  }
}

std::string HandGeometry::Description() const {
  std::string text;
  for (size_t i = 0; i < geoms_.size(); ++i) {
    AppendGeomShape(model_, geoms_[i], &text);
    for (const std::vector<Pose>& poses : in_tcp_) AppendPose(poses[i], &text);
  }
  for (const GripperShape::Row& row : shape_->rows()) {
    AppendNumbers(std::array{row.gap, row.pad.x(), row.pad.y(), row.pad.z(), row.tip}, &text);
  }
  AppendPose(RoundedPose(shape_->grasp_in_tcp()), &text);
  AppendNumbers(std::array{shape_->pad_half_height(), shape_->pad_half_width()}, &text);
  return text;
}

void HandGeometry::PlaceGeoms(const Pose& tcp, double gap) const {
  const std::vector<GripperShape::Row>& rows = shape_->rows();
  const auto above = std::ranges::upper_bound(rows, gap, {}, &GripperShape::Row::gap);
  const size_t high = std::min(static_cast<size_t>(above - rows.begin()), rows.size() - 1);
  const size_t low = above == rows.begin() ? 0 : static_cast<size_t>(above - rows.begin()) - 1;
  const double part = high == low ? 0 : (gap - rows[low].gap) / (rows[high].gap - rows[low].gap);
  mjData* d = data_.get();
  for (size_t i = 0; i < geoms_.size(); ++i) {
    const Pose at = tcp * in_tcp_[low][i].interpolate(in_tcp_[high][i], part);
    WriteGeom(d, geoms_[i], at);
  }
}

bool HandGeometry::IsFree(const HandPlace& place, const std::vector<int>& others) {
  PlaceGeoms(place.tcp_in_world, place.gap);
  const mjModel* m = model_;
  mjData* d = data_.get();
  obstacle_ = -1;
  for (const int own : geoms_) {
    for (const int other : others) {
      if (m->geom_rbound[other] > 0) {  // not a plane
        const double far = m->geom_rbound[own] + m->geom_rbound[other] + place.clearance;
        if (mju_dist3(d->geom_xpos + 3 * own, d->geom_xpos + 3 * other) > far) continue;
      }
      const double distance = Guarded("hand geometry: distance", d, [&] {
        return mj_geomDistance(m, d, own, other, place.clearance + 1e-3, nullptr);
      });
      if (distance >= place.clearance) continue;
      obstacle_ = other;
      return false;
    }
  }
  return true;
}

double HandGeometry::FingerDistance(int finger, size_t row, const Pose& tcp,
                                    const std::vector<int>& others, Eigen::Vector3d* normal) {
  constexpr double kHorizon = 0.02;  // m
  const mjModel* m = model_;
  mjData* d = data_.get();
  double least = kHorizon;
  for (size_t i = 0; i < geoms_.size(); ++i) {
    if (finger_of_[i] != finger) continue;
    WriteGeom(d, geoms_[i], tcp * in_tcp_[row][i]);
    for (const int other : others) {
      const double far = m->geom_rbound[other] + m->geom_rbound[geoms_[i]] + kHorizon;
      if (m->geom_rbound[other] > 0 &&
          mju_dist3(d->geom_xpos + 3 * geoms_[i], d->geom_xpos + 3 * other) > far)
        continue;
      mjtNum segment[6];
      const double distance = Guarded("hand geometry: distance of a finger", d, [&] {
        return mj_geomDistance(m, d, geoms_[i], other, kHorizon, segment);
      });
      if (distance >= least) continue;
      least = distance;
      const Eigen::Map<const Eigen::Vector3d> from(segment), to(segment + 3);
      const Eigen::Vector3d way = distance > 0 ? from - to : to - from;
      if (way.norm() > 1e-9) *normal = way.normalized();
    }
  }
  return least;
}

std::vector<FingerStop> HandGeometry::Close(const Pose& tcp, double gap,
                                            const std::vector<int>& others) {
  const std::vector<GripperShape::Row>& rows = shape_->rows();
  const auto above = std::ranges::upper_bound(rows, gap + 1e-9, {}, &GripperShape::Row::gap);
  const auto first = static_cast<size_t>(std::max<ptrdiff_t>(above - rows.begin() - 1, 0));
  std::vector<FingerStop> stops(static_cast<size_t>(finger_count_));
  for (int finger = 0; finger < finger_count_; ++finger) {
    FingerStop& stop = stops[static_cast<size_t>(finger)];
    for (size_t row = first + 1; row-- > 0;) {
      Eigen::Vector3d normal = stop.normal;
      const double distance = FingerDistance(finger, row, tcp, others, &normal);
      stop.gap = rows[row].gap;
      stop.normal = normal;
      stop.touches = distance <= 0;
      if (stop.touches) break;
    }
  }
  return stops;
}

Eigen::Matrix3Xd HandGeometry::SurfacePoints(double gap, int count) const {
  PlaceGeoms(Pose(), gap);
  const BodySolids solids(model_, data_.get(), Pose(), geoms_);
  Rng rng = Rng::Stream(0, "points of a hand");
  Eigen::Matrix3Xd points(3, count);
  SurfaceSampler sampler(solids, solids, rng);
  for (int i = 0; i < count; ++i) {
    const auto point = sampler.Next();
    if (!point) return Eigen::Matrix3Xd(3, 0);
    points.col(i) = point->at;
  }
  return points;
}

}  // namespace robocell::internal
