#include "robocell/motion/goal_solver.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/kinematics/ik_batch.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kApart = 0.05;       // rad or units: nearer solutions are one
constexpr double kLimitSlack = 1e-6;  // rad or m: rounding of given goals
constexpr int kSamples = 48;          // of each pose

// Moves hinges by whole turns to the positions nearest to the start.
void TakeNearestTurns(const CollisionModel& model, const std::vector<Interval>& limits,
                      std::span<const double> start, std::vector<double>* q) {
  for (size_t i = 0; i < q->size(); ++i) {
    if (model.links().dofs()[i].slide) continue;
    const double moved = (*q)[i] + kTurn * std::round((start[i] - (*q)[i]) / kTurn);
    if (moved >= limits[i].lower && moved <= limits[i].upper) (*q)[i] = moved;
  }
}

class Solver {
 public:
  Solver(const CollisionModel& model, const std::vector<Interval>& limits,
         std::span<const double> start, const std::string& place)
      : model_(model), limits_(limits), start_(start), place_(place) {}

  // Adds the solutions of one goal; returns why there is none, "" if there is.
  std::string Solve(int number, const MotionGoal& goal, const std::vector<PlannedArm>& arms,
                    Rng rng, std::vector<SolvedGoals::Solution>* out) {
    const size_t before = out->size();
    if (!goal.joints.empty()) return Given(number, goal.joints, out);
    Require(number, goal);
    const PlannedArm& arm = ArmNamed(arms, goal.arm, place_);
    const Chain& chain = arm.chain;
    const JointVector seed = ChainValues(arm, model_, start_);
    IkOptions options{.seed = seed};
    for (size_t i = 0; i < arm.dofs.size(); ++i) options.locked[i] = arm.dofs[i] < 0;
    const bool is_pose = std::ranges::all_of(goal.position_box, [](double x) { return x == 0; }) &&
                         std::ranges::all_of(goal.free_rotation, [](double x) { return x == 0; });
    const Pose in_base = arm.base_in_world.inverse() * goal.tcp;
    arm.task_space.ApplyTo(options);
    IkResult nearest;
    if (is_pose) {  // reachable at all? One search does its best.
      nearest = arm.task_space.Solve(chain, in_base, options);
      if (nearest.success) Add(number, arm, nearest.q, before, out);
    }
    if (!is_pose || nearest.success) Sample(number, goal, arm, in_base, options, before, rng, out);
    if (out->size() > before) return "";
    if (!is_pose)
      return fmt::format("goal {}: no pose of its region can be reached within the joint limits",
                         number);
    return fmt::format(
        "goal {}: arm '{}' cannot reach its pose within the joint limits (it comes within {:.3g} m "
        "and {:.3g} rad)",
        number, arm.name, nearest.position_error, nearest.rotation_error);
  }

 private:
  void Require(int number, const MotionGoal& goal) const {
    for (int i = 0; i < 3; ++i) {
      for (const double freedom : {goal.position_box[i], goal.free_rotation[i]}) {
        if (freedom >= 0 && std::isfinite(freedom)) continue;
        throw ArgumentError(
            fmt::format("{}: goal {} has a freedom of {}; it must be finite and 0 or more", place_,
                        number, freedom));
      }
    }
    if (!IsFinite(goal.tcp))
      throw ArgumentError(fmt::format("{}: the pose of goal {} is not finite", place_, number));
  }

  std::string Given(int number, const std::vector<double>& q,
                    std::vector<SolvedGoals::Solution>* out) const {
    if (q.size() != start_.size()) {
      throw ArgumentError(fmt::format("{}: goal {} has {} joint values, expected {}", place_,
                                      number, q.size(), start_.size()));
    }
    for (size_t i = 0; i < q.size(); ++i) {
      const std::string joint = Name(i);
      if (!std::isfinite(q[i]))
        throw ArgumentError(fmt::format("{}: goal {}: {} is not finite", place_, number, joint));
      if (q[i] < limits_[i].lower - kLimitSlack || q[i] > limits_[i].upper + kLimitSlack) {
        return fmt::format("goal {}: {} is {:.4g}, beyond its limits {:.4g} ... {:.4g}", number,
                           joint, q[i], limits_[i].lower, limits_[i].upper);
      }
    }
    out->push_back({number, q});
    return "";
  }

  std::string Name(size_t dof) const {
    return robocell::Describe(model_.model(), mjOBJ_JOINT, model_.links().dofs()[dof].joint);
  }

  void Sample(int number, const MotionGoal& goal, const PlannedArm& arm, const Pose& in_base,
              const IkOptions& options, size_t before, Rng& rng,
              std::vector<SolvedGoals::Solution>* out) {
    std::vector<Pose> targets;
    std::vector<double> seeds;
    for (int k = 0; k < kSamples; ++k) {
      Eigen::Vector3d shift, turn;
      for (int i = 0; i < 3; ++i) {
        shift[i] = rng.Uniform(-goal.position_box[i], goal.position_box[i]);
        turn[i] = rng.Uniform(-goal.free_rotation[i], goal.free_rotation[i]);
      }
      targets.push_back(k == 0 ? in_base : in_base * Pose::FromRpy(shift, turn));
      for (size_t i = 0; i < arm.dofs.size(); ++i) {
        double value = options.seed[static_cast<int>(i)];
        if (k > 0 && arm.dofs[i] >= 0) {
          const Interval& limit = limits_[arm.dofs[i]];
          const double low = std::max(limit.lower, value - kTurn / 2);
          const double high = std::min(limit.upper, value + kTurn / 2);
          value = low < high ? rng.Uniform(low, high) : value;
        }
        seeds.push_back(value);
      }
    }
    IkOptions each = options;
    each.seed = {};
    each.max_restarts = 2;
    const IkBatchResult found = IkBatch(arm.chain, targets, seeds, {.ik = each});
    for (int k = 0; k < found.size; ++k) {
      if (found.success[k]) Add(number, arm, JointVector(found.row(k)), before, out);
    }
  }

