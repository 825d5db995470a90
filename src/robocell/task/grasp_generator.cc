#include "robocell/task/grasp_generator.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scenes/handle_geoms.h"
#include "robocell/task/geometry_text.h"
#include "robocell/task/grasp_proposals.h"
#include "robocell/task/grasped_body.h"

namespace robocell {
namespace {

using internal::GraspProposal;
using internal::GraspTarget;
using internal::HandGeometry;

constexpr double kSameGraspTurn = 0.15,
                 kSameGraspPlace = 0.004;  // rad and m: nearer grasps count as one
constexpr int kApproachSteps = 4;
constexpr int kLeastFingers = 3;          // that touch in an enclosing grasp
constexpr double kMostUnbalanced = 0.45;  // length of the mean of their normals

void RequireGraspOptions(const GraspOptions& options, const std::string& place) {
  const auto require = [&](bool ok, const char* field, const std::string& rule) {
    if (!ok) throw ArgumentError(fmt::format("{}: {} must be {}", place, field, rule));
  };
  require(options.samples > 0, "samples", "at least 1");
  require(options.most > 0, "most", "at least 1");
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

// Selects among proposals, best first, with the hand's real geometry.
class GraspFilter {
 public:
  // `geoms`: of the object, which `hand` has in the frame of the body.
  GraspFilter(HandGeometry& hand, std::vector<int> geoms, const GraspOptions& options)
      : hand_(hand), all_(std::move(geoms)), options_(options) {}

  std::vector<Grasp> Run(std::vector<GraspProposal> proposals) {
    std::stable_sort(proposals.begin(), proposals.end(),
                     [](const auto& a, const auto& b) { return a.grasp.score > b.grasp.score; });
    // Half of them are shared evenly between the kinds, the others are the best of all.
    std::map<GraspKind, size_t> counts;
    for (const GraspProposal& proposal : proposals) ++counts[proposal.grasp.kind];
    const size_t most = static_cast<size_t>(options_.most);
    const size_t share = counts.size() > 1 ? most / (2 * counts.size()) : 0;
    std::vector<char> looked_at(proposals.size(), 0);
    for (auto& [kind, count] : counts) {
      count = 0;
      for (size_t i = 0; i < proposals.size() && count < share; ++i) {
        if (proposals[i].grasp.kind != kind) continue;
        looked_at[i] = 1;
        count += Keep(proposals[i]);
      }
    }
    for (size_t i = 0; i < proposals.size() && kept_.size() < most; ++i) {
      if (!looked_at[i]) Keep(proposals[i]);
    }
    // Closing changed some scores.
    std::ranges::stable_sort(kept_, std::ranges::greater(), &Grasp::score);
    return std::move(kept_);
  }

 private:
  // Returns true if the grasp was kept.
  bool Keep(const GraspProposal& proposal) {
    const Grasp& grasp = proposal.grasp;
    const bool known = std::ranges::any_of(kept_, [&](const Grasp& other) {
      return other.tcp_in_body.is_close(grasp.tcp_in_body, kSameGraspTurn, kSameGraspPlace);
    });
    if (known || !IsFree(proposal)) return false;
    if (grasp.kind != GraspKind::kEnclosing) {
      kept_.push_back(grasp);
      return true;
    }
    const std::optional<Grasp> closed = Close(grasp);
    if (closed) kept_.push_back(*closed);
    return closed.has_value();
  }

  bool IsFree(const GraspProposal& proposal) {
    const Grasp& grasp = proposal.grasp;
    const bool suction = grasp.kind == GraspKind::kSuction;
    const auto at = [&](double back) {
      return Pose(grasp.tcp_in_body.translation() - back * grasp.approach,
                  grasp.tcp_in_body.quaternion());
    };
    const bool closed = grasp.kind == GraspKind::kPush || grasp.kind == GraspKind::kHook;
    if (suction) {
      if (!hand_.IsFree({.tcp_in_world = at(proposal.press + 1e-4), .gap = 0}, all_)) return false;
    } else if (closed) {
      if (!hand_.IsFree({.tcp_in_world = at(0), .gap = grasp.opening}, all_)) return false;
    } else {
      // Beside the object, the open hand keeps the clearance; just before contact it is free.
      if (!hand_.IsFree(
              {.tcp_in_world = at(0), .gap = grasp.opening, .clearance = options_.clearance},
              all_) ||
          !hand_.IsFree({.tcp_in_world = at(0), .gap = proposal.gap_before}, all_))
        return false;
    }
    for (int k = 1; k <= kApproachSteps; ++k) {
      const double back = grasp.approach_length * k / kApproachSteps;
      const double clearance = closed || suction ? 0 : options_.clearance;
      if (!hand_.IsFree({.tcp_in_world = at(back), .gap = grasp.opening, .clearance = clearance},
                        all_))
        return false;
    }
    return true;
  }

  // Closes the fingers one by one. Unset unless three of them, or all, touch and their normals
  // balance: no side of the object is free.
  std::optional<Grasp> Close(const Grasp& grasp) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double gap = 0;
    int touching = 0;
    for (const internal::FingerStop& stop : hand_.Close(grasp.tcp_in_body, grasp.opening, all_)) {
      if (!stop.touches) continue;
      ++touching;
      sum += stop.normal;
      gap += stop.gap;
    }
    if (touching < kLeastFingers) return std::nullopt;
    const double unbalanced = sum.norm() / touching;
    if (unbalanced > kMostUnbalanced) return std::nullopt;
    Grasp closed = grasp;
    closed.width = gap / touching;
    closed.score = 0.5 * grasp.score + 0.5 * (1 - unbalanced);
    return closed;
  }

  HandGeometry& hand_;
  std::vector<int> all_;
  const GraspOptions& options_;
  std::vector<Grasp> kept_;
};

}  // namespace

std::vector<std::string> HandleGeomsOf(const Scene& scene, const std::string& body) {
  const mjModel* m = scene.model();
  const internal::GraspedBody grasped = internal::FindGraspedBody(scene, body);
  std::vector<std::string> names;
  for (const int g : grasped.geoms) {
    if (internal::IsHandleGeom(scene, g)) names.push_back(ElementName(m, mjOBJ_GEOM, g));
  }
  return names;
}

GraspSet GenerateGrasps(const Robot& robot, const std::string& body, const GraspOptions& options) {
  const Scene scene = robot.scene();
  const mjModel* m = scene.model();
  const std::string place = "grasps of '" + body + "' by robot '" + robot.name() + "'";
  RequireGraspOptions(options, place);
  const std::shared_ptr<const GripperShape> shape =
      GripperShape::Of(robot.config(), scene.spec().options, scene.timestep());
  const std::vector<GraspKind> kinds = KindsFor(options, *shape, place);
  const auto wants = [&](GraspKind kind) { return std::ranges::find(kinds, kind) != kinds.end(); };
  const internal::GraspedBody grasped = internal::FindGraspedBody(scene, body);
  HandGeometry hand(robot, shape);

  const mjData* d = hand.data();
  const Pose body_in_world =
      Pose::FromTranslationAndMatrix(d->xpos + 3 * grasped.body, d->xmat + 9 * grasped.body);
  GraspTarget target;
  target.is_handle.assign(static_cast<size_t>(m->ngeom), 0);
  std::vector<char> named(static_cast<size_t>(m->ngeom), 0);
  std::vector<int> chosen, handles;
  for (const std::string& name : options.geoms) {
    const int g = RequireId(m, mjOBJ_GEOM, name, place);
    if (std::ranges::find(grasped.geoms, g) == grasped.geoms.end()) {
      throw ArgumentError(
          fmt::format("{}: {} is not a colliding part of the body, or of what is fixed to it. Name "
                      "the body that "
                      "carries it",
                      place, Describe(m, mjOBJ_GEOM, g)));
    }
    chosen.push_back(g);
    target.is_handle[static_cast<size_t>(g)] = 1;
  }
  for (const int g : grasped.geoms) {
    if (internal::IsHandleGeom(scene, g)) target.is_handle[static_cast<size_t>(g)] = 1;
    if (target.is_handle[static_cast<size_t>(g)]) handles.push_back(g);
  }
  target.all = internal::BodySolids(m, d, body_in_world, grasped.geoms);
  if (target.all.empty()) return {.robot = robot.name(), .body = grasped.name, .grasps = {}};
  // Rounded, like the geometry: the same wherever the object is.
  target.com = internal::RoundedPose(Pose(body_in_world.inverse() *
                                          Eigen::Vector3d(d->subtree_com + 3 * grasped.body)))
                   .translation();
  const auto want = [&](const std::vector<int>& geoms) {
    target.is_wanted.assign(static_cast<size_t>(m->ngeom), 0);
    for (const int g : geoms) target.is_wanted[static_cast<size_t>(g)] = 1;
    target.wanted = internal::BodySolids(m, d, body_in_world, geoms);
  };

  const Rng rng = Rng::Stream(options.seed, "grasps");
  std::vector<GraspProposal> proposals;
  const auto add = [&](std::vector<GraspProposal> more) {
    std::erase_if(more, [&](const GraspProposal& p) { return !wants(p.grasp.kind); });
    proposals.insert(proposals.end(), more.begin(), more.end());
  };
  const std::vector<int>& whole = chosen.empty() ? grasped.geoms : chosen;
  using enum GraspKind;
  if (wants(kTop) || wants(kSide) || wants(kAntipodal) || wants(kRim)) {
    want(whole);
    add(internal::ProposeTwoFingerGrasps(target, hand, options, rng.Fork("two fingers")));
  }
  if (wants(kHandle) && !handles.empty()) {  // they are a small part of the whole surface
    want(handles);
    add(internal::ProposeTwoFingerGrasps(target, hand, options, rng.Fork("handles")));
  }
  if (wants(kEnclosing) && hand.finger_count() >= kLeastFingers) {
    want(whole);
    add(internal::ProposeEnclosingGrasps(target, hand, options, rng.Fork("enclosing")));
  }
  if (wants(kSuction)) {
    want(whole);
    add(internal::ProposeSuctionGrasps(target, hand, options, rng.Fork("suction")));
  }
  if (wants(kPush)) {
    want(whole);
    add(internal::ProposePushes(target, hand, options, rng.Fork("push")));
  }
  if (wants(kHook)) {
    want(handles.empty() ? whole : handles);
    add(internal::ProposeHooks(target, hand, options, rng.Fork("hook")));
  }
  std::vector<int> object = grasped.geoms;
  for (const int g : grasped.other_geoms)
    if (!hand.is_robot()[static_cast<size_t>(g)]) object.push_back(g);
  hand.PlaceIn(body_in_world, object);
  GraspFilter filter(hand, std::move(object), options);
  return {.robot = robot.name(), .body = grasped.name, .grasps = filter.Run(std::move(proposals))};
}

}  // namespace robocell
