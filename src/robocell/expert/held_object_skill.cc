#include "robocell/expert/held_object_skill.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "robocell/kinematics/ik.h"
#include "robocell/math/rotation.h"
#include "robocell/motion/vertical_line.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/task_space.h"
#include "robocell/scenes/landmarks.h"

namespace robocell::internal {
namespace {

constexpr int kMostPicks = 3;
constexpr int kMostTransfers = 6;  // paths to whose start a way is searched
constexpr double kCarriedSpeed = 0.8, kCarriedLineSpeed = 0.6;  // of the fastest joint, rad/s (m/s)
constexpr double kLeastCarry = 0.3, kMostCarry = 6, kLeastRetreat = 0.5;  // seconds
constexpr double kRetreat = 0.1;                                          // m
constexpr double kOpenSpeed = 0.15;                      // m/s of the distance between the fingers
constexpr double kMostRelease = 1.5;                     // seconds
constexpr double kReturnSpeed = 0.2, kReturnTurn = 1.5;  // m/s and rad/s
// Share of an error that is corrected in one tick, and the largest correction, m and rad.
constexpr double kGain = 0.12, kMostShift = 0.03, kMostTurn = 0.3;
constexpr double kMostJump = 0.25;   // rad (m) of a joint in one tick
constexpr double kDropFrom = 0.002;  // m over its old place at which an object is let go

// Moves a vector of a correction towards the error, at most to a length.
Eigen::Vector3d Corrected(const Eigen::Vector3d& correction, const Eigen::Vector3d& error,
                          double most) {
  const Eigen::Vector3d next = correction + kGain * error;
  return next.norm() > most ? Eigen::Vector3d(next * (most / next.norm())) : next;
}

}  // namespace

void PathWalk::Move(double seconds) {
  while (seconds > 0 && !at_end()) {
    const auto from = static_cast<size_t>(at_);
    const Pose &a = (*path_)[from], &b = (*path_)[from + 1];
    const double step =
        std::max({(b.translation() - a.translation()).norm() / speed_,
                  AngleBetween(a.quaternion(), b.quaternion()) / turn_speed_, 1e-9});
    const double rest = (static_cast<double>(from) + 1 - at_) * step;
    at_ = rest > seconds ? at_ + seconds / step : static_cast<double>(from) + 1;
    seconds -= rest;
  }
}

Pose PathWalk::place() const {
  const auto from = static_cast<size_t>(at_);
  const size_t to = std::min(from + 1, path_->size() - 1);
  return (*path_)[from].interpolate((*path_)[to], at_ - std::floor(at_));
}

HeldPath BackAlong(const HeldPath& path, std::optional<double> at) {
  const double from = at.value_or(static_cast<double>(path.size() - 1));
  const auto passed = static_cast<std::ptrdiff_t>(from);
  HeldPath back;
  if (const double share = from - std::floor(from); share > 0) {
    const auto next = path.begin() + passed;
    back.push_back(next->interpolate(*(next + 1), share));
  }
  back.insert(back.end(), path.rend() - passed - 1, path.rend());
  return back;
}

HeldObjectSkill::HeldObjectSkill(SkillSettings settings, const RelationTask::Goal& goal)
    : settings_(std::move(settings)),
      goal_(goal),
      pick_(settings_.robot, goal.stated.subject, settings_.sim,
            {.tick = settings_.tick,
             .usable = [this](PlanningScene& planning, const GraspMotion& motion) {
               return !CheckHeldPaths(robot_->scene(), goal_.stated, *goal_.bound, planning,
                                      motion);
             }}) {}

HeldObjectSkill::~HeldObjectSkill() = default;

std::string HeldObjectSkill::phase() const {
  switch (phase_) {
    case Phase::kPick: {
      // A pick that is done waits at the top, which is part of its lift here.
      const std::vector<std::string> names = pick_.phase_names();
      return names[std::min(static_cast<size_t>(pick_.phase()), names.size() - 2)];
    }
    case Phase::kTransfer:
      return "transfer";
    case Phase::kGuide:
      return path_phase();
    case Phase::kReturn:
      return "lower";
    case Phase::kRelease:
      return "release";
    case Phase::kRetreat:
      break;
  }
  return "retreat";
}

void HeldObjectSkill::Begin(const Scene& scene, Rng& rng) {
  robot_ = Robot::Of(scene, settings_.robot);
  object_body_ =
      ElementName(scene.model(), mjOBJ_BODY, RequireObjectOrBody(scene, goal_.stated.subject));
  at_rest_ = ObjectInWorld();
  picks_ = 0;
  finished_ = false;
  setback_.clear();
  failure_.clear();
  PickAgain(scene, rng);
}

void HeldObjectSkill::PickAgain(const Scene& scene, Rng& rng) {
  ++picks_;
  arm_.reset();
  phase_ = Phase::kPick;
  pick_.Begin(scene, rng);
  if (!pick_.failure().empty()) GiveUp(picks_ > 1 ? "the object slipped" : pick_.failure());
}

Pose HeldObjectSkill::ObjectInWorld() const { return robot_->scene().body_pose(object_body_); }

// Plans the path with the object's present pose in the hand. Returns "" or why there is none.
std::string HeldObjectSkill::Plan(const Scene& scene, Rng& rng) {
  PlanningScene& planning = pick_.planning();
  planning.Update();
  const GripperShape& shape = planning.shape();
  const double range = shape.open_gap() - shape.closed_gap();
  opening_step_ = range > 0 ? kOpenSpeed * settings_.tick / range : 1;  // a cup lets go at once
  const Pose object = ObjectInWorld();
  object_in_tcp_ = robot_->tcp_in_world().inverse() * object;
  const std::vector<HeldPath> paths = HeldPaths(scene, goal_.stated, *goal_.bound, object);
  if (paths.empty()) return "the goal has no free place";
  HeldMotions motions(planning, object_in_tcp_, paths, arm_->target(), {.gap = pick_.held_width()});
  std::string why = "the arm cannot follow the path";
  for (int i = 0; i < kMostTransfers; ++i) {
    const std::optional<HeldMotion> motion = motions.Next();
    if (!motion) break;
    why = "no free path to the goal";
    std::optional<JointPath> transfer = FindTransfer(motion->along.front(), rng);
    if (!transfer) continue;
    transfer_ = std::move(*transfer);
    path_ = paths[motion->path];
    along_ = motion->along;
    return "";
  }
  return why;
}

std::optional<JointPath> HeldObjectSkill::FindTransfer(const JointVector& goal, Rng& rng) {
  PlanningScene& planning = pick_.planning();
  const JointVector start = arm_->target();
  for (const double clearance : kPathClearances) {
    const FreeFunction is_free = [&](const JointVector& q) {
      return planning.IsFree(q, {.gap = pick_.held_width(), .clearance = clearance});
    };
    if (!is_free(start) || !is_free(goal)) continue;
    if (EdgeIsFree(start, goal, is_free)) return JointPath{start, goal};
    if (auto path = ConnectTrees(start, goal, robot_->joint_limits(), is_free, rng)) return path;
  }
  return std::nullopt;
}

void HeldObjectSkill::Enter(Phase phase) {
  phase_ = phase;
  ticks_ = 0;
  arm_->Begin();
  switch (phase) {
    case Phase::kTransfer:
      for (size_t i = 1; i < transfer_.size(); ++i) {
        arm_->AddLeg(
            {transfer_[i]}, kCarriedSpeed,
            arm_->GentleSeconds({transfer_[i - 1], transfer_[i]}, kLeastCarry, kMostCarry));
      }
      break;
    case Phase::kRetreat: {
      const JointVector q = arm_->target();
      const Eigen::Vector3d up =
          Rotate(robot_->base_in_world().inverse().quaternion(), Eigen::Vector3d::UnitZ());
      retreat_ =
          LineAbove(robot_->chain(), TaskSpaceOf(*robot_), robot_->chain().Fk(q), q, up, kRetreat);
      if (retreat_.size() > 1)
        arm_->AddLeg({retreat_.begin() + 1, retreat_.end()}, kCarriedLineSpeed, kLeastRetreat);
      break;
    }
    case Phase::kPick:
    case Phase::kGuide:
    case Phase::kReturn:
    case Phase::kRelease:
      break;
  }
}

Action HeldObjectSkill::Act(const Scene& scene, Rng& rng) {
  if (phase_ == Phase::kPick && !finished_) {
    Action action = pick_.Act(scene, rng);
    if (!pick_.done()) return action;
    if (!pick_.failure().empty()) {
      GiveUp(pick_.failure());
      return action;
    }
    arm_.emplace(*robot_, settings_.tick);
    opening_ = 0;
    if (const std::string why = Plan(scene, rng); !why.empty()) {
      GiveUp(why);
      return action;
    }
    Enter(Phase::kTransfer);
  }
  if (!arm_) return pick_.Act(scene, rng);  // given up: stay
  if (!finished_) Advance(scene, rng);
  if (!arm_) return pick_.Act(scene, rng);  // it picks again, or no pick is left
  if (!finished_) {
    if (phase_ != Phase::kGuide && phase_ != Phase::kReturn) arm_->Next();
    if (phase_ == Phase::kRelease) opening_ = std::min(1.0, opening_ + opening_step_);
    ++ticks_;
  }
  return Command();
}

void HeldObjectSkill::Advance(const Scene& scene, Rng& rng) {
  const bool is_held =
      phase_ == Phase::kTransfer || phase_ == Phase::kGuide || phase_ == Phase::kReturn;
  if (is_held && pick_.HandIsEmpty()) {
    if (picks_ >= kMostPicks) return GiveUp("the object slipped");
    return PickAgain(scene, rng);
  }
  if (arm_->Blocked()) {
    if (phase_ != Phase::kGuide) return GiveUp("the arm is blocked");
    arm_->Unblock();
    setback_ = "the arm is blocked";
  }
  switch (phase_) {
    case Phase::kPick:
      return;
    case Phase::kTransfer:
      if (!arm_->Settled()) return;
      shift_ = turn_ = Eigen::Vector3d::Zero();
      last_.reset();
      BeginPath(scene);
      return Enter(Phase::kGuide);
    case Phase::kGuide: {
      const std::optional<Guidance> next =
          setback_.empty() ? Guide(scene) : std::optional<Guidance>();
      if (next) return Follow(*next);
      if (!returns() || !setback_.empty()) return Enter(Phase::kRelease);
      // Back on the path from where it is, its start without a guidance, then down to where it was.
      back_ = BackAlong(path_, last_ ? last_->at : std::optional<double>(0));
      AppendStraight(back_, Pose(Eigen::Vector3d(0, 0, kDropFrom)) * at_rest_);
      walk_.emplace(back_, kReturnSpeed, kReturnTurn);
      return Enter(Phase::kReturn);
    }
    case Phase::kReturn:
      if (walk_->at_end()) return Enter(Phase::kRelease);
      walk_->Move(settings_.tick);
      return Follow({.object_in_world = walk_->place()});
    case Phase::kRelease:
      if (opening_ < 1) return;
      if (robot_->gripper().opening() < PickPlanner::kOpened && ticks_ < arm_->Ticks(kMostRelease))
        return;
      return Enter(Phase::kRetreat);
    case Phase::kRetreat:
      if (!arm_->Settled()) return;
      finished_ = true;
      failure_ = setback_;
      return;
  }
}

// Sets the arm's target so that the object comes to where it is to be. Errors that stay are added up.
void HeldObjectSkill::Follow(const Guidance& guidance) {
  if (last_) {
    const Pose now = ObjectInWorld();
    Eigen::Vector3d error = last_->object_in_world.translation() - now.translation();
    if (guidance.free_along) error -= error.dot(*guidance.free_along) * *guidance.free_along;
    shift_ = Corrected(shift_, error, kMostShift);
    const Quaternion off =
        QuaternionProduct(last_->object_in_world.quaternion(), QuaternionInverse(now.quaternion()));
    turn_ = Corrected(turn_, RotvecFromQuaternion(off), kMostTurn);
  }
  last_ = guidance;
  const Pose wanted(
      guidance.object_in_world.translation() + shift_,
      QuaternionProduct(QuaternionFromRotvec(turn_), guidance.object_in_world.quaternion()));
  const Pose tcp = robot_->base_in_world().inverse() * wanted * object_in_tcp_.inverse();
  if (guidance.at) {
    const auto from = static_cast<size_t>(*guidance.at);
    const size_t to = std::min(from + 1, along_.size() - 1);
    const JointVector planned =
        Blend(along_[from], along_[to], *guidance.at - static_cast<double>(from));
    const IkResult near = Ik(robot_->chain(), tcp,
                             {.tolerance = kLineIkTolerance, .seed = planned, .max_restarts = 0});
    if (near.success && JointDistance(near.q, arm_->target()) < kMostJump)
      return arm_->SetTarget(near.q);
  }
  const IkResult ik = TaskSpaceOf(*robot_).Step(robot_->chain(), tcp, arm_->target());
  if (ik.success) arm_->SetTarget(ik.q);
}

void HeldObjectSkill::TakeHold() {
  object_in_tcp_ = robot_->tcp_in_world().inverse() * ObjectInWorld();
  shift_ = turn_ = Eigen::Vector3d::Zero();
  last_.reset();
}

void HeldObjectSkill::GiveUp(const std::string& why) {
  failure_ = why;
  finished_ = true;
}

Action HeldObjectSkill::Command() const {
  RobotAction action;
  action[robot_->arm().name()] =
      GroupCommand::Joints(std::vector<double>(arm_->target().begin(), arm_->target().end()));
  action[robot_->gripper().name()] = GroupCommand::Opening(opening_);
  return {{robot_->name(), std::move(action)}};
}

}  // namespace robocell::internal