  void Add(int number, const PlannedArm& arm, const JointVector& values, size_t before,
           std::vector<SolvedGoals::Solution>* out) const {
    std::vector<double> q(start_.begin(), start_.end());
    for (size_t i = 0; i < arm.dofs.size(); ++i) {
      if (arm.dofs[i] >= 0) q[arm.dofs[i]] = values[static_cast<int>(i)];
    }
    TakeNearestTurns(model_, limits_, start_, &q);
    for (size_t i = 0; i < q.size(); ++i) {
      if (arm.dofs.empty() || q[i] == start_[i]) continue;
      if (q[i] < limits_[i].lower - kLimitSlack || q[i] > limits_[i].upper + kLimitSlack) return;
    }
    const auto is_same = [&](const SolvedGoals::Solution& other) {
      for (size_t i = 0; i < q.size(); ++i) {
        if (std::abs(q[i] - other.q[i]) > kApart) return false;
      }
      return true;
    };
    if (std::any_of(out->begin() + static_cast<std::ptrdiff_t>(before), out->end(), is_same))
      return;
    out->push_back({number, std::move(q)});
  }

  const CollisionModel& model_;
  const std::vector<Interval>& limits_;
  std::span<const double> start_;
  const std::string& place_;
};

}  // namespace

std::vector<PlannedArm> FindPlannedArms(const CollisionModel& model) {
  const Robot& robot = model.robot();
  const mjModel* m = model.model();
  std::vector<PlannedArm> arms;
  for (const std::string& name : robot.group_names()) {
    if (robot.group(name).kind() != MoveGroupKind::kArm) continue;
    Chain chain = robot.chain(name);
    int base = RequireId(m, mjOBJ_BODY, chain.base_body(), "robot '" + robot.name() + "'");
    if (model.links().link_of(base) != 0) {
      chain = Chain(m, "world", chain.tip());
      base = 0;
    }
    std::vector<int> dofs;
    bool moves = false;
    for (const ChainJoint& joint : chain.joints()) {
      const auto& all = model.links().dofs();
      const auto at = std::ranges::find(all, joint.id, &MovingLinks::Dof::joint);
      dofs.push_back(at == all.end() ? -1 : static_cast<int>(at - all.begin()));
      moves = moves || at != all.end();
    }
    if (!moves) continue;
    arms.push_back({name, chain, std::move(dofs), model.links().in_link(base).pose(),
                    TaskSpaceOf(robot.config(), name)});
  }
  return arms;
}

const PlannedArm& ArmNamed(const std::vector<PlannedArm>& arms, const std::string& name,
                           const std::string& place) {
  const auto at = std::ranges::find(arms, name, &PlannedArm::name);
  if (at != arms.end()) return *at;
  if (name.empty() && !arms.empty()) return arms[0];
  std::string known;
  for (const PlannedArm& arm : arms) known += (known.empty() ? "'" : ", '") + arm.name + "'";
  throw NotFoundError(fmt::format("{}: no planned arm '{}'. Planned arms: {}", place, name,
                                  known.empty() ? "none" : known));
}

JointVector ChainValues(const PlannedArm& arm, const CollisionModel& model,
                        std::span<const double> q) {
  JointVector values(arm.chain.n_joints());
  const mjData* d = model.robot().scene().data();
  for (int i = 0; i < values.size(); ++i) {
    values[i] = arm.dofs[i] >= 0 ? q[arm.dofs[i]] : d->qpos[arm.chain.joints()[i].qpos_address];
  }
  return values;
}

SolvedGoals SolveGoals(const CollisionModel& model, const std::vector<PlannedArm>& arms,
                       const JointSpace& space, const std::vector<Interval>& limits,
                       std::span<const double> start, std::span<const MotionGoal> goals, int most,
                       const std::string& place, Rng rng) {
  if (goals.empty()) throw ArgumentError(place + ": there is no goal; give at least one");
  SolvedGoals solved;
  Solver solver(model, limits, start, place);
  for (size_t g = 0; g < goals.size(); ++g) {
    const std::string why = solver.Solve(static_cast<int>(g), goals[g], arms,
                                         rng.Fork(static_cast<int>(g)), &solved.solutions);
    if (solved.why_none.empty()) solved.why_none = why;
  }
  std::ranges::stable_sort(solved.solutions, {}, [&](const SolvedGoals::Solution& s) {
    return DistanceIn(space, start, s.q);
  });
  if (static_cast<int>(solved.solutions.size()) > most) {
    // The nearest of each goal come first, so that no goal is left out while others have many.
    std::vector<SolvedGoals::Solution> chosen;
    std::vector<char> taken(solved.solutions.size(), 0);
    while (static_cast<int>(chosen.size()) < most) {
      std::vector<char> had(goals.size(), 0);
      for (size_t k = 0; k < taken.size() && static_cast<int>(chosen.size()) < most; ++k) {
        const int goal = solved.solutions[k].goal;
        if (taken[k] || had[goal]) continue;
        taken[k] = had[goal] = 1;
        chosen.push_back(solved.solutions[k]);
      }
    }
    solved.solutions = std::move(chosen);
  }
  return solved;
}

}  // namespace robocell::internal
