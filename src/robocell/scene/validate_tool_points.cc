// The tool centre point of a robot can be given in two ways, which must agree.
#include <fmt/format.h>

#include "robocell/base/error.h"
#include "robocell/math/pose.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/element_lookup.h"
#include "robocell/scene/validate_robot.h"

namespace robocell::internal {
namespace {

constexpr double kTolerance = 1e-5;  // m and rad; numbers in files are rounded

// A frame and the body it is welded to.
struct Point {
  Pose pose;
  int weld;
};

Point PointOf(const mjModel* model, const mjData* data, const ElementId& element) {
  if (element.kind == mjOBJ_BODY) {
    return {Pose::FromWxyz(data->xpos + 3 * element.id, data->xquat + 4 * element.id),
            model->body_weldid[element.id]};
  }
  return {Pose::FromTranslationAndMatrix(data->site_xpos + 3 * element.id,
                                         data->site_xmat + 9 * element.id),
          model->body_weldid[model->site_bodyid[element.id]]};
}

// Returns the leaf of the only arm; null if there are several arms or it has none.
const ElementRef* OnlyLeaf(const RobotRecord& robot) {
  const ElementRef* leaf = nullptr;
  int arms = 0;
  for (const auto& [name, group] : robot.config.move_groups.entries()) {
    if (group->kind != MoveGroupKind::kArm) continue;
    ++arms;
    if (group->leaf) leaf = &*group->leaf;
  }
  return arms == 1 ? leaf : nullptr;
}

void ValidateToolPoint(const mjModel* model, const mjData* data, const RobotRecord& robot,
                       CompileLog& log) {
  const ElementRef* leaf = OnlyLeaf(robot);
  if (!leaf || !robot.tcp_site) return;
  ElementId found;
  try {
    found = FindElement(model, robot, *leaf, {mjOBJ_SITE, mjOBJ_BODY});
  } catch (const NotFoundError&) {
    return;  // ValidateRobot reports it
  }
  const Point a = PointOf(model, data, found);
  const Point b = PointOf(model, data, {mjOBJ_SITE, FindId(model, mjOBJ_SITE, *robot.tcp_site)});
  if (a.weld == b.weld && a.pose.is_close(b.pose, kTolerance, kTolerance)) return;
  const Pose difference = a.pose.inverse() * b.pose;
  log.Problem("robot '" + robot.name + "'",
              fmt::format("the TCP is given twice: {} is the arm's leaf, but attachment_site * "
                          "tcp_offset is {:.6g} m and "
                          "{:.6g} rad away from it; keep one of them",
                          Describe(*leaf), difference.translation().norm(), difference.angle()),
              "tcp_offset");
}

}  // namespace

void ValidateToolPoints(const mjModel* model, const mjData* reference,
                        const std::vector<RobotRecord>& robots, CompileLog& log) {
  for (const RobotRecord& robot : robots) ValidateToolPoint(model, reference, robot, log);
}

}  // namespace robocell::internal
