#include "robocell/motion/motion_planner.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "robocell/base/error.h"
#include "robocell/motion/collision_model.h"
#include "robocell/motion/goal_solver.h"
#include "robocell/motion/goal_trees.h"
#include "robocell/motion/path_judge.h"
#include "robocell/mujoco/names.h"

namespace robocell {
namespace {

using internal::CollisionModel;
using internal::PathJudge;
using internal::Rows;
using Clock = std::chrono::steady_clock;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kSlideUnit = 0.3;  // m of a slide that count like 1 rad
constexpr double kCheckStep = kDegree / 2;
constexpr int kBoldIterations = 300, kBoldConstrained = 3000;  // with a constraint steps are short
constexpr int kDirectGoals = 4;
constexpr int kIterationsBetweenPolls = 16;
// rad or m: joints may rest so far beyond their limits, which are soft.
constexpr double kStartSlack = 0.01;
constexpr double kLineStep = 1e-3;  // m
constexpr double kLineJump = 0.1;   // rad or m: more of a joint in one step is another branch
constexpr int kMostLineSteps = 20000;

void RequireOptions(const MotionOptions& options, const std::string& place) {
  if (!(options.clearance >= 0 && std::isfinite(options.clearance))) {
    throw ArgumentError(
        fmt::format("{}: clearance is {} m; it must be 0 or more", place, options.clearance));
  }
  if (!options.keep_axis) return;
  const AxisConstraint& keep = *options.keep_axis;
  if (!(keep.axis_in_tcp.norm() > 1e-9 && keep.axis_in_world.norm() > 1e-9 && keep.tolerance > 0))
    throw ArgumentError(place +
                        ": keep_axis needs two axes that are not 0, and a tolerance above 0");
}

std::vector<int> JointsOf(const Robot& robot, const MotionOptions& options,
                          const std::string& place) {
  std::vector<std::string> groups = options.groups;
  if (groups.empty()) groups.push_back(robot.arm().name());
  const mjModel* m = robot.scene().model();
  std::vector<int> joints;
  for (const std::string& name : groups) {
    for (const std::string& joint : robot.group(name).joint_names())
      joints.push_back(RequireId(m, mjOBJ_JOINT, joint, place));
  }
  if (joints.empty()) throw ArgumentError(place + ": the groups have no joints to plan for");
  return joints;
}

}  // namespace

std::string ToString(MotionFailure failure) {
  switch (failure) {
    case MotionFailure::kNone:
      return "none";
    case MotionFailure::kStartInCollision:
      return "start_in_collision";
    case MotionFailure::kStartBeyondLimits:
      return "start_beyond_limits";
    case MotionFailure::kStartAgainstConstraint:
      return "start_against_constraint";
    case MotionFailure::kGoalUnreachable:
      return "goal_unreachable";
    case MotionFailure::kGoalInCollision:
      return "goal_in_collision";
    case MotionFailure::kGoalAgainstConstraint:
      return "goal_against_constraint";
    case MotionFailure::kNoPath:
      return "no_path";
  }
  return "unknown";
}

struct MotionPlanner::State {
  State(const Robot& robot, const MotionOptions& o)
      : options(o),
        place("planning a motion of robot '" + robot.name() + "'"),
        model(robot, JointsOf(robot, o, place),
              {.clearance = o.clearance, .allowed = o.allowed_contacts, .attached = o.attached}) {
    for (const internal::MovingLinks::Dof& dof : model.links().dofs()) {
      names.push_back(ElementName(model.model(), mjOBJ_JOINT, dof.joint));
      limits.push_back({dof.lower, dof.upper});
    }
    Follow();
  }

  // What depends on the state of the scene.
  void Follow() {
    arms = internal::FindPlannedArms(model);
    axis.reset();
    if (!options.keep_axis) return;
    const AxisConstraint& keep = *options.keep_axis;
    const internal::PlannedArm& arm = internal::ArmNamed(arms, keep.arm, place);
    axis = {.chain = arm.chain,
            .dofs = arm.dofs,
            .present = internal::ChainValues(arm, model, model.present()),
            .in_tip = keep.axis_in_tcp.normalized(),
            .in_base = arm.base_in_world.rotation().transpose() * keep.axis_in_world.normalized(),
            .tolerance = keep.tolerance};
  }

  std::string NameOf(int dof) const { return "joint '" + names[dof] + "'"; }
  MotionResult Fail(MotionFailure failure, const std::string& why) const {
    MotionResult result{.failure = failure, .message = place + ": " + why};
    return result;
  }
  std::optional<MotionResult> CheckStart(std::span<const double> start);
  internal::JointSpace SpaceOf(std::span<const double> start, const Rows& goals) const;

