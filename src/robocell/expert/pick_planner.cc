#include "robocell/expert/pick_planner.h"

#include <algorithm>
#include <cmath>

#include "robocell/motion/geom_extent.h"
#include "robocell/motion/servo_jump.h"
#include "robocell/robot/arrival.h"

namespace robocell {
namespace {

constexpr double kOpenSeconds = 0.1;    // at the start, when the hand is open already
constexpr double kReopenSeconds = 0.4;  // after a failure: the object may fall
constexpr double kMostOpenSeconds = 1.0;
constexpr double kSettleSeconds = 0.1;      // after a motion ...
constexpr double kMostSettleSeconds = 0.5;  // ... and while the arm is still on its way
// The arm is near enough for the next motion, which it can begin from anywhere near: within as many
// tolerances, and never less than these, rad and m.
constexpr double kNearlyArrived = 2, kNearRad = 0.02, kNearMetres = 0.002;
constexpr double kCloseSeconds = 0.5;  // weak servos take this long to build up their force
constexpr double kMostCloseSeconds = 1.0;
// Of the distance between the fingers while they close, m/s. A contact as MuJoCo has it by default
// stops a finger within 20 ms: at half of this each it goes 1 mm deep, and walls are some thick.
// One command to close would let a light finger go through them.
constexpr double kCloseSpeed = 0.2;
constexpr double kSqueezeSeconds = 0.2;  // of the full force, at least
constexpr double kHoldSeconds = 0.33;    // at the top
constexpr double kLeastFreeSeconds = 0.15, kLeastDownSeconds = 0.5, kLeastUpSeconds = 0.6;
constexpr double kMostUpSeconds = 2.5;
constexpr double kSteadyGap = 3e-4;     // metres per tick
constexpr double kEmptyGap = 0.003;     // above the closed gripper's: nothing is held
constexpr double kWideGap = 0.008;      // above the object's width: something else is held
constexpr double kMostLag = 0.25;       // rad between target and joint: the arm is blocked
constexpr double kMostSlideLag = 0.08;  // ... in metres
constexpr double kLagSeconds = 0.2;
constexpr double kOpened = 0.9;      // opening that counts as open
constexpr double kRisenShare = 0.5;  // of the lift that the object must have made

PickPlannerOptions OptionsOf(const RunConfig& run) {
  // Other tasks that pick something up lift as a pick does.
  const auto* pick = run.task.If<PickTaskConfig>();
  const GraspMotionOptions motion = GraspMotionOptionsOf(pick ? *pick : PickTaskConfig());
  return {.tick = run.rates.policy_period(), .above = motion.above, .lift = motion.lift};
}

}  // namespace

PickPlanner::PickPlanner(std::string robot, std::string target_object, SimOptions sim,
                         const PickPlannerOptions& options)
    : robot_name_(std::move(robot)),
      target_object_(std::move(target_object)),
      sim_(std::move(sim)),
      options_(options) {}

PickPlanner::PickPlanner(const RunConfig& run, const EpisodeStart& start)
    : PickPlanner(run.robot.config.name, start.target_object, run.options, OptionsOf(run)) {}

PickPlanner::~PickPlanner() = default;

std::vector<std::string> PickPlanner::phase_names() const {
  return {"open", "pregrasp", "grasp", "close", "lift", "done"};
}

void PickPlanner::Begin(const Scene& scene, Rng& rng) {
  robot_ = Robot::Of(scene, robot_name_);
  shape_ = GripperShape::Of(robot_->config(), sim_, scene.timestep());
  planning_ = std::make_unique<PlanningScene>(
      scene, *robot_, scene.compiled()->object(target_object_).root_body, shape_);
  arrival_tolerances_ = ArrivalTolerances(*robot_, robot_->arm().name());
  for (size_t i = 0; i < arrival_tolerances_.size(); ++i) {
    const bool slide = robot_->chain().joints()[i].type == ChainJointType::kSlide;
    arrival_tolerances_[i] =
        std::max(kNearlyArrived * arrival_tolerances_[i], slide ? kNearMetres : kNearRad);
  }
  home_ = JointVector(std::span<const double>(robot_->arm().joint_pos()));
  target_ = JointVector(robot_->controller(robot_->arm().name()).commanded_joint_pos());
  plan_.reset();
  path_.reset();
  retreat_ = {};
  failed_.clear();
  attempts_ = 0;
  lagging_ = 0;
  finished_ = false;
  failure_.clear();
  setback_.clear();
  Enter(Phase::kOpen);
  Plan(rng);
}

bool PickPlanner::Plan(Rng& rng) {
  planning_->Update();
  planned_for_ = TargetPose();
  const PickPlanRequest request{.start = target_,
                                .home = home_,
                                .tcp_now = robot_->tcp_in_world(),
                                .avoid = failed_,
                                .motion = {.above = options_.above, .lift = options_.lift}};
  PickPlanResult result = PlanPick(*planning_, request, rng);
  plan_ = std::move(result.plan);
  if (!plan_) GiveUp(setback_.empty() ? result.failure : setback_);
  return plan_.has_value();
}

void PickPlanner::Enter(Phase phase) {
  phase_ = phase;
  ticks_ = waited_ = squeezed_ = 0;
  path_.emplace(target_, options_.tick);
  switch (phase) {
    case Phase::kOpen:
      opening_ = 1;
      if (!retreat_.empty()) {
        path_->AddLeg({target_}, options_.line_speed, kReopenSeconds);
        path_->AddLeg({retreat_}, options_.line_speed, kLeastDownSeconds);
      }
      break;
    case Phase::kPregrasp:
      retreat_ = target_;
      for (size_t i = 1; i < plan_->approach.size(); ++i) {
        path_->AddLeg({plan_->approach[i]}, options_.free_speed, kLeastFreeSeconds);
      }
      break;
    case Phase::kGrasp:
      retreat_ = plan_->motion.down.front();
      path_->AddLeg({plan_->motion.down.begin() + 1, plan_->motion.down.end()}, options_.line_speed,
                    kLeastDownSeconds);
      break;
    case Phase::kClose:
      last_gap_ = Gap();
      break;
    case Phase::kLift:
      retreat_ = {};
      grasp_height_ = TargetHeight();
      path_->AddLeg({plan_->motion.up.begin() + 1, plan_->motion.up.end()}, options_.line_speed,
                    LiftSeconds());
      break;
    case Phase::kDone:
      break;
  }
}

Action PickPlanner::Act(const Scene&, Rng& rng) {
  if (!path_) {
    throw Error(
        "PickPlanner: Act came before Begin was through; a subclass with a Begin of its own "
        "calls the planner's first (in Python super().begin(scene, rng))");
  }
  if (!finished_) Watch();
  if (!finished_) Advance(rng);
  if (!finished_) {
    target_ = path_->Next();
    if (phase_ == Phase::kClose) CloseFurther();
    ++ticks_;
  }
  return Command();
}

// Moves on to the next phase when this one has done its work.
void PickPlanner::Advance(Rng& rng) {
  if (path_->finished()) ++waited_;
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
  if (!path_->finished() || ticks_ < Ticks(plan_ ? kOpenSeconds : kReopenSeconds)) return;
  const bool open = robot_->gripper().opening() >= kOpened;
  if (!open && ticks_ < Ticks(kMostOpenSeconds)) return;
  if (!plan_ && !Plan(rng)) return;
  ++attempts_;
  Enter(Phase::kPregrasp);
}

void PickPlanner::Follow(Phase next) {
  if (!path_->finished() || waited_ <= Ticks(kSettleSeconds)) return;
  if (!Arrived() && waited_ <= Ticks(kMostSettleSeconds)) return;
  Enter(next);
}

void PickPlanner::CloseFurther() {
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
  if (HandIsEmpty()) return Fail("the hand closed on nothing");
  if (gap > plan_->motion.grasp.width + kWideGap)
    return Fail("the fingers stopped on something else");
  Enter(Phase::kLift);
}

// What can go wrong at any time.
void PickPlanner::Watch() {
  lagging_ = Lag() > 1 ? lagging_ + 1 : 0;
  if (lagging_ > Ticks(kLagSeconds)) return Fail("the arm is blocked");
  if ((phase_ == Phase::kLift || phase_ == Phase::kDone) && HandIsEmpty())
    Fail("the object slipped");
}

// Re-opens, backs off and plans again, or gives up.
void PickPlanner::Fail(const std::string& why) {
  setback_ = why;
  // Blocked while backing off: there is no other grasp to back off to.
  if (!plan_ || attempts_ >= options_.attempts) return GiveUp(why);
  // Where it has been pushed to meanwhile tells nothing of the grasp.
  failed_.push_back(planned_for_.inverse() * plan_->motion.grasp.tcp_in_world);
  plan_.reset();
  lagging_ = 0;
  target_ = JointVector(std::span<const double>(robot_->arm().joint_pos()));
  Enter(Phase::kOpen);
}

void PickPlanner::GiveUp(const std::string& why) {
  failure_ = why;
  finished_ = true;
}

Action PickPlanner::Command() const {
  RobotAction action;
  action[robot_->arm().name()] =
      GroupCommand::Joints(std::vector<double>(target_.begin(), target_.end()));
  action[robot_->gripper().name()] = GroupCommand::Opening(opening_);
  return {{robot_->name(), std::move(action)}};
}

int PickPlanner::Ticks(double seconds) const {
  return static_cast<int>(std::ceil(seconds / options_.tick - 1e-9));
}

// What is held must not be shaken out of the hand.
double PickPlanner::LiftSeconds() const {
  const std::vector<double> jumps = ServoJumps(robot_->scene().model(), robot_->arm());
  return std::clamp(SecondsForJumps(plan_->motion.up, jumps, options_.tick), kLeastUpSeconds,
                    kMostUpSeconds);
}

// How far the worst joint is behind its target, as a share of what counts as blocked.
double PickPlanner::Lag() const {
  const std::vector<double> q = robot_->arm().joint_pos();
  double lag = 0;
  for (int i = 0; i < target_.size(); ++i) {
    const bool slide = robot_->chain().joints()[i].type == ChainJointType::kSlide;
    lag = std::max(lag, std::abs(q[i] - target_[i]) / (slide ? kMostSlideLag : kMostLag));
  }
  return lag;
}

bool PickPlanner::Arrived() const {
  return AreWithin(robot_->arm().joint_pos(), target_, arrival_tolerances_);
}

double PickPlanner::Gap() const { return robot_->gripper().inter_finger_dist(); }
bool PickPlanner::HandIsEmpty() const { return Gap() < shape_->closed_gap() + kEmptyGap; }

Pose PickPlanner::TargetPose() const {
  const Scene scene = robot_->scene();
  return scene.body_pose(scene.compiled()->object(target_object_).root_body);
}

}  // namespace robocell
