#include "robocell/expert/navigate_expert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/math/pose.h"
#include "robocell/robot/planar_motion.h"
#include "robocell/task/floor_ways.h"
#include "robocell/task/navigate_kind.h"

namespace robocell::internal {
namespace {

constexpr double kMostTicks = 1e5;       // of a leg: no episode is as long
constexpr double kPeakOverMean = 1.875;  // of a leg, relative to its mean speed
constexpr double kMostOfSpeeds = 0.9;    // of what the base can do, that is asked of it
constexpr double kMostBaseLag = 0.3, kMostTurnLag = 0.6;  // m and rad: the base is blocked
constexpr double kBaseLagSeconds = 0.4;
constexpr double kBaseArrived = 0.03;    // m and rad
constexpr double kBaseAtRest = 0.02;     // m/s and rad/s
constexpr double kMostBaseSettle = 1.5;  // s

double RestToRest(double t) { return t * t * t * (10 + t * (-15 + 6 * t)); }

std::shared_ptr<const NavigateTask> NavigateTaskOf(const RunConfig& run,
                                                   const EpisodeStart& start) {
  auto task = std::dynamic_pointer_cast<const NavigateTask>(start.task);
  if (task) return task;
  throw SpecError(fmt::format(
      "run '{}': the expert 'navigate' demonstrates tasks of that kind, and the task is '{}'",
      run.run, run.task.kind()));
}

}  // namespace

GuidedBase::GuidedBase(const Robot& robot, std::span<const FloorPlace> way, const Speeds& speeds,
                       double tick)
    : robot_(robot), tick_(tick), joints_(robot_.base().joint_pos()) {
  const PlanarMotion* motion = PlanarMotion::Of(robot_.base());
  if (!motion) throw ArgumentError("robot '" + robot.name() + "' has no base that drives");
  const BaseSpeeds most = motion->most_speeds();
  const double drive = std::min(speeds.drive, kMostOfSpeeds * most.linear),
               turn = std::min(speeds.turn, kMostOfSpeeds * most.angular);
  present_ = robot_.base().pose();
  const double height = present_.translation().z();
  const Pose drive_frame = motion->drive_frame();
  FloorPlace from = PlaceOf(present_ * drive_frame);
  std::vector<double> joints = joints_;
  for (const FloorPlace& to : way) {
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    const double turned = std::remainder(to.yaw - from.yaw, 2 * kPi);
    const double angle = std::abs(turned);
    const double seconds = kPeakOverMean * std::max(length / drive, angle / turn);
    const int ticks = static_cast<int>(std::ceil(std::min(seconds / tick, kMostTicks) - 1e-9));
    for (int i = 1; i <= ticks; ++i) {
      const double s = RestToRest(static_cast<double>(i) / ticks);
      const FloorPlace at{std::lerp(from.x, to.x, s), std::lerp(from.y, to.y, s),
                          from.yaw + s * turned};
      const Pose pose = PoseOf(at, height) * drive_frame.inverse();
      joints = motion->JointsAt(pose, joints);
      targets_.push_back({joints, pose, angle / turn > length / drive});
    }
    from = {to.x, to.y, from.yaw + turned};
  }
}

const std::vector<double>& GuidedBase::Next() {
  if (finished()) return joints_;
  const Target& target = targets_[next_++];
  present_ = target.pose;
  joints_ = target.joints;
  return joints_;
}

bool GuidedBase::turns() const {
  return !targets_.empty() && targets_[std::min(next_, targets_.size() - 1)].turns;
}

GuidedBase::Lag GuidedBase::lag() const {
  const FloorPlace at = PlaceOf(robot_.base().pose()), to = PlaceOf(present_);
  return {.place = std::hypot(at.x - to.x, at.y - to.y),
          .turn = std::abs(std::remainder(at.yaw - to.yaw, 2 * kPi))};
}

bool GuidedBase::Blocked() {
  const auto [place, turn] = lag();
  lagging_ = place > kMostBaseLag || turn > kMostTurnLag ? lagging_ + 1 : 0;
  return lagging_ * tick_ > kBaseLagSeconds;
}

bool GuidedBase::AtRest() const {
  const auto [place, turn] = lag();
  const std::vector<double> speed = robot_.base().joint_vel();
  return finished() && place < kBaseArrived && turn < kBaseArrived &&
         std::ranges::all_of(speed, [](double v) { return std::abs(v) < kBaseAtRest; });
}

NavigateExpert::NavigateExpert(std::string robot, std::shared_ptr<const NavigateTask> task,
                               double tick)
    : robot_name_(std::move(robot)), task_(std::move(task)), tick_(tick) {}

NavigateExpert::NavigateExpert(const RunConfig& run, const EpisodeStart& start)
    : NavigateExpert(run.robot.config.name, NavigateTaskOf(run, start), run.rates.policy_period()) {
}

void NavigateExpert::Begin(const Scene& scene, Rng& /*rng*/) {
  robot_ = Robot::Of(scene, robot_name_);
  phase_ = Phase::kTurn;
  waited_ = 0;
  finished_ = false;
  failure_.clear();
  const auto way = task_->FindWay(*robot_);
  if (!way) {
    failure_ = NavigateTask::kNoWay;
    finished_ = true;
    return;
  }
  const NavigateTaskConfig& fields = task_->fields();
  base_.emplace(*robot_, *way, GuidedBase::Speeds{fields.speed, fields.turn_speed}, tick_);
}

Action NavigateExpert::Act(const Scene& /*scene*/, Rng& /*rng*/) {
  if (!base_) return {};
  if (!finished_ && base_->Blocked()) {
    failure_ = "the base is blocked";
    finished_ = true;
  }
  if (!finished_ && base_->finished()) {
    phase_ = Phase::kSettle;
    if (base_->AtRest() || ++waited_ * tick_ > kMostBaseSettle) {
      phase_ = Phase::kDone;
      finished_ = true;
    }
  } else if (!finished_) {
    phase_ = base_->turns() ? Phase::kTurn : Phase::kDrive;
  }
  RobotAction action;
  action[robot_->base().name()] = GroupCommand::Joints(base_->Next());
  return {{robot_name_, std::move(action)}};
}

namespace {

class KindOfNavigateExpert final : public ExpertKind {
 public:
  std::shared_ptr<Expert> Make(const RunConfig& run, const EpisodeStart& start) const override {
    return std::make_shared<NavigateExpert>(run, start);
  }
  bool is_built_in() const override { return true; }
  void Validate(const RunConfig& run, const Scene& /*scene*/, Robot& /*robot*/, Problems& problems,
                Problems& /*doubts*/) const override {
    const Problems::Scope scope(problems, "robot");
    ValidateDrivenPlanarBase(run.robot.config, problems);
  }
  void ValidateRobot(const Robot& robot, Problems& problems) const override {
    ValidateDrivenPlanarBase(robot.config(), problems);
  }
};

}  // namespace

std::shared_ptr<const ExpertKind> MakeNavigateExpert() {
  return std::make_shared<KindOfNavigateExpert>();
}

}  // namespace robocell::internal
