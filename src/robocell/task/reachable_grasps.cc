#include "robocell/task/reachable_grasps.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/motion/geom_extent.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/motion/planning_scene.h"
#include "robocell/motion/vertical_line.h"
#include "robocell/robot/task_space.h"
#include "robocell/task/grasped_body.h"
#include "robocell/task/hand_geometry.h"

namespace robocell {
namespace {

constexpr size_t kReachBatch = 8;  // solved at once: usually one of the first is taken
constexpr int kReachRestarts = 40;
constexpr double kAlmostTouching =
    0.003;  // m: fingers stop this far before they close on the object

class ReachSearch {
 public:
  ReachSearch(const Robot& robot, const GraspSet& grasps, const ReachOptions& options)
      : robot_(robot),
        scene_(robot.scene()),
        grasps_(grasps),
        options_(options),
        shape_(GripperShape::Of(robot.config(), scene_.spec().options, scene_.timestep())),
        hand_(robot, shape_),
        planning_(scene_, robot, internal::FindGraspedBody(scene_, grasps.body).name, shape_),
        body_in_world_(scene_.body_pose(planning_name())),
        world_in_base_(robot.base_in_world().inverse()),
        task_(internal::TaskSpaceOf(robot)),
        present_(robot.arm().joint_pos()) {
    const mjModel* m = scene_.model();
    const internal::GraspedBody grasped = internal::FindGraspedBody(scene_, grasps.body);
    for (int g = 0; g < m->ngeom; ++g) {
      if (internal::IsCollisionGeom(m, g) && !hand_.is_robot()[static_cast<size_t>(g)] &&
          std::ranges::find(grasped.geoms, g) == grasped.geoms.end())
        others_.push_back(g);
    }
  }

  ReachReport Run() {
    planning_.Update();
    Sort();
    size_t next = 0;
    while (next < order_.size() && tried_ < options_.tried && !Enough()) {
      std::vector<Candidate> batch;
      for (; next < order_.size() && batch.size() < kReachBatch && tried_ < options_.tried;
           ++next) {
        ++tried_;
        if (HandIsFree(order_[next])) {
          batch.push_back(order_[next]);
        } else {
          ++report_.hand_in_collision;
        }
      }
      Solve(batch);
    }
    return std::move(report_);
  }

 private:
  struct Candidate {
    int index = -1;
    Pose tcp_in_world;
    double cost = 0;
  };

  std::string planning_name() const { return internal::FindGraspedBody(scene_, grasps_.body).name; }
  bool Enough() const { return report_.found.size() >= static_cast<size_t>(options_.most); }

  void Sort() {
    const Pose now = robot_.tcp_in_world();
    const Eigen::Matrix3d axes = body_in_world_.rotation();
    for (size_t i = 0; i < grasps_.grasps.size(); ++i) {
      const Grasp& grasp = grasps_.grasps[i];
      const Pose tcp = body_in_world_ * grasp.tcp_in_body;
      const GraspCosts& costs = options_.costs;
      const double cost = costs.score * (1 - grasp.score) +
                          costs.turn * AngleBetween(now.quaternion(), tcp.quaternion()) +
                          costs.distance * (now.translation() - tcp.translation()).norm() +
                          costs.level * (1 + (axes * grasp.approach).z());
      order_.push_back({.index = static_cast<int>(i), .tcp_in_world = tcp, .cost = cost});
    }
    std::ranges::stable_sort(order_, {}, &Candidate::cost);
  }

  const Grasp& GraspOf(const Candidate& candidate) const {
    return grasps_.grasps[static_cast<size_t>(candidate.index)];
  }

  bool HandIsFree(const Candidate& candidate) {
    const Grasp& grasp = GraspOf(candidate);
    const Pose before = body_in_world_ * grasp.before();
    return hand_.IsFree({.tcp_in_world = candidate.tcp_in_world,
                         .gap = grasp.opening,
                         .clearance = options_.clearance},
                        others_) &&
           hand_.IsFree(
               {.tcp_in_world = before, .gap = grasp.opening, .clearance = options_.clearance},
               others_);
  }

  void Solve(const std::vector<Candidate>& batch) {
    if (batch.empty()) return;
    std::vector<Pose> targets;
    for (const Candidate& candidate : batch)
      targets.push_back(world_in_base_ * candidate.tcp_in_world);
    IkBatchOptions options;
    options.ik.tolerance = internal::kLineIkTolerance;
    options.ik.prefer = IkPrefer::kSeed;
    options.ik.max_restarts = kReachRestarts;
    const Chain& chain = robot_.chain();
    const IkBatchResult result = IkBatch(chain, targets, present_, options);
    for (int b = 0; b < result.size && !Enough(); ++b) {
      const auto i = static_cast<size_t>(b);
      std::optional<JointVector> q;
      if (result.success[i]) {
        q = JointVector(result.row(b));
      } else {
        const IkResult near = task_.SolveWithin(chain, targets[i], present_, internal::kMostTilt);
        if (near.success) q = near.q;
      }
      if (q) {
        Follow(batch[i], *q);
      } else {
        ++report_.out_of_reach;
      }
    }
  }

