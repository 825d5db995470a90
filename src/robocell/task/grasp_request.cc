#include "robocell/task/grasp_request.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

#include "robocell/base/error.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

// More would take minutes and gigabytes, and find no better grasps.
constexpr int kMostSamples = 50'000, kMostGrasps = 2'000;
constexpr double kTopCosine = 0.7071, kSideSine = 0.5;  // of 45 and 30 degrees

void RequireOptions(const GraspOptions& options, const std::string& place) {
  const auto require = [&](bool ok, const char* field, const std::string& rule) {
    if (!ok) throw ArgumentError(fmt::format("{}: {} must be {}", place, field, rule));
  };
  require(options.samples > 0 && options.samples <= kMostSamples, "samples",
          fmt::format("from 1 to {}, got {}", kMostSamples, options.samples));
  require(options.most > 0 && options.most <= kMostGrasps, "most",
          fmt::format("from 1 to {}, got {}", kMostGrasps, options.most));
  require(options.friction > 0 && options.friction <= 10, "friction", "above 0 and at most 10");
  require(options.clearance >= 0 && options.clearance <= 0.05, "clearance", "from 0 to 0.05 m");
  require(options.approach_length >= 0 && options.approach_length <= 1, "approach_length",
          "from 0 to 1 m");
}

std::vector<GraspKind> KindsFor(const GraspOptions& options, const GripperShape& shape,
                                const std::string& place) {
  using enum GraspKind;
  if (options.kinds.empty()) {
    if (shape.is_suction()) return {kSuction};
    return {kTop, kSide, kAntipodal, kRim, kHandle, kEnclosing};
  }
  for (const GraspKind kind : options.kinds) {
    const bool of_cup = kind == kSuction;
    if (kind == kPush || kind == kHook || of_cup == shape.is_suction()) continue;
    throw ArgumentError(fmt::format("{}: grasps of kind '{}' need {}", place, ToString(kind),
                                    of_cup ? "a suction gripper, and this one has fingers"
                                           : "fingers, and this is a suction gripper"));
  }
  return options.kinds;
}

}  // namespace

bool GraspRequest::Wants(GraspKind kind) const {
  return std::ranges::find(kinds, kind) != kinds.end();
}

GraspRequest CheckedRequest(const Robot& robot, const std::string& body,
                            const GraspOptions& options) {
  const Scene scene = robot.scene();
  const mjModel* m = scene.model();
  const std::string place = "grasps of '" + body + "' by robot '" + robot.name() + "'";
  RequireOptions(options, place);
  GraspRequest request{
      .grasped = FindGraspedBody(scene, body), .shape = {}, .kinds = {}, .geoms = {}};
  request.shape = GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  request.kinds = KindsFor(options, *request.shape, place);
  for (const std::string& name : options.geoms) {
    const int g = RequireId(m, mjOBJ_GEOM, name, place);
    if (std::ranges::find(request.grasped.geoms, g) == request.grasped.geoms.end()) {
      throw ArgumentError(
          fmt::format("{}: {} is not a colliding part of the body, or of what is fixed to it. Name "
                      "the body that carries it",
                      place, Describe(m, mjOBJ_GEOM, g)));
    }
    request.geoms.push_back(g);
  }
  return request;
}

GraspKind KindOfApproach(const Eigen::Vector3d& approach) {
  if (-approach.z() >= kTopCosine) return GraspKind::kTop;
  return std::abs(approach.z()) <= kSideSine ? GraspKind::kSide : GraspKind::kAntipodal;
}

}  // namespace robocell::internal
