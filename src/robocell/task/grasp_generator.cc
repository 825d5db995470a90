#include "robocell/task/grasp_generator.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/motion/geom_extent.h"
#include "robocell/mujoco/names.h"
#include "robocell/mujoco/tree.h"
#include "robocell/scenes/handle_geoms.h"
#include "robocell/task/geometry_text.h"
#include "robocell/task/grasp_proposals.h"
#include "robocell/task/grasp_request.h"
#include "robocell/task/grasped_body.h"

namespace robocell {
namespace {

using internal::GraspProposal;
using internal::GraspTarget;
using internal::HandGeometry;

constexpr double kSameGraspTurn = 0.15,
                 kSameGraspPlace = 0.004;  // rad and m: nearer grasps count as one
// The hand is checked along the approach at places that are as far apart as its thinnest geom is
// thick, within these limits, m: no part of the object passes between two of them.
constexpr double kNearestPlaces = 0.004, kFarthestPlaces = 0.02;
// Proposals that are checked with the hand's geometry: some, and so many for each grasp that is kept.
constexpr size_t kSomeChecks = 1000, kChecksPerGrasp = 20;
constexpr int kLeastFingers = 3;          // that touch in an enclosing grasp
constexpr double kMostUnbalanced = 0.45;  // length of the mean of their normals

// Selects among proposals, best first, with the hand's real geometry.
class GraspFilter {
 public:
  // `geoms`: of the object, which `hand` has in the frame of the body.
  GraspFilter(HandGeometry& hand, std::vector<int> geoms, const GraspOptions& options)
      : hand_(hand),
        all_(std::move(geoms)),
        options_(options),
        step_(std::clamp(hand.thinnest(), kNearestPlaces, kFarthestPlaces)) {}

  std::vector<Grasp> Run(std::vector<GraspProposal> proposals) {
    std::stable_sort(proposals.begin(), proposals.end(),
                     [](const auto& a, const auto& b) { return a.grasp.score > b.grasp.score; });
    // Half of them are shared evenly between the kinds, the others are the best of all.
    std::map<GraspKind, size_t> counts;
    for (const GraspProposal& proposal : proposals) ++counts[proposal.grasp.kind];
    const size_t most = static_cast<size_t>(options_.most);
    const size_t share = counts.size() > 1 ? most / (2 * counts.size()) : 0;
    const size_t checks = kSomeChecks + kChecksPerGrasp * most;
    std::vector<char> looked_at(proposals.size(), 0);
    for (auto& [kind, count] : counts) {
      count = 0;
      const size_t end = checks_ + checks / (2 * counts.size());
      for (size_t i = 0; i < proposals.size() && count < share && checks_ < end; ++i) {
        if (proposals[i].grasp.kind != kind) continue;
        looked_at[i] = 1;
        count += Keep(proposals[i]);
      }
    }
    for (size_t i = 0; i < proposals.size() && kept_.size() < most && checks_ < checks; ++i) {
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
    if (known) return false;
    ++checks_;
    if (!IsFree(proposal)) return false;
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
    const int steps = static_cast<int>(std::ceil(grasp.approach_length / step_));
    for (int k = 1; k <= steps; ++k) {
      const double back = grasp.approach_length * k / steps;
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
  double step_;        // m between places along the approach
  size_t checks_ = 0;  // proposals checked so far
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
  const internal::GraspRequest request = internal::CheckedRequest(robot, body, options);
  const internal::GraspedBody& grasped = request.grasped;
  const Scene scene = robot.scene();
  const mjModel* m = scene.model();
  HandGeometry hand(robot, request.shape);

  const mjData* d = hand.data();
  const Pose body_in_world =
      Pose::FromTranslationAndMatrix(d->xpos + 3 * grasped.body, d->xmat + 9 * grasped.body);
  GraspTarget target;
  target.all = internal::BodySolids(m, d, body_in_world, grasped.geoms);
  if (target.all.empty()) return {.robot = robot.name(), .body = grasped.name, .grasps = {}};
  // Rounded, like the geometry: the same wherever the object is.
  target.com = internal::RoundedPose(Pose(body_in_world.inverse() *
                                          Eigen::Vector3d(d->subtree_com + 3 * grasped.body)))
                   .translation();
  const auto is_chosen = [&](int g) {
    return request.geoms.empty() || std::ranges::find(request.geoms, g) != request.geoms.end();
  };
  const auto flags = [&](const std::vector<int>& geoms) {
    std::vector<char> flags(static_cast<size_t>(m->ngeom), 0);
    for (const int g : geoms) flags[static_cast<size_t>(g)] = 1;
    return flags;
  };
  // Geoms that the caller names are handles if kHandle is asked for, whatever their names are. A
  // handle that is named for other kinds of grasps is a part like any other.
  using enum GraspKind;
  std::vector<int> handles, known_handles;
  const bool names_handles = std::ranges::find(options.kinds, kHandle) != options.kinds.end();
  for (const int g : grasped.geoms) {
    const bool by_name = internal::IsHandleGeom(scene, g);
    if (is_chosen(g) && (by_name || (names_handles && !request.geoms.empty())))
      handles.push_back(g);
    if (by_name && (request.Wants(kHandle) || request.geoms.empty() || !is_chosen(g)))
      known_handles.push_back(g);
  }
  const auto want = [&](const std::vector<int>& geoms) {
    target.is_wanted = flags(geoms);
    target.wanted = internal::BodySolids(m, d, body_in_world, geoms);
  };

  const Rng rng = Rng::Stream(options.seed, "grasps");
  std::vector<GraspProposal> proposals;
  const auto add = [&](std::vector<GraspProposal> more, bool of_handles = false) {
    std::erase_if(more, [&](const GraspProposal& p) {
      return !request.Wants(p.grasp.kind) || (p.grasp.kind == kHandle) != of_handles;
    });
    proposals.insert(proposals.end(), more.begin(), more.end());
  };
  const std::vector<int>& whole = request.geoms.empty() ? grasped.geoms : request.geoms;
  if (request.Wants(kTop) || request.Wants(kSide) || request.Wants(kAntipodal) ||
      request.Wants(kRim)) {
    want(whole);
    target.is_handle = flags(known_handles);
    add(internal::ProposeTwoFingerGrasps(target, hand, options, rng.Fork("two fingers")));
  }
  if (request.Wants(kHandle) && !handles.empty()) {  // they are a small part of the whole surface
    want(handles);
    target.is_handle = flags(handles);
    add(internal::ProposeTwoFingerGrasps(target, hand, options, rng.Fork("handles")), true);
  }
  if (request.Wants(kEnclosing) && hand.finger_count() >= kLeastFingers) {
    want(whole);
    add(internal::ProposeEnclosingGrasps(target, hand, options, rng.Fork("enclosing")));
  }
  if (request.Wants(kSuction)) {
    want(whole);
    add(internal::ProposeSuctionGrasps(target, hand, options, rng.Fork("suction")));
  }
  if (request.Wants(kPush)) {
    want(whole);
    add(internal::ProposePushes(target, hand, options, rng.Fork("push")));
  }
  if (request.Wants(kHook)) {
    want(handles.empty() || !request.geoms.empty() ? whole : handles);
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