  // Follows the approach and the lift, and keeps the grasp if both are free.
  void Follow(const Candidate& candidate, const JointVector& q) {
    const Grasp& grasp = GraspOf(candidate);
    const Chain& chain = robot_.chain();
    const Pose tcp =
        task_.is_partial(chain) ? chain.Fk(q) : world_in_base_ * candidate.tcp_in_world;
    const Eigen::Vector3d back =
        -(Rotate(world_in_base_.quaternion(), Rotate(body_in_world_.quaternion(), grasp.approach)));
    JointPath way = {q}, up;
    if (grasp.approach_length > 0) {
      way = internal::LineAbove(chain, task_, tcp, q, back, grasp.approach_length);
      if (internal::MissingShare(way) > 0) {
        ++report_.way_out_of_reach;
        return;
      }
    }
    if (options_.lift > 0) {
      up = internal::LineAbove(chain, task_, tcp, q,
                               Rotate(world_in_base_.quaternion(), Eigen::Vector3d::UnitZ()),
                               options_.lift);
      if (internal::MissingShare(up) > 0) {
        ++report_.way_out_of_reach;
        return;
      }
    }
    const bool touches = grasp.kind == GraspKind::kSuction;
    const bool closes = grasp.width > 0;
    const double before =
        std::min(grasp.opening, grasp.width + grasp.aside + shape_->closed_gap() + kAlmostTouching);
    const auto is_free = [&](const JointVector& at, double gap, bool touch) {
      return planning_.IsFree(at,
                              {.gap = gap, .clearance = options_.clearance, .touch_target = touch});
    };
    // Beside the object, the hand is nearer to it than to everything else.
    bool free = is_free(q, grasp.opening, true) && (!closes || is_free(q, before, true)) &&
                (touches || planning_.IsFree(q, {.gap = grasp.opening}));
    for (size_t i = 1; i < way.size() && free; ++i)
      free =
          planning_.IsFree(way[i], {.gap = grasp.opening}) && is_free(way[i], grasp.opening, true);
    for (size_t i = 1; i < up.size() && free; ++i)
      free = is_free(up[i], closes ? grasp.width : grasp.opening, true);
    if (!free) {
      ++report_.in_collision;
      return;
    }
    std::ranges::reverse(way);
    report_.found.push_back({.grasp = grasp,
                             .index = candidate.index,
                             .tcp_in_world = candidate.tcp_in_world,
                             .way = std::move(way),
                             .up = std::move(up),
                             .cost = candidate.cost});
  }

  Robot robot_;
  Scene scene_;
  const GraspSet& grasps_;
  const ReachOptions& options_;
  std::shared_ptr<const GripperShape> shape_;
  internal::HandGeometry hand_;
  PlanningScene planning_;
  Pose body_in_world_, world_in_base_;
  const internal::TaskSpace task_;
  std::vector<double> present_;
  std::vector<int> others_;  // geoms that are neither the robot's nor the object's
  std::vector<Candidate> order_;
  int tried_ = 0;
  ReachReport report_;
};

void RequireReachOptions(const ReachOptions& options, const std::string& place) {
  const auto require = [&](bool ok, const char* field, const char* rule) {
    if (!ok) throw ArgumentError(fmt::format("{}: {} must be {}", place, field, rule));
  };
  require(options.most >= 1, "most", "at least 1");
  require(options.tried >= 1, "tried", "at least 1");
  require(options.clearance >= 0 && options.clearance <= 1, "clearance", "from 0 to 1 m");
  require(options.lift >= 0 && options.lift <= 10, "lift", "from 0 to 10 m");
  const GraspCosts& costs = options.costs;
  for (const double cost : {costs.score, costs.turn, costs.distance, costs.level})
    require(std::isfinite(cost), "costs", "finite");
}

// Grasps that a caller made may lack what generated and loaded ones have.
void RequireWholeGrasps(const GraspSet& grasps, const std::string& place) {
  for (size_t i = 0; i < grasps.grasps.size(); ++i) {
    const Grasp& grasp = grasps.grasps[i];
    const auto fail = [&](const char* what) {
      throw ArgumentError(fmt::format("{}: grasps[{}] {}", place, i, what));
    };
    if (std::abs(grasp.approach.norm() - 1) > 1e-6) fail("has an approach that is no unit vector");
    if (!(grasp.approach_length >= 0)) fail("has an approach_length below 0");
    if (!(grasp.opening >= 0)) fail("has an opening below 0: give the gap of the open hand");
    if (!(grasp.width >= 0)) fail("has a width below 0");
  }
}

}  // namespace

std::string ReachReport::Reasons() const {
  std::string text;
  const auto add = [&](int count, const char* what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
  };
  add(static_cast<int>(found.size()), "in reach");
  add(hand_in_collision, "with the hand in collision");
  add(out_of_reach, "out of reach");
  add(way_out_of_reach, "whose approach or lift is out of reach");
  add(in_collision, "with the robot in collision");
  return text.empty() ? "no grasps" : text;
}

ReachReport FindReachableGrasps(const Robot& robot, const GraspSet& grasps,
                                const ReachOptions& options) {
  const std::string place = "reachable grasps of '" + grasps.body + "' by '" + robot.name() + "'";
  RequireReachOptions(options, place);
  if (grasps.robot != robot.name()) {
    throw ArgumentError(fmt::format(
        "{}: the grasps are those of {}. Compute them for '{}'", place,
        grasps.robot.empty() ? "no robot" : "robot '" + grasps.robot + "'", robot.name()));
  }
  RequireWholeGrasps(grasps, place);
  if (grasps.grasps.empty()) return {};
  return ReachSearch(robot, grasps, options).Run();
}

std::vector<MotionGoal> GoalsBefore(const Scene& scene, const GraspSet& grasps, int most) {
  RequireWholeGrasps(grasps, "goals of grasps of '" + grasps.body + "'");
  const Pose body_in_world = scene.body_pose(grasps.body);
  std::vector<MotionGoal> goals;
  for (const Grasp& grasp : grasps.grasps) {
    if (goals.size() >= static_cast<size_t>(std::max(most, 0))) break;
    goals.push_back(MotionGoal::Tcp(body_in_world * grasp.before()));
  }
  return goals;
}

}  // namespace robocell
