#include "robocell/expert/navigate_expert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/units.h"
#include "robocell/math/pose.h"
#include "robocell/task/navigate_kind.h"

namespace robocell {
namespace {

constexpr double kPeakOverMean = 1.875;  // of a leg, relative to its mean speed
constexpr double kMostBaseLag = 0.25;    // m and rad behind the target: the base is blocked
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
    : robot_(robot), tick_(tick), present_(robot_.base().joint_pos()) {
  // From the world to the frame in which the joints x, y and yaw move the base.
  const BaseGroup& base = robot_.base();
  const Pose joints = Pose::FromRpy({present_[0], present_[1], 0}, {0, 0, present_[2]});
  const Pose mount = base.pose() * joints.inverse();
  const double mount_yaw = internal::PlaceOf(mount).yaw;
  const Pose world_in_mount = mount.inverse();
  std::vector<double> from = present_;
  for (const FloorPlace& place : way) {
    const Eigen::Vector3d at =
        world_in_mount * Eigen::Vector3d(place.x, place.y, base.pose().translation().z());
    const std::vector<double> to = {
        at.x(), at.y(),
        from[2] + std::remainder(place.yaw - mount_yaw - from[2], 2 * internal::kPi)};
    const double length = std::hypot(to[0] - from[0], to[1] - from[1]);
    const double angle = std::abs(to[2] - from[2]);
    const double seconds = kPeakOverMean * std::max(length / speeds.drive, angle / speeds.turn);
    const int ticks = static_cast<int>(std::ceil(seconds / tick - 1e-9));
    for (int i = 1; i <= ticks; ++i) {
      const double s = RestToRest(static_cast<double>(i) / ticks);
      Target target{.joints = {}, .turns = angle / speeds.turn > length / speeds.drive};
      for (size_t j = 0; j < 3; ++j) target.joints.push_back(std::lerp(from[j], to[j], s));
      targets_.push_back(std::move(target));
    }
    from = to;
  }
}

const std::vector<double>& GuidedBase::Next() {
  if (!finished()) present_ = targets_[next_++].joints;
  return present_;
}

bool GuidedBase::turns() const {
  return !targets_.empty() && targets_[std::min(next_, targets_.size() - 1)].turns;
}

bool GuidedBase::Blocked() {
  const std::vector<double> at = robot_.base().joint_pos();
  bool lags = false;
  for (size_t j = 0; j < 3; ++j) lags = lags || std::abs(at[j] - present_[j]) > kMostBaseLag;
  lagging_ = lags ? lagging_ + 1 : 0;
  return lagging_ * tick_ > kBaseLagSeconds;
}

bool GuidedBase::AtRest() const {
  const std::vector<double> at = robot_.base().joint_pos(), speed = robot_.base().joint_vel();
  for (size_t j = 0; j < 3; ++j)
    if (std::abs(at[j] - present_[j]) > kBaseArrived || std::abs(speed[j]) > kBaseAtRest)
      return false;
  return finished();
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

namespace internal {
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

}  // namespace internal
}  // namespace robocell
