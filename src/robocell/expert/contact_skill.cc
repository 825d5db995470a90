#include "robocell/expert/contact_skill.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "robocell/expert/pick_plan.h"
#include "robocell/math/rotation.h"
#include "robocell/motion/motion_planner.h"
#include "robocell/motion/vertical_line.h"
#include "robocell/robot/task_space.h"

namespace robocell {
namespace {

constexpr double kReachSpeed = 1.2, kLineSpeed = 0.6;  // of the fastest joint, rad/s (m/s)
constexpr double kLeastFree = 0.15, kLeastLine = 0.5, kLeastFollow = 0.4;  // seconds
constexpr double kMostFollow = 8;
constexpr double kFingerSpeed = 0.2;  // m/s of the distance between the fingers
constexpr double kGripSeconds = 0.5, kMostGripSeconds = 1.2, kFullForceSeconds = 0.25;
constexpr double kLetGoSeconds = 0.4;
constexpr double kSteadyFingers = 3e-4;   // m per tick
constexpr double kClosedFingers = 0.003;  // m above the closed gripper's gap
constexpr double kReachClearances[] = {0.01, 0.003, 0.001};

}  // namespace

ContactSkill::ContactSkill(SkillSettings settings, ContactSkillPlan plan)
    : settings_(std::move(settings)), plan_(std::move(plan)) {}

std::string ContactSkill::phase() const {
  switch (phase_) {
    case Phase::kReach:
      return "reach";
    case Phase::kApproach:
      return "approach";
    case Phase::kClose:
      return "close";
    case Phase::kFollow:
      return plan_.follow_phase;
    case Phase::kRelease:
      return "release";
    case Phase::kRetreat:
      break;
  }
  return "retreat";
}

void ContactSkill::Begin(const Scene& scene, Rng& rng) {
  robot_ = Robot::Of(scene, settings_.robot);
  shape_ = GripperShape::Of(robot_->config(), settings_.sim, scene.timestep());
  arm_.emplace(*robot_, settings_.tick);
  finished_ = false;
  setback_.clear();
  failure_.clear();
  Plan(scene, rng);
  if (!finished_) Enter(Phase::kReach);
}

double ContactSkill::OpeningFor(double gap) const {
  const double range = shape_->open_gap() - shape_->closed_gap();
  return range > 0 ? std::clamp((gap - shape_->closed_gap()) / range, 0.0, 1.0) : 1;
}

void ContactSkill::Plan(const Scene& scene, Rng& rng) {
  PlanningScene planning(scene, *robot_, plan_.target_body, shape_);
  planning.Update();
  ContactMotions motions(planning, {}, JointVector(std::span<const double>(arm_->target())),
                         {.least_share = plan_.least_share, .more = plan_.paths(*robot_, *shape_)});
  std::string why = "nothing in reach";
  for (int i = 0; i < kMostPathSearches; ++i) {
    std::optional<ContactMotion> motion = motions.Next();
    if (!motion) break;
    why = "no free path to the contact";
    const ContactPath& path = motions.paths()[motion->path];
    std::optional<JointPath> reach = FindReach(planning, motion->in.front(), path.free_gap, rng);
    if (!reach) continue;
    reach_ = std::move(*reach);
    motion_ = std::move(motion);
    free_opening_ = OpeningFor(path.free_gap);
    grips_ = path.grips;
    closed_at_ = Grips() ? path.closed_at : 0;
    contact_opening_ = Grips() ? 0 : OpeningFor(path.contact_gap);
    const double range = shape_->open_gap() - shape_->closed_gap();
    opening_step_ = range > 0 ? kFingerSpeed * settings_.tick / range : 1;
    after_ = path.after;
    away_in_tcp_ =
        Rotate(path.tcp_in_world[motion_->along.size() - 1].inverse().quaternion(), path.away);
    length_ = 0;
    for (size_t k = 1; k < motion_->along.size(); ++k)
      length_ +=
          (path.tcp_in_world[k].translation() - path.tcp_in_world[k - 1].translation()).norm();
    return;
  }
  GiveUp(motions.paths().empty() ? plan_.without_paths : why);
}

// The planner moves the arm with the fingers as they are now. They move to their gap on the way, so
// that its path has to be free with that, too.
std::optional<JointPath> ContactSkill::FindReach(PlanningScene& planning, const JointVector& goal,
                                                 double gap, Rng& rng) const {
  const JointVector start = arm_->target();
  for (const double clearance : kReachClearances) {
    const FreeFunction is_free = [&](const JointVector& q) {
      return planning.IsFree(q, {.gap = gap, .clearance = clearance});
    };
    if (!is_free(goal)) continue;
    if (is_free(start) && EdgeIsFree(start, goal, is_free)) return JointPath{start, goal};
    MotionPlanner planner(*robot_, {.clearance = clearance});
    planner.Update();
    const MotionResult found =
        planner.PlanFrom(std::vector<double>(start.begin(), start.end()),
                         {{MotionGoal::Joints(std::vector<double>(goal.begin(), goal.end()))}},
                         {.seed = rng.NextBits(), .iterations = 4000});
    if (!found.success) continue;
    JointPath path;
    for (const std::vector<double>& q : found.path)
      path.push_back(JointVector(std::span<const double>(q)));
    bool all_free = true;
    for (size_t i = 1; i < path.size() && all_free; ++i)
      all_free = EdgeIsFree(path[i - 1], path[i], is_free);
    if (all_free) return path;
  }
  return std::nullopt;
}

// Returns the points of the path from number `begin` on, before `end`.
JointPath ContactSkill::Along(size_t begin, size_t end) const {
  const JointPath& all = motion_->along;
  end = std::min(end, all.size());
  JointPath part;
  for (size_t i = std::min(begin, end); i < end; ++i) part.push_back(all[i]);
  return part;
}

double ContactSkill::PathSeconds() const {
  return std::max(kLeastFollow, plan_.seconds_per_metre * length_);
}

void ContactSkill::Enter(Phase phase) {
  phase_ = phase;
  ticks_ = squeezed_ = 0;
  arm_->Begin();
  switch (phase) {
    case Phase::kReach:
      for (size_t i = 1; i < reach_.size(); ++i) arm_->AddLeg({reach_[i]}, kReachSpeed, kLeastFree);
      break;
    case Phase::kApproach:
      arm_->AddLeg({motion_->in.begin() + 1, motion_->in.end()}, kLineSpeed, kLeastLine);
      break;
    case Phase::kClose:
      last_gap_ = robot_->gripper().inter_finger_dist();
      if (closed_at_ > 0) arm_->AddLeg(Along(1, closed_at_ + 1), kLineSpeed, kLeastLine);
      break;
    case Phase::kFollow:
      arm_->AddLeg(
          Along(closed_at_ + 1, motion_->along.size()), kLineSpeed,
          arm_->GentleSeconds(motion_->along, PathSeconds(), std::max(PathSeconds(), kMostFollow)));
      break;
    case Phase::kRetreat:
      if (motion_->out.size() > 1)
        arm_->AddLeg({motion_->out.begin() + 1, motion_->out.end()}, kLineSpeed, kLeastLine);
      break;
    case Phase::kRelease:
      break;
  }
}

Action ContactSkill::Act(const Scene& /*scene*/, Rng& /*rng*/) {
  if (!finished_) Advance();
  if (!finished_) {
    arm_->Next();
    const bool free = phase_ == Phase::kReach || phase_ == Phase::kApproach ||
                      phase_ == Phase::kRelease || phase_ == Phase::kRetreat;
    const double goal = free ? free_opening_ : contact_opening_;
    opening_ += std::clamp(goal - opening_, -opening_step_, opening_step_);
    ++ticks_;
  }
  RobotAction action;
  action[robot_->arm().name()] =
      GroupCommand::Joints(std::vector<double>(arm_->target().begin(), arm_->target().end()));
  action[robot_->gripper().name()] = GroupCommand::Opening(opening_);
  return {{robot_->name(), std::move(action)}};
}

void ContactSkill::Advance() {
  if (arm_->Blocked()) {
    // A hand that leaves has done its part.
    if (phase_ == Phase::kRetreat) return GiveUp(setback_);
    // Gives way: what is behind the contact may be at its end.
    if (phase_ != Phase::kFollow) return GiveUp("the arm is blocked");
    setback_ = "the arm is blocked";
    arm_->Unblock();
    return BreakOff();
  }
  switch (phase_) {
    case Phase::kReach:
      if (arm_->Settled() && std::abs(opening_ - free_opening_) < 1e-6) Enter(Phase::kApproach);
      return;
    case Phase::kApproach:
      if (arm_->Settled()) Enter(Grips() ? Phase::kClose : Phase::kFollow);
      return;
    case Phase::kClose:
      return LeaveClose();
    case Phase::kFollow:
      if (Grips() && HandIsEmpty()) {
        setback_ = "the handle slipped";
        return BreakOff();
      }
      if (plan_.reached && plan_.reached()) return BreakOff();
      if (arm_->Settled()) Enter(Phase::kRelease);
      return;
    case Phase::kRelease:
      if (ticks_ >= arm_->Ticks(kLetGoSeconds) && std::abs(opening_ - free_opening_) < 1e-6)
        Enter(Phase::kRetreat);
      return;
    case Phase::kRetreat:
      if (!arm_->Settled()) return;
      finished_ = true;
      failure_ = setback_;
      return;
  }
}

// Ends the path where the arm is, and leaves from there as from its end.
void ContactSkill::BreakOff() {
  arm_->TakeMeasured();
  const JointVector q = arm_->target();
  const Pose tcp = robot_->chain().Fk(q);
  const Eigen::Vector3d away = Rotate(tcp.quaternion(), away_in_tcp_);
  motion_->out =
      internal::LineAbove(robot_->chain(), internal::TaskSpaceOf(*robot_), tcp, q, away, after_);
  Enter(Phase::kRelease);
}

void ContactSkill::LeaveClose() {
  const double gap = robot_->gripper().inter_finger_dist();
  const bool steady = std::abs(gap - last_gap_) < kSteadyFingers;
  last_gap_ = gap;
  squeezed_ = opening_ > 0 ? 0 : squeezed_ + 1;
  const int least =
      std::max(arm_->Ticks(kGripSeconds) - ticks_, arm_->Ticks(kFullForceSeconds) - squeezed_);
  if (least > 0 || !arm_->finished() || (!steady && squeezed_ < arm_->Ticks(kMostGripSeconds)))
    return;
  if (!HandIsEmpty()) return Enter(Phase::kFollow);
  setback_ = shape_->is_suction() ? "the cup sticks to nothing" : "the hand closed on nothing";
  motion_->out = {motion_->in.rbegin(), motion_->in.rend()};
  Enter(Phase::kRelease);
}

bool ContactSkill::HandIsEmpty() const {
  if (shape_->is_suction()) return !robot_->gripper().is_grasping(plan_.target_body);
  return robot_->gripper().inter_finger_dist() < shape_->closed_gap() + kClosedFingers;
}

void ContactSkill::GiveUp(const std::string& why) {
  failure_ = why;
  finished_ = true;
}

}  // namespace robocell
