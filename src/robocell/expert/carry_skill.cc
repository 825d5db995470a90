// The skill that carries a wide object with two arms: both take it at its ends, lift it together, carry
// it level, set it down, let go and draw back. From the grasp on the hands keep their places on the
// object: each posture of one arm goes with one of the other.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <Eigen/Core>

#include <mujoco/mujoco.h>

#include "robocell/expert/any_arm.h"
#include "robocell/expert/arm_pair.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/expert/skill.h"
#include "robocell/expert/tcp_ways.h"
#include "robocell/kinematics/ik.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/motion/joint_path.h"
#include "robocell/motion/motion_planner.h"
#include "robocell/mujoco/names.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/task/two_arm_motion.h"

namespace robocell {
namespace internal::carry {
namespace {

constexpr double kReachClearance = 0.004;  // m
// m; all of the way to the goal is this high, or else this.
constexpr std::array kLiftHeights = {0.08, 0.05, 0.03, 0.12};
constexpr double kLineStep = 0.01;   // m between postures
constexpr double kDropFrom = 0.001;  // m over the support
constexpr int kPlaces = 24;          // of the goal that are drawn
constexpr int kApproachSteps = 8;    // postures on the way of a hand to its grasp
constexpr int kMostChecked = 150;    // ways of both arms that are checked
constexpr int kMostReaches = 6;      // ... to which a path is searched
constexpr size_t kEvery = 4;         // of these postures one is checked first
constexpr double kTolerance = 1e-4;  // of inverse kinematics on lines, m and rad
constexpr double kReachSpeed = 1.0, kLineSpeed = 0.4, kCarrySpeed = 0.4;                  // rad/s
constexpr double kLeastReach = 0.6, kLeastLine = 0.8, kLeastCarry = 1.0, kMostCarry = 6;  // s
constexpr double kHandSpeed = 0.15;  // m/s of the distance between the fingers
constexpr double kCloseSeconds = 0.9, kMostRelease = 1.5, kLostSeconds = 0.2;

Pose Between(const Pose& a, const Pose& b, double share) {
  return {a.translation() + share * (b.translation() - a.translation()), a.quaternion()};
}

// The straight motions of the object: up, across, and down, without its first pose.
struct ObjectWay {
  Pose first;
  std::vector<Pose> poses;
  size_t lifted = 0, over = 0;  // numbers of poses up to the ends of the first two
};

ObjectWay WayOf(const Pose& object, const Pose& goal, double height) {
  const Eigen::Vector3d up(0, 0, height);
  const Pose lifted(object.translation() + up, object.quaternion());
  const Pose over(goal.translation() + up, goal.quaternion());
  const Pose down(goal.translation() + Eigen::Vector3d(0, 0, kDropFrom), goal.quaternion());
  ObjectWay way{.first = object};
  const auto go = [&](const Pose& a, const Pose& b) {
    const double length = (b.translation() - a.translation()).norm();
    const int steps = std::max(2, static_cast<int>(std::ceil(length / kLineStep)));
    for (int k = 1; k <= steps; ++k)
      way.poses.push_back(Between(a, b, static_cast<double>(k) / steps));
    return way.poses.size();
  };
  way.lifted = go(object, lifted);
  way.over = go(lifted, over);
  go(over, down);
  return way;
}

// Returns the poses of a hand's TCP: where its approach begins, to the contact after kApproachSteps, and
// with the object on its way.
std::vector<Pose> TcpsOf(const ObjectWay& way, const Grasp& grasp) {
  std::vector<Pose> tcps;
  for (int k = 0; k <= kApproachSteps; ++k) {
    const double share = static_cast<double>(k) / kApproachSteps;
    tcps.push_back(way.first * Between(grasp.before(), grasp.tcp_in_body, share));
  }
  for (const Pose& pose : way.poses) tcps.push_back(pose * grasp.tcp_in_body);
  return tcps;
}

// Returns true if all of a number of postures are free. A few of them are looked at first.
bool AreFree(size_t count, const std::function<bool(size_t)>& is_free) {
  for (size_t i = 0; i < count; i += kEvery)
    if (!is_free(i)) return false;
  for (size_t i = 0; i < count; ++i)
    if (i % kEvery != 0 && !is_free(i)) return false;
  return true;
}

class CarrySkill final : public Skill {
 public:
  CarrySkill(SkillSettings settings, const RelationTask::Goal& goal)
      : settings_(std::move(settings)), goal_(goal) {}