  MotionOptions options;
  std::string place;
  CollisionModel model;
  std::vector<std::string> names;
  std::vector<Interval> limits;
  std::vector<internal::PlannedArm> arms;
  std::optional<internal::TipAxis> axis;
};

std::optional<MotionResult> MotionPlanner::State::CheckStart(std::span<const double> start) {
  if (start.size() != names.size()) {
    throw ArgumentError(fmt::format("{}: the start has {} joint values, expected {}", place,
                                    start.size(), names.size()));
  }
  for (size_t i = 0; i < start.size(); ++i) {
    if (!std::isfinite(start[i]))
      throw ArgumentError(
          fmt::format("{}: the start of {} is not finite", place, NameOf(static_cast<int>(i))));
    if (start[i] < limits[i].lower - kStartSlack || start[i] > limits[i].upper + kStartSlack) {
      return Fail(
          MotionFailure::kStartBeyondLimits,
          fmt::format("{} starts at {:.4g}, beyond its limits {:.4g} ... {:.4g}; move it "
                      "back first",
                      NameOf(static_cast<int>(i)), start[i], limits[i].lower, limits[i].upper));
    }
  }
  if (model.MayHit(start, 1, internal::SphereJudge::kCautious)) {
    if (const auto contact = model.FindContact(start)) {
      return Fail(
          MotionFailure::kStartInCollision,
          fmt::format("at the start {} are {} (clearance {} m). Move the robot or the object, or "
                      "name the pair in allowed_contacts",
                      model.Describe(*contact),
                      contact->distance < 0
                          ? fmt::format("{:.2g} m inside each other", -contact->distance)
                          : fmt::format("{:.2g} m from each other", contact->distance),
                      options.clearance));
    }
  }
  if (axis && axis->Angle(start) > axis->tolerance) {
    return Fail(MotionFailure::kStartAgainstConstraint,
                fmt::format("at the start the axis is {:.3g} rad from where keep_axis wants it "
                            "(tolerance {:.3g} rad)",
                            axis->Angle(start), axis->tolerance));
  }
  return std::nullopt;
}

internal::JointSpace MotionPlanner::State::SpaceOf(std::span<const double> start,
                                                   const Rows& goals) const {
  internal::JointSpace space;
  // With a constraint trees grow in short steps, since only their ends are projected.
  if (axis) space.range = 0.3;
  for (size_t i = 0; i < limits.size(); ++i) {
    const bool slide = model.links().dofs()[i].slide;
    const double unit = slide ? kSlideUnit : 1;
    space.units.push_back(unit);
    double low = start[i], high = start[i];
    for (const std::vector<double>& goal : goals) {
      low = std::min(low, goal[i]);
      high = std::max(high, goal[i]);
    }
    const double beyond = std::numbers::pi * unit;
    space.bounds.push_back(
        {std::isfinite(limits[i].lower) ? std::min(low, limits[i].lower) : low - beyond,
         std::isfinite(limits[i].upper) ? std::max(high, limits[i].upper) : high + beyond});
  }
  return space;
}

namespace {

// One search for a path, in stages: each is slower than the one before and leaves less out.
struct Stage {
  PathJudge::Kind kind;
  double step;  // rad, between configurations of an edge
  double more;  // m of clearance, which covers most of what lies between them
};
constexpr Stage kStages[] = {{PathJudge::Kind::kBold, kDegree, 4e-4},
                             {PathJudge::Kind::kBold, kDegree / 2, 4e-4},
                             {PathJudge::Kind::kEngine, kDegree / 2, 4e-4},
                             {PathJudge::Kind::kEngine, kDegree / 2, 0},
                             {PathJudge::Kind::kEngine, kDegree / 8, 0}};

class Search {
 public:
  Search(CollisionModel* model, const internal::TipAxis* axis, const std::vector<Interval>& limits,
         const internal::JointSpace& space, std::span<const double> start,
         const MotionBudget& budget)
      : space_(space),
        bold_(axis ? kBoldConstrained : kBoldIterations),
        judge_(model, space_, axis, limits),
        start_(start),
        budget_(budget),
        rng_(Rng::Stream(budget.seed, "motion")),
        began_(Clock::now()) {}

  // Returns the indices of goals that are free for the judge.
  std::vector<int> FreeGoals(const Rows& goals) {
    std::vector<int> free;
    for (size_t g = 0; g < goals.size(); ++g) {
      if (judge_.IsFree(goals[g])) free.push_back(static_cast<int>(g));
    }
    return free;
  }

  bool Run(const Rows& goals) {
    for (const Stage& stage : kStages) {
      const bool engine = stage.kind == PathJudge::Kind::kEngine;
      judge_.Use(stage.kind, stage.step, stage.more);
      if (!judge_.IsFree(start_)) continue;
      const std::vector<int> free = FreeGoals(goals);
      if (free.empty()) continue;
      const int left = budget_.iterations - iterations_;
      const int most = !engine ? bold_ : stage.more > 0 ? left / 2 : left;
      if (!Connect(goals, free, most)) {
        if (out_of_time()) return false;
        continue;
      }
      const Rows whole = path_;
      Improve();
      if (Holds()) return true;
      path_ = whole;
      if (Holds()) return true;
    }
    return false;
  }

