// The skill that carries a wide object with two arms: both take it at its ends, lift it together, carry
// it level, set it down, let go and draw back. From the grasp on the hands keep their places on the
// object: each posture of one arm goes with one of the other.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
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
constexpr double kLiftHeight = 0.08;       // m; all of the way to the goal is this high
constexpr double kLineStep = 0.01;         // m between postures
constexpr double kDropFrom = 0.001;        // m over the support
constexpr double kMostJump = 0.25;         // rad or m of a joint between two postures
constexpr int kPlaces = 24;                // of the goal that are drawn
constexpr size_t kMostGrasps = 80;         // pairs that are tried
constexpr int kMostReaches = 4;            // pairs to which a path is searched
constexpr int kRestarts = 6;
constexpr double kTolerance = 1e-4;  // of inverse kinematics on lines, m and rad
constexpr double kReachSpeed = 1.0, kLineSpeed = 0.4, kCarrySpeed = 0.4;                  // rad/s
constexpr double kLeastReach = 0.6, kLeastLine = 0.8, kLeastCarry = 1.0, kMostCarry = 6;  // s
constexpr double kHandSpeed = 0.15;  // m/s of the distance between the fingers
constexpr double kCloseSeconds = 0.9, kMostRelease = 1.5, kLostSeconds = 0.2;

// A straight motion of both TCPs, one pose of each for each posture.
using TcpPairs = std::vector<std::array<Pose, 2>>;

Pose Between(const Pose& a, const Pose& b, double share) {
  return {a.translation() + share * (b.translation() - a.translation()), a.quaternion()};
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
  std::optional<PairPath> Follow(const TcpPairs& tcps, std::vector<double> from,
                                 const MotionPlanner& planner) const;
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

// Returns postures of both arms with these TCPs, from one posture on; unset where an arm cannot follow
// or something is in the way.
std::optional<PairPath> CarrySkill::Follow(const TcpPairs& tcps, std::vector<double> from,
                                           const MotionPlanner& planner) const {
  const Pose world_in_base = robot_->base_in_world().inverse();
  PairPath path;
  for (const std::array<Pose, 2>& tcp : tcps) {
    std::array<JointVector, 2> q;
    for (size_t i = 0; i < 2; ++i) {
      const JointVector last = pair_->Part(from, i);
      const IkResult ik = Ik(pair_->arm(i).chain(), world_in_base * tcp[i],
                             {.tolerance = kTolerance, .seed = last, .max_restarts = 0});
      if (!ik.success || JointDistance(ik.q, last) > kMostJump) return std::nullopt;
      q[i] = ik.q;
    }
    from = pair_->Joined(q[0], q[1]);
    if (!planner.IsFree(from)) return std::nullopt;
    path.push_back(from);
  }
  return path;
}

// Returns "" or why the object cannot be carried.
std::string CarrySkill::Plan(const Scene& scene, Rng& rng) {
  const Pose object = scene.body_pose(body_);
  const std::optional<Pose> goal = GoalPose(scene, object, rng);
  if (!goal) return "the goal has no free place";
  const std::vector<PairGrasp> grasps = PairGrasps(scene, pair_->arms(), body_);
  if (grasps.empty()) return "no grasp for two hands";
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
  const Eigen::Vector3d up(0, 0, kLiftHeight);
  const Pose lifted(object.translation() + up, object.quaternion());
  const Pose over(goal->translation() + up, goal->quaternion());
  const Pose down(goal->translation() + Eigen::Vector3d(0, 0, kDropFrom), goal->quaternion());
  const Pose world_in_base = robot_->base_in_world().inverse();
  const std::vector<double> now = pair_->target();
  std::string why = "no grasp at both ends in reach";
  int reaches = 0;
  for (size_t g = 0; g < std::min(grasps.size(), kMostGrasps) && reaches < kMostReaches; ++g) {
    const std::array<Grasp, 2>& of = grasps[g].of;
    std::array<JointVector, 2> q;
    bool in_reach = true;
    for (size_t i = 0; i < 2 && in_reach; ++i) {
      const IkResult before =
          pair_->arm(i).Ik(world_in_base * object * of[i].before(),
                           {.seed = pair_->Part(now, i), .max_restarts = kRestarts});
      in_reach = before.success;
      q[i] = before.q;
    }
    if (!in_reach) continue;
    const std::vector<double> before = pair_->Joined(q[0], q[1]);
    if (!away.IsFree(before)) continue;
    why = "the arms cannot follow the way of the object";
    const auto line = [&](const Pose& a, const Pose& b) {
      TcpPairs tcps;
      const int steps = std::max(
          2, static_cast<int>(std::ceil((b.translation() - a.translation()).norm() / kLineStep)));
      for (int k = 1; k <= steps; ++k) {
        const Pose at = Between(a, b, static_cast<double>(k) / steps);
        tcps.push_back({at * of[0].tcp_in_body, at * of[1].tcp_in_body});
      }
      return tcps;
    };
    TcpPairs in;
    const int steps = static_cast<int>(std::ceil(of[0].approach_length / kLineStep));
    for (int k = 1; k <= steps; ++k) {
      const double share = static_cast<double>(k) / steps;
      in.push_back({object * Between(of[0].before(), of[0].tcp_in_body, share),
                    object * Between(of[1].before(), of[1].tcp_in_body, share)});
    }
    const auto approach = Follow(in, before, near);
    if (!approach) continue;
    const auto lift = Follow(line(object, lifted), approach->back(), held);
    if (!lift) continue;
    const auto carry = Follow(line(lifted, over), lift->back(), held);
    if (!carry) continue;
    const auto lower = Follow(line(over, down), carry->back(), held);
    if (!lower) continue;
    why = "no free path to the grasps";
    ++reaches;
    const MotionGoal goals[] = {MotionGoal::Joints(before)};
    const MotionResult reach = away.PlanFrom(now, goals, {.seed = rng.NextBits()});
    if (!reach.success) continue;
    reach_ = reach.path;
    approach_ = *approach;
    lift_ = *lift;
    carry_ = *carry;
    lower_ = *lower;
    return "";
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
