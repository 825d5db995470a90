#include "robocell/expert/pick_planner.h"

#include <algorithm>
#include <cmath>

#include "robocell/motion/geom_extent.h"
#include "robocell/task/pick_task_config.h"
#include "robocell/task/run_arms.h"

namespace robocell {
namespace {

constexpr double kOpenSeconds = 0.1;    // wait at the start if the hand is already open
constexpr double kReopenSeconds = 0.4;  // after a failure: the object may fall
constexpr double kMostOpenSeconds = 1.0;
constexpr double kCloseSeconds = 0.5;  // weak servos take this long to build up their force
constexpr double kMostCloseSeconds = 1.0;
// Speed of the distance between the closing fingers, m/s. A contact with MuJoCo's default
// parameters stops a finger within 20 ms: at half of this speed each finger penetrates by 1 mm, and
// the walls of some objects are that thin. One command to close would let a light finger pass
// through them.
constexpr double kCloseSpeed = 0.2;
constexpr double kSqueezeSeconds = 0.2;  // least duration of the full force
constexpr double kHoldSeconds = 0.33;    // wait at the top
constexpr double kLeastFreeSeconds = 0.15, kLeastDownSeconds = 0.5, kLeastUpSeconds = 0.6;
constexpr double kMostUpSeconds = 2.5;
constexpr double kSteadyGap = 3e-4;  // metres per tick
constexpr double kEmptyGap = 0.003;  // above the closed gripper's gap: nothing is held
constexpr double kWideGap = 0.008;   // above the object's width: another object is held
constexpr double kRisenShare = 0.5;  // share of the lift that the object must have made

}  // namespace

PickPlannerOptions PickPlannerOptionsOf(const RunConfig& run) {
  // Other tasks that pick an object up lift like a pick does by default.
  const std::optional<PickRun> pick = PickRunOf(run.task);
  const GraspMotionOptions motion = GraspMotionsToLift(pick ? pick->lift_height : kLiftHeight);
  return {.tick = run.rates.policy_period(), .above = motion.above, .lift = motion.lift};
}

PickPlanner::PickPlanner(std::string robot, std::string target_object, SimOptions sim,
                         const PickPlannerOptions& options)
    : robot_name_(std::move(robot)),
      target_object_(std::move(target_object)),
      sim_(std::move(sim)),
      options_(options) {}

PickPlanner::PickPlanner(const RunConfig& run, const EpisodeStart& start)
    : PickPlanner(internal::FirstArmOfRun(run), start.target_object, run.options,
                  PickPlannerOptionsOf(run)) {}

PickPlanner::~PickPlanner() = default;

std::vector<std::string> PickPlanner::phase_names() const {
  return {"open", "pregrasp", "grasp", "close", "lift", "done"};
}

void PickPlanner::Begin(const Scene& scene, Rng& rng) {
  robot_ = Robot::Of(scene, robot_name_);
  shape_ = GripperShape::Of(robot_->config(), sim_, scene.timestep());
  planning_ = std::make_unique<PlanningScene>(
      scene, *robot_, scene.compiled()->object(target_object_).root_body, shape_);
  home_ = JointVector(std::span<const double>(robot_->arm().joint_pos()));
  arm_.emplace(*robot_, options_.tick);
  plan_.reset();
  retreat_ = {};
  failed_.clear();
  attempts_ = 0;
  finished_ = false;
  failure_.clear();
  setback_.clear();
  Enter(Phase::kOpen);
  Plan(rng);
}

bool PickPlanner::Plan(Rng& rng) {
  planning_->Update();
  planned_for_ = TargetPose();
  const PickPlanRequest request{.start = arm_->target(),
                                .home = home_,
                                .tcp_now = robot_->tcp_in_world(),
                                .avoid = failed_,
                                .motion = {.above = options_.above, .lift = options_.lift},
                                .usable = options_.usable};
  PickPlanResult result = PlanPick(*planning_, request, rng);
  plan_ = std::move(result.plan);
  if (!plan_) GiveUp(setback_.empty() ? result.failure : setback_);
  return plan_.has_value();
}

void PickPlanner::Enter(Phase phase) {
  phase_ = phase;
  ticks_ = squeezed_ = 0;
  arm_->Begin();
  switch (phase) {
    case Phase::kOpen:
      opening_ = 1;
      if (!retreat_.empty()) {
        arm_->AddLeg({arm_->target()}, options_.line_speed, kReopenSeconds);
        arm_->AddLeg({retreat_}, options_.line_speed, kLeastDownSeconds);
      }
      break;
    case Phase::kPregrasp:
      opening_ = ApproachOpening();
      retreat_ = arm_->target();
      for (size_t i = 1; i < plan_->approach.size(); ++i) {
        arm_->AddLeg({plan_->approach[i]}, options_.free_speed, kLeastFreeSeconds);
      }
      break;
    case Phase::kGrasp:
      retreat_ = plan_->motion.down.front();
      arm_->AddLeg({plan_->motion.down.begin() + 1, plan_->motion.down.end()}, options_.line_speed,
                   kLeastDownSeconds);
      break;
    case Phase::kClose:
      last_gap_ = Gap();
      break;
    case Phase::kLift:
      retreat_ = {};
      grasp_height_ = TargetHeight();
      arm_->AddLeg({plan_->motion.up.begin() + 1, plan_->motion.up.end()}, options_.line_speed,
                   arm_->GentleSeconds(plan_->motion.up, kLeastUpSeconds, kMostUpSeconds));
      break;
    case Phase::kDone:
      break;
  }
}

Action PickPlanner::Act(const Scene&, Rng& rng) {
  if (!arm_) {
    throw Error(
        "PickPlanner: Act came before Begin was through; a subclass with its own Begin calls the "
        "planner's first (in Python super().begin(scene, rng))");
  }
  if (!finished_) Watch();
  if (!finished_) Advance(rng);
  if (!finished_) {
    arm_->Next();
    if (phase_ == Phase::kClose) CloseFurther();
    ++ticks_;
  }
  return Command();
}

// Moves on to the next phase when this one has done its work.
void PickPlanner::Advance(Rng& rng) {
  switch (phase_) {
    case Phase::kOpen:
      return LeaveOpen(rng);
    case Phase::kPregrasp:
      return Follow(Phase::kGrasp);
    case Phase::kGrasp:
      return Follow(Phase::kClose);
    case Phase::kClose:
      return LeaveClose();
    case Phase::kLift:
      Follow(Phase::kDone);
      if (phase_ == Phase::kDone && TargetHeight() < grasp_height_ + kRisenShare * options_.lift)
        Fail("the object slipped");
      return;
    case Phase::kDone:
      if (ticks_ >= Ticks(kHoldSeconds)) finished_ = true;
      return;
  }
}

void PickPlanner::LeaveOpen(Rng& rng) {
  if (!arm_->finished() || ticks_ < Ticks(plan_ ? kOpenSeconds : kReopenSeconds)) return;
  const bool open = robot_->gripper().opening() >= kOpened;
  if (!open && ticks_ < Ticks(kMostOpenSeconds)) return;
  if (!plan_ && !Plan(rng)) return;
  ++attempts_;
  Enter(Phase::kPregrasp);
}

void PickPlanner::Follow(Phase next) {
  if (arm_->Settled()) Enter(next);
}

void PickPlanner::CloseFurther() {
  if (shape_->is_suction()) {
    opening_ = 0;
    return;
  }
  const double range = shape_->open_gap() - shape_->closed_gap();
  opening_ = std::max(0.0, opening_ - kCloseSpeed * options_.tick / range);
}

void PickPlanner::LeaveClose() {
  const double gap = Gap();
  const bool steady = std::abs(gap - last_gap_) < kSteadyGap;
  last_gap_ = gap;
  squeezed_ = opening_ > 0 ? 0 : squeezed_ + 1;
  const int least = std::max(Ticks(kCloseSeconds) - ticks_, Ticks(kSqueezeSeconds) - squeezed_);
  if (least > 0 || (!steady && squeezed_ < Ticks(kMostCloseSeconds))) return;
  if (HandIsEmpty())
    return Fail(shape_->is_suction() ? "the cup sticks to nothing" : "the hand closed on nothing");
  if (gap > plan_->motion.grasp.width + kWideGap)
    return Fail("the fingers stopped on something else");
  Enter(Phase::kLift);
}

// Checks for problems that can occur at any time.
void PickPlanner::Watch() {
  if (arm_->Blocked()) return Fail("the arm is blocked");
  if ((phase_ == Phase::kLift || phase_ == Phase::kDone) && HandIsEmpty())
    Fail("the object slipped");
}

// Re-opens, backs off and plans again, or gives up.
void PickPlanner::Fail(const std::string& why) {
  setback_ = why;
  // Blocked while backing off: there is no other grasp to back off to.
  if (!plan_ || attempts_ >= options_.attempts) return GiveUp(why);
  // The place to which the object has been pushed meanwhile says nothing about the grasp.
  failed_.push_back(planned_for_.inverse() * plan_->motion.grasp.tcp_in_world);
  plan_.reset();
  arm_->Unblock();
  arm_->TakeMeasured();
  Enter(Phase::kOpen);
}

void PickPlanner::GiveUp(const std::string& why) {
  failure_ = why;
  finished_ = true;
}

Action PickPlanner::Command() const {
  RobotAction action;
  action[robot_->arm().name()] =
      GroupCommand::Joints(std::vector<double>(arm_->target().begin(), arm_->target().end()));
  action[robot_->gripper().name()] = GroupCommand::Opening(opening_);
  return {{robot_->name(), std::move(action)}};
}

double PickPlanner::Gap() const { return robot_->gripper().inter_finger_dist(); }
double PickPlanner::ApproachOpening() const {
  const double wanted = plan_->motion.grasp.opening;
  const double range = shape_->open_gap() - shape_->closed_gap();
  if (wanted <= 0 || range <= 0) return 1;
  return std::clamp((wanted - shape_->closed_gap()) / range, 0.0, 1.0);
}
bool PickPlanner::HandIsEmpty() const {
  // The gap of the fingers does not show a thin wall between them.
  const bool thin = plan_ && plan_->motion.grasp.width <
                                 WidthsHeld(shape_->closed_gap(), shape_->open_gap()).least;
  if (!shape_->is_suction() && !thin) return Gap() < shape_->closed_gap() + kEmptyGap;
  const Scene scene = robot_->scene();
  return !robot_->gripper().is_grasping(scene.compiled()->object(target_object_).root_body);
}

Pose PickPlanner::TargetPose() const {
  const Scene scene = robot_->scene();
  return scene.body_pose(scene.compiled()->object(target_object_).root_body);
}

}  // namespace robocell