  const Rows& path() const { return path_; }
  int goal() const { return goal_; }  // index in the rows
  int iterations() const { return iterations_; }
  bool may_help() const { return may_help_; }
  bool out_of_time() const {
    if (!budget_.deadline) return false;
    return std::chrono::duration<double>(Clock::now() - began_).count() > *budget_.deadline;
  }

 private:
  bool Connect(const Rows& goals, const std::vector<int>& free, int most) {
    Rows ends;
    for (const int g : free) ends.push_back(goals[g]);
    internal::GoalTrees trees(start_, ends, space_, &judge_);
    trees.TryDirect(kDirectGoals);
    for (int k = 0; k < most && iterations_ < budget_.iterations && !trees.found(); ++k) {
      if (out_of_time()) break;
      if (budget_.poll && k % kIterationsBetweenPolls == 0) budget_.poll();
      ++iterations_;
      trees.Step(rng_);
    }
    may_help_ = trees.start_grows() && trees.goals_grow();
    if (!trees.found()) return false;
    path_ = trees.path();
    goal_ = free[trees.goal()];
    return true;
  }

  void Improve() { internal::Shorten(&path_, space_, &judge_, rng_, budget_.shortcuts); }

  // Returns true if the engine finds no fault with the path.
  bool Holds() {
    judge_.Use(PathJudge::Kind::kEngine, kCheckStep, 0);
    for (size_t k = 1; k < path_.size(); ++k) {
      if (!judge_.IsFree(path_[k - 1], path_[k])) return false;
    }
    return true;
  }