  void Begin(const Scene& scene, Rng& rng) override;
  Action Act(const Scene& scene, Rng& rng) override;
  bool done() const override { return finished_; }
  std::string failure() const override { return failure_; }
  std::string phase() const override;

 private:
  enum class Phase { kReach, kApproach, kClose, kLift, kCarry, kLower, kRelease, kRetreat };

  std::string Plan(const Scene& scene, Rng& rng);
  std::optional<Pose> GoalPose(const Scene& scene, const Pose& object, Rng& rng) const;
  std::string PlanAt(double height, const Pose& object, const Pose& goal,
                     const std::vector<PairGrasp>& grasps, Rng& rng);
  void Enter(Phase phase);
  void Advance();
  bool HasLost();
  void SetOpenings(double opening);
  PairPath WayOut() const;
  void GiveUp(const std::string& why);

  SkillSettings settings_;
  const RelationTask::Goal& goal_;
  std::optional<Robot> robot_;
  std::optional<ArmPair> pair_;
  std::string body_;
  PairPath reach_, approach_, lift_, carry_, lower_;
  Phase phase_ = Phase::kReach;
  int ticks_ = 0, lost_ = 0;
  bool finished_ = false;
  std::string failure_;
};

std::string CarrySkill::phase() const {
  static const std::array<std::string, 8> names = {"reach", "approach", "close",   "lift",
                                                   "carry", "lower",    "release", "retreat"};
  return names[static_cast<size_t>(phase_)];
}

void CarrySkill::GiveUp(const std::string& why) {
  failure_ = why;
  finished_ = true;
}

void CarrySkill::Begin(const Scene& scene, Rng& rng) {
  finished_ = false;
  failure_.clear();
  phase_ = Phase::kReach;
  if (settings_.arms.size() < 2) return GiveUp("the robot has one arm with a hand");
  std::vector<std::string> arms = NearestArms(scene, settings_.arms, goal_.stated.subject);
  arms.resize(2);
  pair_.emplace(scene, std::array<std::string, 2>{arms[0], arms[1]}, settings_.tick);
  robot_ = Robot::Of(scene, pair_->arm(0).name());
  body_ = ElementName(scene.model(), mjOBJ_BODY, RequireObjectOrBody(scene, goal_.stated.subject));
  if (const std::string why = Plan(scene, rng); !why.empty()) return GiveUp(why);
  Enter(Phase::kReach);
}

// Returns where the object goes: turned as it is now, its centre of mass in the middle of the places at
// which the relation holds.
std::optional<Pose> CarrySkill::GoalPose(const Scene& scene, const Pose& object, Rng& rng) const {
  const std::vector<Pose> poses = goal_.bound->Sample(rng, kPlaces).poses;
  if (poses.empty()) return std::nullopt;
  const int body = FindId(scene.model(), mjOBJ_BODY, body_);
  const Eigen::Vector3d com(scene.data()->subtree_com + 3 * body);
  const Eigen::Vector3d in_body = object.inverse() * com;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Pose& pose : poses) middle += (pose * in_body) / static_cast<double>(poses.size());
  Eigen::Vector3d shift = middle - com;
  shift.z() = poses.front().translation().z() - object.translation().z();
  return Pose(object.translation() + shift, object.quaternion());
}

// Returns "" or why the object cannot be carried.
std::string CarrySkill::Plan(const Scene& scene, Rng& rng) {
  const Pose object = scene.body_pose(body_);
  const std::optional<Pose> goal = GoalPose(scene, object, rng);
  if (!goal) return "the goal has no free place";
  const std::vector<PairGrasp> grasps = PairGrasps(scene, pair_->arms(), body_);
  if (grasps.empty()) return "no grasp for two hands";
  std::string why;
  for (const double height : kLiftHeights) {
    const std::string why_not = PlanAt(height, object, *goal, grasps, rng);
    if (why_not.empty()) return "";
    if (why.empty()) why = why_not;  // of the usual height
  }
  return why;
}

// Returns "" or why the object cannot be carried at this height. Each arm's ways with the object are
// found alone; then the pairs of them are checked together.
std::string CarrySkill::PlanAt(double height, const Pose& object, const Pose& goal,
                               const std::vector<PairGrasp>& grasps, Rng& rng) {
  const std::array<std::string, 2> hands = {pair_->HandOf(0), pair_->HandOf(1)};
  const std::vector<std::string> groups = {pair_->arm(0).arm().name(), pair_->arm(1).arm().name()};
  MotionPlanner away(*robot_, {.groups = groups, .clearance = kReachClearance});
  MotionPlanner near(*robot_, {.groups = groups,
                               .clearance = 0,
                               .allowed_contacts = {{body_, hands[0]}, {body_, hands[1]}}});
  MotionPlanner held(*robot_, {.groups = groups,
                               .clearance = 0,
                               .allowed_contacts = {{body_, ""}},
                               .attached = {{body_, hands[0]}}});
  const ObjectWay way = WayOf(object, goal, height);
  const std::vector<double> now = pair_->target();
  // The ways of an arm with one of its grasps, found when they are needed.
  std::array<std::map<size_t, std::vector<JointPath>>, 2> ways;
  const auto ways_of = [&](size_t arm, const PairGrasp& pair) -> const std::vector<JointPath>& {
    const auto [at, is_new] = ways[arm].try_emplace(pair.number[arm]);
    if (is_new) {
      at->second = TcpWays(pair_->arm(arm), TcpsOf(way, pair.of[arm]), pair_->Part(now, arm),
                           {.anchors = {kApproachSteps, kApproachSteps + way.poses.size() - 1},
                            .tolerance = kTolerance},
                           rng);
    }
    return at->second;
  };
  std::string why = "the arms cannot follow the way of the object";
  int checked = 0, reaches = 0;
  for (const PairGrasp& pair : grasps) {
    for (const JointPath& first : ways_of(0, pair)) {
      for (const JointPath& second : ways_of(1, pair)) {
        if (++checked > kMostChecked || reaches >= kMostReaches) return why;
        PairPath both;
        for (size_t i = 0; i < first.size(); ++i)
          both.push_back(pair_->Joined(first[i], second[i]));
        const auto is_free = [&](size_t i) {
          if (i == 0) return away.IsFree(both[0]);
          return (i <= kApproachSteps ? near : held).IsFree(both[i]);
        };
        if (!AreFree(both.size(), is_free)) {
          if (reaches == 0) why = "something is in the way of the arms with the object";
          continue;
        }
        why = "no free path to the grasps";
        ++reaches;
        const MotionGoal goals[] = {MotionGoal::Joints(both.front())};
        const MotionResult reach = away.PlanFrom(now, goals, {.seed = rng.NextBits()});
        if (!reach.success) continue;
        reach_ = reach.path;
        const auto part = [&](size_t begin, size_t end) {
          const auto at = both.begin() + kApproachSteps + 1;
          return PairPath(at + static_cast<std::ptrdiff_t>(begin),
                          at + static_cast<std::ptrdiff_t>(end));
        };
        approach_ = PairPath(both.begin() + 1, both.begin() + kApproachSteps + 1);
        lift_ = part(0, way.lifted);
        carry_ = part(way.lifted, way.over);
        lower_ = part(way.over, way.poses.size());
        return "";
      }
    }
  }
  return why;
}

void CarrySkill::SetOpenings(double opening) {
  for (size_t i = 0; i < 2; ++i) {
    const Robot& arm = pair_->arm(i);
    const auto shape = GripperShape::Of(arm.config(), settings_.sim, arm.scene().timestep());
    const double range = shape->open_gap() - shape->closed_gap();
    pair_->SetOpening(i, opening, range > 0 ? kHandSpeed / range : 1 / settings_.tick);
  }
}

// Returns the way back from the object along the approach, from where the hands are now.
PairPath CarrySkill::WayOut() const {
  PairPath path;
  std::vector<double> last = pair_->target();
  for (size_t k = 1; k < approach_.size(); ++k) {
    // The approach backwards, moved by what the object was carried.
    std::array<JointVector, 2> q;
    for (size_t i = 0; i < 2; ++i) {
      const Chain& chain = pair_->arm(i).chain();
      const Pose contact = chain.Fk(pair_->Part(approach_.back(), i));
      const Pose before = chain.Fk(pair_->Part(approach_[approach_.size() - 1 - k], i));
      const Pose carried = chain.Fk(pair_->Part(lower_.back(), i));
      const IkResult ik =
          Ik(chain, carried * contact.inverse() * before,
             {.tolerance = kTolerance, .seed = pair_->Part(last, i), .max_restarts = 0});
      if (!ik.success) return path;
      q[i] = ik.q;
    }
    last = pair_->Joined(q[0], q[1]);
    path.push_back(last);
  }
  return path;
}

void CarrySkill::Enter(Phase phase) {
  phase_ = phase;
  ticks_ = lost_ = 0;
  switch (phase) {
    case Phase::kReach:
      SetOpenings(1);
      return pair_->Follow(reach_, kReachSpeed, kLeastReach);
    case Phase::kApproach:
      return pair_->Follow(approach_, kLineSpeed, kLeastLine);
    case Phase::kClose:
      return SetOpenings(0);
    case Phase::kLift:
      return pair_->FollowGently(lift_, kCarrySpeed, kLeastCarry, kMostCarry);
    case Phase::kCarry:
      return pair_->FollowGently(carry_, kCarrySpeed, kLeastCarry, kMostCarry);
    case Phase::kLower:
      return pair_->FollowGently(lower_, kCarrySpeed, kLeastCarry, kMostCarry);
    case Phase::kRelease:
      return SetOpenings(1);
    case Phase::kRetreat:
      return pair_->Follow(WayOut(), kLineSpeed, kLeastLine);
  }
}

// Returns true if one of the hands has not grasped the object for a while.
bool CarrySkill::HasLost() {
  const bool both =
      pair_->arm(0).gripper().is_grasping(body_) && pair_->arm(1).gripper().is_grasping(body_);
  lost_ = both ? 0 : lost_ + 1;
  return lost_ > pair_->Ticks(kLostSeconds);
}

void CarrySkill::Advance() {
  const bool is_held = phase_ == Phase::kLift || phase_ == Phase::kCarry || phase_ == Phase::kLower;
  if (is_held && HasLost()) return GiveUp("the object slipped");
  if (pair_->Blocked()) return GiveUp("the arm is blocked");
  switch (phase_) {
    case Phase::kReach:
      if (pair_->Settled()) Enter(Phase::kApproach);
      return;
    case Phase::kApproach:
      if (pair_->Settled()) Enter(Phase::kClose);
      return;
    case Phase::kClose:
      if (!pair_->openings_reached() || ticks_ < pair_->Ticks(kCloseSeconds)) return;
      for (size_t i = 0; i < 2; ++i)
        if (!pair_->arm(i).gripper().is_grasping(body_))
          return GiveUp("the hand closed on nothing");
      return Enter(Phase::kLift);
    case Phase::kLift:
      if (pair_->finished()) Enter(Phase::kCarry);
      return;
    case Phase::kCarry:
      if (pair_->finished()) Enter(Phase::kLower);
      return;
    case Phase::kLower:
      if (pair_->Settled()) Enter(Phase::kRelease);
      return;
    case Phase::kRelease: {
      if (!pair_->openings_reached()) return;
      const bool open = pair_->arm(0).gripper().opening() >= PickPlanner::kOpened &&
                        pair_->arm(1).gripper().opening() >= PickPlanner::kOpened;
      if (open || ticks_ >= pair_->Ticks(kMostRelease)) Enter(Phase::kRetreat);
      return;
    }
    case Phase::kRetreat:
      if (pair_->Settled()) finished_ = true;
      return;
  }
}

Action CarrySkill::Act(const Scene& /*scene*/, Rng& /*rng*/) {
  if (!pair_) return {};
  if (!finished_) Advance();
  if (!finished_) {
    pair_->Next();
    ++ticks_;
  }
  return pair_->Command();
}

}  // namespace
}  // namespace internal::carry

std::unique_ptr<Skill> MakeCarrySkill(const SkillSettings& settings,
                                      const RelationTask::Goal& goal) {
  return std::make_unique<internal::carry::CarrySkill>(settings, goal);
}

}  // namespace robocell
