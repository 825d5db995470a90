// Checks that an arm's TCP is where its gripper holds objects. Otherwise a site in another unit or
// on another body goes unnoticed: picking works all the same, but the poses and twists in a dataset
// belong to a point in empty space.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <limits>
#include <string>
#include <Eigen/Core>

#include "robocell/diagnose/trials.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/gripper_group.h"
#include "robocell/scene/tool_elements.h"

namespace robocell::internal {
namespace {

using Eigen::Vector3d;
using RowMatrix3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr const char* kOffset = "tcp_offset";
constexpr double kTcpFar = 0.15;  // metres: a TCP at the wrist is nearer, with most grippers

// The box around a geom.
struct GeomBox {
  Vector3d center, half;  // values in the geom's frame
  Vector3d pos;
  RowMatrix3d axes;

  GeomBox(const mjModel* m, const mjData* d, int geom)
      : center(Eigen::Map<const Vector3d>(m->geom_aabb + 6 * geom)),
        half(Eigen::Map<const Vector3d>(m->geom_aabb + 6 * geom + 3)),
        pos(Eigen::Map<const Vector3d>(d->geom_xpos + 3 * geom)),
        axes(Eigen::Map<const RowMatrix3d>(d->geom_xmat + 9 * geom)) {}

  double DistanceTo(const Vector3d& point) const {
    const Vector3d inside = axes.transpose() * (point - pos) - center;
    return (inside.cwiseAbs() - half).cwiseMax(0).norm();
  }
  Vector3d Middle() const { return pos + axes * center; }
};

double DistanceTo(const mjModel* m, const mjData* d, const Finger& finger, const Vector3d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const int site : finger.sites)
    nearest =
        std::min(nearest, (Eigen::Map<const Vector3d>(d->site_xpos + 3 * site) - point).norm());
  for (const int geom : finger.side)
    nearest = std::min(nearest, GeomBox(m, d, geom).DistanceTo(point));
  return nearest;
}

// Returns the middle of the geoms between which the finger distance is measured.
Vector3d MiddleOf(const mjModel* m, const mjData* d, const Finger& finger) {
  Vector3d sum = Vector3d::Zero();
  for (const int site : finger.sites) sum += Eigen::Map<const Vector3d>(d->site_xpos + 3 * site);
  if (!finger.sites.empty()) return sum / static_cast<double>(finger.sites.size());
  if (finger.geoms.empty()) return Eigen::Map<const Vector3d>(d->xpos + 3 * finger.body);
  for (const int geom : finger.geoms) sum += GeomBox(m, d, geom).Middle();
  return sum / static_cast<double>(finger.geoms.size());
}

std::string PlaceText(Vector3d p) {
  p = (p * 1e4).array().round() / 1e4 + 0.0;  // no -0
  return fmt::format("[{:.3g}, {:.3g}, {:.3g}]", p.x(), p.y(), p.z());
}

// Returns the field of the robot's file that puts the TCP of this arm where it is.
std::string FieldOfTcp(const Robot& robot, const MoveGroup& arm) {
  const auto& groups = robot.config().move_groups;
  const std::string leaf = "move_groups." + arm.name() + ".leaf";
  if (groups.contains(arm.name()) && groups.at(arm.name()).leaf) return leaf;
  const RobotRecord& record = robot.scene().compiled()->robot(robot.name());
  if (record.tcp_site) return kOffset;
  return record.attachment_site ? "attachment_site" : leaf;
}

// Warns of an arm whose TCP is farther than that, and than the fingers' distance, from both fingers
// of its gripper. Ignores arms without such a gripper.
void WarnOfFarTcp(const Robot& robot, const MoveGroup& arm, Findings& findings) {
  const std::string name = robot.gripper_of(arm.name());
  if (name.empty()) return;
  const auto* gripper = dynamic_cast<const ActuatedGripper*>(&robot.group(name));
  if (!gripper) return;
  const mjModel* m = robot.scene().model();
  const mjData* d = robot.scene().data();
  const Vector3d tcp = arm.leaf_frame_to_world().translation();
  const double distance = std::min(DistanceTo(m, d, gripper->finger(0), tcp),
                                   DistanceTo(m, d, gripper->finger(1), tcp));
  if (distance <= kTcpFar || distance <= gripper->inter_finger_dist()) return;

  const int hand = gripper->hand_body();
  const Vector3d origin = Eigen::Map<const Vector3d>(d->xpos + 3 * hand);
  const RowMatrix3d axes = Eigen::Map<const RowMatrix3d>(d->xmat + 9 * hand);
  const auto in_hand = [&](const Vector3d& p) {
    return PlaceText(axes.transpose() * (p - origin));
  };
  const std::string middle =
      in_hand((MiddleOf(m, d, gripper->finger(0)) + MiddleOf(m, d, gripper->finger(1))) / 2);
  std::string body = ElementName(m, mjOBJ_BODY, hand);
  if (body.starts_with(robot.prefix())) body.erase(0, robot.prefix().size());
  const CompiledScene& compiled = *robot.scene().compiled();
  const SiteAdvice advice = HowToAddSite(compiled, compiled.robot(robot.name()),
                                         ElementName(m, mjOBJ_BODY, hand), "tcp", middle);
  const std::string field = FieldOfTcp(robot, arm);
  const bool is_offset = field == kOffset;
  findings.WarnAbout(
      field,
      fmt::format(
          "the TCP is {:.3g} m away from the fingers of '{}', and commands and recordings use the "
          "TCP. In the frame of '{}' it is at {} m, and the middle between the fingers "
          "at {}: {}",
          distance, name, body, in_hand(tcp), middle,
          is_offset ? fmt::format("correct the offset, which begins at site '{}'",
                                  robot.config().attachment_site.value_or(""))
                    : fmt::format("name a site there ({})", advice.text)),
      is_offset ? "" : advice.edit);
}

}  // namespace

void TryTcpPlaces(Robot& robot, const TrialOptions&, Findings& findings) {
  for (const std::string& name : robot.group_names()) {
    const MoveGroup& group = robot.group(name);
    if (group.kind() == MoveGroupKind::kArm) WarnOfFarTcp(robot, group, findings);
  }
}

}  // namespace robocell::internal