  internal::JointSpace space_;
  int bold_;
  PathJudge judge_;
  std::span<const double> start_;
  const MotionBudget& budget_;
  Rng rng_;
  Clock::time_point began_;
  Rows path_;
  int goal_ = -1, iterations_ = 0;
  bool may_help_ = true;
};

}  // namespace

MotionPlanner::MotionPlanner(const Robot& robot, const MotionOptions& options) {
  const std::string place = "planning a motion of robot '" + robot.name() + "'";
  RequireOptions(options, place);
  state_ = std::make_unique<State>(robot, options);
}
MotionPlanner::~MotionPlanner() = default;
MotionPlanner::MotionPlanner(MotionPlanner&&) noexcept = default;
MotionPlanner& MotionPlanner::operator=(MotionPlanner&&) noexcept = default;

void MotionPlanner::Update() {
  state_->model.Update();
  state_->Follow();
}

const Robot& MotionPlanner::robot() const { return state_->model.robot(); }
const std::vector<std::string>& MotionPlanner::joint_names() const { return state_->names; }
std::vector<Interval> MotionPlanner::joint_limits() const { return state_->limits; }
std::vector<double> MotionPlanner::present() const { return state_->model.present(); }
bool MotionPlanner::IsFree(std::span<const double> q) const {
  return !state_->model.FindContact(q);
}
double MotionPlanner::Clearance(std::span<const double> q, double horizon) const {
  return state_->model.Distance(q, horizon);
}

MotionResult MotionPlanner::Plan(std::span<const MotionGoal> goals, const MotionBudget& budget) {
  Update();
  return PlanFrom(state_->model.present(), goals, budget);
}

MotionResult MotionPlanner::PlanFrom(std::span<const double> start,
                                     std::span<const MotionGoal> goals,
                                     const MotionBudget& budget) {
  State& s = *state_;
  if (budget.iterations < 0 || budget.shortcuts < 0 || budget.most_goals < 1)
    throw ArgumentError(s.place +
                        ": iterations and shortcuts must be 0 or more, most_goals 1 or more");
  const CollisionModel::Counts before = s.model.counts();
  const auto finish = [&](MotionResult result) {
    result.configurations = s.model.counts().configurations - before.configurations;
    result.distances = s.model.counts().distances - before.distances;
    return result;
  };
  const internal::SolvedGoals solved =
      internal::SolveGoals(s.model, s.arms, s.SpaceOf(start, {}), s.limits, start, goals,
                           budget.most_goals, s.place, Rng::Stream(budget.seed, "motion goals"));
  if (auto failure = s.CheckStart(start)) return finish(*failure);
  if (solved.solutions.empty())
    return finish(s.Fail(MotionFailure::kGoalUnreachable, solved.why_none));

  Rows rows;
  std::vector<int> goal_of;
  for (const internal::SolvedGoals::Solution& solution : solved.solutions) {
    if (s.axis && s.axis->Angle(solution.q) > s.axis->tolerance) continue;
    rows.push_back(solution.q);
    goal_of.push_back(solution.goal);
  }
  if (rows.empty()) {
    return finish(
        s.Fail(MotionFailure::kGoalAgainstConstraint,
               fmt::format("none of the {} joint positions that reach a goal obeys keep_axis",
                           solved.solutions.size())));
  }
  Search search(&s.model, s.axis ? &*s.axis : nullptr, s.limits, s.SpaceOf(start, rows), start,
                budget);
  MotionResult result;
  result.success = search.Run(rows);
  result.iterations = search.iterations();
  if (result.success) {
    result.path = search.path();
    result.goal = goal_of[search.goal()];
    return finish(result);
  }
  // Why not? All goals in collision, or no way between.
  std::optional<internal::GeomContact> first;
  bool some_free = false;
  for (const std::vector<double>& q : rows) {
    const auto contact = s.model.FindContact(q);
    if (!contact) some_free = true;
    if (contact && !first) first = contact;
  }
  if (!some_free) {
    result =
        s.Fail(MotionFailure::kGoalInCollision,
               fmt::format("all {} joint positions that reach a goal are in collision or nearer "
                           "than the clearance of {} m; in the nearest one {} are",
                           rows.size(), s.options.clearance, s.model.Describe(*first)));
  } else {
    const bool may_help = search.may_help();
    result = s.Fail(
        MotionFailure::kNoPath,
        fmt::format("no path to a goal found in {} iterations{}. {}", search.iterations(),
                    search.out_of_time() ? " before the deadline" : "",
                    may_help ? "More iterations, or another seed, may find one"
                             : "Start or goals seem shut in: more iterations will hardly help; a "
                               "smaller clearance may"));
    result.more_may_help = may_help;
  }
  result.iterations = search.iterations();
  return finish(result);
}

MotionResult MotionPlanner::PlanLine(std::span<const double> start, const Pose& tcp_in_world,
                                     const std::string& arm_name) {
  State& s = *state_;
  if (auto failure = s.CheckStart(start)) return *failure;
  const internal::PlannedArm& arm = internal::ArmNamed(s.arms, arm_name, s.place);
  RequireIkTarget(tcp_in_world, s.place + ": the end of the line");
  JointVector values = internal::ChainValues(arm, s.model, start);
  const Pose from = arm.chain.Fk(values), to = arm.base_in_world.inverse() * tcp_in_world;
  const double metres = (to.translation() - from.translation()).norm();
  const double turn = (from.inverse() * to).angle();
  const int steps = static_cast<int>(std::clamp(
      std::ceil(std::max(metres / kLineStep, turn / kCheckStep)), 1.0, 1.0 * kMostLineSteps));
  IkOptions ik{.max_restarts = 0};
  for (size_t i = 0; i < arm.dofs.size(); ++i) ik.locked[i] = arm.dofs[i] < 0;
  PathJudge judge(&s.model, s.SpaceOf(start, {}), s.axis ? &*s.axis : nullptr, s.limits);
  judge.Use(PathJudge::Kind::kEngine, kCheckStep, 0);
  MotionResult result;
  result.path.emplace_back(start.begin(), start.end());
  for (int k = 1; k <= steps; ++k) {
    ik.seed = values;
    const IkResult found =
        arm.task_space.Solve(arm.chain, from.interpolate(to, static_cast<double>(k) / steps), ik);
    double jump = 0;
    for (int i = 0; i < values.size(); ++i) jump = std::max(jump, std::abs(found.q[i] - values[i]));
    const double done = 100.0 * (k - 1) / steps;
    if (!found.success || jump > kLineJump) {
      result.failure = MotionFailure::kGoalUnreachable;
      result.message = fmt::format(
          "{}: arm '{}' cannot follow the line beyond {:.0f} % of it within the joint limits",
          s.place, arm.name, done);
      return result;
    }
    values = found.q;
    std::vector<double> q = result.path.back();
    for (size_t i = 0; i < arm.dofs.size(); ++i) {
      if (arm.dofs[i] >= 0) q[arm.dofs[i]] = values[static_cast<int>(i)];
    }
    if (!judge.IsFree(result.path.back(), q)) {
      const auto contact = s.model.FindContact(q);
      result.failure = MotionFailure::kNoPath;
      result.message = fmt::format("{}: at {:.0f} % of the line {} in the way", s.place, done,
                                   contact ? s.model.Describe(*contact) + " are" : "something is");
      return result;
    }
    result.path.push_back(std::move(q));
  }
  result.success = true;
  result.goal = 0;
  return result;
}

MotionResult Plan(const Robot& robot, std::span<const MotionGoal> goals,
                  const MotionOptions& options, const MotionBudget& budget) {
  return MotionPlanner(robot, options).Plan(goals, budget);
}

}  // namespace robocell
