// The skill that hands an object over: one arm picks it up, both move to where they meet, the other one
// takes it, and the first one lets go and draws back. Both arms are planned at once (motion_planner.h),
// with the object in the hand that holds it. The object is picked up by a grasp from which the hands can
// meet.
#include <algorithm>
#include <array>
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
#include "robocell/expert/hand_meetings.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/expert/skill.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/motion/motion_planner.h"
#include "robocell/motion/planning_scene.h"
#include "robocell/mujoco/names.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/task/grasp_motion.h"

namespace robocell {
namespace internal::handover {
namespace {

constexpr double kMeetClearance = 0.004;              // m
constexpr int kMostMeetings = 3000;                   // postures that are checked
constexpr int kMostOfGrasp = 400;                     // ... for a grasp before the pick
constexpr int kMostLines = 40;                        // postures to which a line is planned
constexpr int kMostPaths = 4;                         // postures to which a path is searched
constexpr double kMeetSpeed = 0.8, kLineSpeed = 0.4;  // rad/s
constexpr double kLeastMeet = 0.8, kMostMeet = 5, kLeastLine = 0.8, kLeastRetreat = 0.6;  // s
constexpr double kCloseSpeed = 0.2, kOpenSpeed = 0.15;  // m/s of the distance between the fingers
constexpr double kTakeSeconds = 0.8, kMostGive = 1.5, kLostSeconds = 0.2;
constexpr double kRetreat = 0.1;  // m

class HandoverSkill final : public Skill {
 public:
  HandoverSkill(SkillSettings settings, const RelationTask::Goal& goal)
      : settings_(std::move(settings)), goal_(goal) {}

  void Begin(const Scene& scene, Rng& rng) override;
  Action Act(const Scene& scene, Rng& rng) override;
  bool done() const override { return finished_; }
  std::string failure() const override { return failure_; }
  std::string phase() const override;

 private:
  enum class Phase { kPick, kMeet, kApproach, kTake, kGive, kRetreat };
  static constexpr size_t kGiver = 0, kTaker = 1;

  bool CanMeet(const PlanningScene& planning, const GraspMotion& motion);
  std::string FindMeeting(const Scene& scene, Rng& rng);
  MotionOptions Options(size_t holder) const;
  double OpeningSpeed(size_t arm, double speed) const;
  bool HasLost(size_t arm);
  void Enter(Phase phase);
  void Advance();
  void GiveUp(const std::string& why);

  SkillSettings settings_;
  const RelationTask::Goal& goal_;
  std::array<std::string, 2> arms_;
  std::optional<Robot> robot_;
  std::string body_;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();  // between the hands at the start
  std::optional<PickPlanner> pick_;
  std::optional<ArmPair> pair_;
  std::optional<HandMeetings> meetings_;
  std::optional<MotionPlanner> hands_;  // without the object
  std::optional<Grasp> grasp_;          // of the second hand
  PairPath meet_, approach_;
  Phase phase_ = Phase::kPick;
  int ticks_ = 0, lost_ = 0;
  bool finished_ = false;
  std::string failure_;
};

std::string HandoverSkill::phase() const {
  switch (phase_) {
    case Phase::kPick: {
      if (!pick_) return "open";
      const std::vector<std::string> names = pick_->phase_names();
      return names[std::min(static_cast<size_t>(pick_->phase()), names.size() - 2)];
    }
    case Phase::kMeet:
      return "meet";
    case Phase::kApproach:
      return "approach";
    case Phase::kTake:
      return "take";
    case Phase::kGive:
      return "give";
    case Phase::kRetreat:
      break;
  }
  return "retreat";
}

void HandoverSkill::Begin(const Scene& scene, Rng& rng) {
  finished_ = false;
  failure_.clear();
  pair_.reset();
  pick_.reset();
  meetings_.reset();
  hands_.reset();
  phase_ = Phase::kPick;
  if (settings_.arms.size() < 2) return GiveUp("the robot has one arm with a hand");
  body_ = ElementName(scene.model(), mjOBJ_BODY, RequireObjectOrBody(scene, goal_.stated.subject));
  // The nearest arm picks the object up; after a failure another pair has its turn.
  const std::vector<std::string> nearest = NearestArms(scene, settings_.arms, goal_.stated.subject);
  std::vector<std::array<std::string, 2>> pairs;
  for (const std::string& giver : nearest)
    for (const std::string& taker : nearest)
      if (giver != taker) pairs.push_back({giver, taker});
  arms_ = pairs[static_cast<size_t>(settings_.failures) % pairs.size()];
  pair_.emplace(scene, arms_, settings_.tick);
  robot_ = Robot::Of(scene, pair_->arm(kGiver).name());
  middle_ = (pair_->arm(kGiver).tcp_in_world().translation() +
             pair_->arm(kTaker).tcp_in_world().translation()) /
            2;
  meetings_.emplace(pair_->arm(kGiver), pair_->arm(kTaker), body_, middle_);
  MotionOptions options = Options(kGiver);
  options.attached.clear();
  options.allowed_contacts = {{body_, ""}};
  hands_.emplace(*robot_, options);
  pick_.emplace(
      arms_[kGiver], goal_.stated.subject, settings_.sim,
      PickPlannerOptions{.tick = settings_.tick,
                         .usable = [this](PlanningScene& planning, const GraspMotion& motion) {
                           return CanMeet(planning, motion);
                         }});
  pick_->Begin(scene, rng);
  if (!pick_->failure().empty()) GiveUp(pick_->failure());
}

// Returns true if there is a posture in which the hands meet after this grasp. The object itself, which
// is not in the hand yet, is no obstacle here.
bool HandoverSkill::CanMeet(const PlanningScene& planning, const GraspMotion& motion) {
  const int body = planning.target_body();
  const Pose object = Pose::FromTranslationAndMatrix(planning.data()->xpos + 3 * body,
                                                     planning.data()->xmat + 9 * body);
  return meetings_->Find(object, object.inverse() * motion.grasp.tcp_in_world, *hands_, *hands_,
                         kMostOfGrasp, [](const HandMeeting& /*meeting*/) { return true; });
}

void HandoverSkill::GiveUp(const std::string& why) {
  failure_ = why;
  finished_ = true;
}

// The options of a planner for both arms, one of which holds the object.
MotionOptions HandoverSkill::Options(size_t holder) const {
  return {.groups = {pair_->arm(kGiver).arm().name(), pair_->arm(kTaker).arm().name()},
          .clearance = kMeetClearance,
          .attached = {{body_, pair_->HandOf(holder)}}};
}

// Returns "" or why the arms cannot meet.
std::string HandoverSkill::FindMeeting(const Scene& scene, Rng& rng) {
  const Pose object = scene.body_pose(body_);
  const Pose tcp_in_object = object.inverse() * pair_->arm(kGiver).tcp_in_world();
  if (!meetings_->HasRoom(tcp_in_object)) return "no room on the object for the second hand";
  MotionOptions touching = Options(kGiver);
  touching.allowed_contacts = {{body_, pair_->HandOf(kTaker)}};
  MotionPlanner away(*robot_, Options(kGiver)), near(*robot_, touching);
  int lines = 0, paths = 0;
  bool found = false;
  const auto use = [&](const HandMeeting& meeting) {
    const std::vector<double> start = pair_->Joined(meeting.giver, meeting.before);
    const MotionResult line = near.PlanLine(start, meeting.object * meeting.grasp.tcp_in_body,
                                            pair_->arm(kTaker).arm().name());
    if (!line.success) return ++lines >= kMostLines;
    ++paths;
    const MotionGoal goals[] = {MotionGoal::Joints(start)};
    const MotionResult path = away.PlanFrom(pair_->target(), goals, {.seed = rng.NextBits()});
    if (!path.success) return paths >= kMostPaths;
    meet_ = path.path;
    approach_ = line.path;
    grasp_ = meeting.grasp;
    found = true;
    return true;
  };
  meetings_->Find(object, tcp_in_object, away, near, kMostMeetings, use);
  if (found) return "";
  return paths > 0 ? "no free path to where the hands meet"
                   : "no free posture in which the hands meet";
}

double HandoverSkill::OpeningSpeed(size_t arm, double speed) const {
  const Robot& robot = pair_->arm(arm);
  const auto shape = GripperShape::Of(robot.config(), settings_.sim, robot.scene().timestep());
  const double range = shape->open_gap() - shape->closed_gap();
  return range > 0 ? speed / range : 1 / settings_.tick;  // a cup sticks at once
}

Action HandoverSkill::Act(const Scene& scene, Rng& rng) {
  if (phase_ == Phase::kPick) {
    const Action action = pick_ ? pick_->Act(scene, rng) : Action();
    if (finished_ || !pick_->done()) return action;
    if (!pick_->failure().empty()) {
      GiveUp(pick_->failure());
      return action;
    }
    pair_.emplace(scene, arms_, settings_.tick);
    if (const std::string why = FindMeeting(scene, rng); !why.empty()) {
      GiveUp(why);
      return action;
    }
    Enter(Phase::kMeet);
  }
  if (!finished_) Advance();
  if (!finished_) {
    pair_->Next();
    ++ticks_;
  }
  return pair_->Command();
}

void HandoverSkill::Enter(Phase phase) {
  phase_ = phase;
  ticks_ = lost_ = 0;
  switch (phase) {
    case Phase::kPick:
      break;
    case Phase::kMeet:
      pair_->SetOpening(kTaker, 1, OpeningSpeed(kTaker, kOpenSpeed));
      pair_->FollowGently(meet_, kMeetSpeed, kLeastMeet, kMostMeet);
      break;
    case Phase::kApproach: {
      // The object may have moved in the hand, and the arms give way a little.
      MotionOptions touching = Options(kGiver);
      touching.allowed_contacts = {{body_, pair_->HandOf(kTaker)}};
      touching.clearance = 0;
      MotionPlanner near(*robot_, touching);
      const Pose tcp = robot_->scene().body_pose(body_) * grasp_->tcp_in_body;
      const MotionResult line =
          near.PlanLine(pair_->target(), tcp, pair_->arm(kTaker).arm().name());
      pair_->Follow(line.success ? line.path : approach_, kLineSpeed, kLeastLine);
      break;
    }
    case Phase::kTake:
      pair_->SetOpening(kTaker, 0, OpeningSpeed(kTaker, kCloseSpeed));
      break;
    case Phase::kGive:
      pair_->SetOpening(kGiver, 1, OpeningSpeed(kGiver, kOpenSpeed));
      break;
    case Phase::kRetreat: {
      MotionOptions options = Options(kTaker);
      options.allowed_contacts = {{body_, pair_->HandOf(kGiver)}};
      options.clearance = 0;
      MotionPlanner leaving(*robot_, options);
      const Robot& giver = pair_->arm(kGiver);
      const auto shape = GripperShape::Of(giver.config(), settings_.sim, giver.scene().timestep());
      const Pose tcp = giver.tcp_in_world();
      const Eigen::Vector3d back =
          -Rotate(tcp.quaternion(), shape->grasp_in_tcp().rotation().col(2));
      const MotionResult line = leaving.PlanLine(
          pair_->target(), Pose(tcp.translation() + kRetreat * back, tcp.quaternion()),
          giver.arm().name());
      pair_->Follow(line.path, kLineSpeed, kLeastRetreat);
      break;
    }
  }
}

// Returns true if an arm has not grasped the object for a while.
bool HandoverSkill::HasLost(size_t arm) {
  lost_ = pair_->arm(arm).gripper().is_grasping(body_) ? 0 : lost_ + 1;
  return lost_ > pair_->Ticks(kLostSeconds);
}

void HandoverSkill::Advance() {
  const bool is_given = phase_ == Phase::kGive || phase_ == Phase::kRetreat;
  if (phase_ != Phase::kTake && HasLost(is_given ? kTaker : kGiver))
    return GiveUp("the object slipped");
  if (pair_->Blocked()) return GiveUp("the arm is blocked");
  switch (phase_) {
    case Phase::kPick:
      return;
    case Phase::kMeet:
      if (pair_->Settled() && pair_->openings_reached()) Enter(Phase::kApproach);
      return;
    case Phase::kApproach:
      if (pair_->Settled()) Enter(Phase::kTake);
      return;
    case Phase::kTake:
      if (!pair_->openings_reached() || ticks_ < pair_->Ticks(kTakeSeconds)) return;
      if (!pair_->arm(kTaker).gripper().is_grasping(body_))
        return GiveUp("the second hand closed on nothing");
      return Enter(Phase::kGive);
    case Phase::kGive:
      if (!pair_->openings_reached()) return;
      if (pair_->arm(kGiver).gripper().opening() < PickPlanner::kOpened &&
          ticks_ < pair_->Ticks(kMostGive))
        return;
      return Enter(Phase::kRetreat);
    case Phase::kRetreat:
      if (pair_->Settled()) finished_ = true;
      return;
  }
}

}  // namespace
}  // namespace internal::handover

std::unique_ptr<Skill> MakeHandoverSkill(const SkillSettings& settings,
                                         const RelationTask::Goal& goal) {
  return std::make_unique<internal::handover::HandoverSkill>(settings, goal);
}

}  // namespace robocell
