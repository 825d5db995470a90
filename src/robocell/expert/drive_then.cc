#include "robocell/expert/drive_then.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "robocell/base/units.h"
#include "robocell/math/pose.h"
#include "robocell/robot/planar_motion.h"
#include "robocell/task/floor_ways.h"
#include "robocell/task/navigate_task.h"
#include "robocell/task/work_stances.h"

namespace robocell::internal {
namespace {

constexpr int kMostDrives = 3;        // until the other expert finds a plan
constexpr int kPlacesTried = 10;      // by the other expert, before each drive
constexpr size_t kMostWayGoals = 48;  // of a way
constexpr double kFewGraspsShare =
    0.5;  // share of the most grasps in reach, below which places wait
constexpr double kSameStance = 0.12,
                 kSameStanceTurn = 0.35;  // m and rad around a place that was rejected
constexpr double kDriveSettle = 1.5;      // s
constexpr GuidedBase::Speeds kDriveSpeeds{.drive = 0.6, .turn = 1.2};

constexpr const char* kDrivePhases[] = {"turn", "drive", "settle"};
constexpr int kTurnPhase = 0, kDrivePhase = 1, kSettlePhase = 2, kOwnPhases = 3;

}  // namespace

DriveThen::DriveThen(const RunConfig& run, const EpisodeStart& start, MakeExpert make)
    : robot_name_(run.robot.config.name),
      object_(start.target_object),
      tick_(run.rates.policy_period()),
      make_(std::move(make)),
      expert_(make_()) {}

void DriveThen::Begin(const Scene& scene, Rng& rng) {
  robot_ = Robot::Of(scene, robot_name_);
  base_.reset();
  rejected_.clear();
  works_ = false;
  waited_ = drives_ = 0;
  phase_ = kTurnPhase;
  failure_.clear();
  scene.SyncPoses();
  const Eigen::Vector3d target =
      scene.body_pose(scene.compiled()->object(object_).root_body).translation();
  const auto distances = DistancesInReach(*robot_, target);
  const double away = (target - robot_->base().pose().translation()).head<2>().norm();
  if (distances && away <= (*distances)[1] && BeginsWork(scene, rng)) return;
  PlanDrive(scene, rng);
}

bool DriveThen::BeginsWork(const Scene& scene, Rng& rng) {
  expert_->Begin(scene, rng);
  works_ = expert_->failure().empty();
  return works_;
}

// Places near one that was rejected are no better.
void DriveThen::Reject(const FloorPlace& place) { rejected_.push_back(place); }

bool DriveThen::CanWorkAt(Scene& copy, const Pose& base, Rng& rng) const {
  Robot::Of(copy, robot_name_).base().SetPose(base);
  copy.Forward();
  const std::shared_ptr<Expert> expert = make_();
  expert->Begin(copy, rng);
  return expert->failure().empty();
}

void DriveThen::PlanDrive(const Scene& scene, Rng& rng) {
  scene.SyncPoses();
  base_.reset();
  const std::string& body = scene.compiled()->object(object_).root_body;
  const std::vector<WorkStance> stances = FindWorkStances(*robot_, body);
  if (stances.empty()) {
    failure_ = kNoStance;
    return;
  }
  Scene copy = Scene::FromCompiled(scene.compiled()->Copy());
  copy.SetState(scene.state());
  FloorWays ways(*robot_);
  const Pose drive_frame = PlanarMotion::Of(robot_->base())->drive_frame();
  const double height = robot_->base().pose().translation().z();
  failure_ = NavigateTask::kNoWay;
  int least = static_cast<int>(std::ceil(kFewGraspsShare * stances.front().grasps));
  std::vector<char> is_out(stances.size(), 0);  // no way leads there
  for (int tried = 0; tried < kPlacesTried;) {
    std::vector<FloorPlace> goals;
    std::vector<size_t> numbers;
    for (size_t i = 0; i < stances.size() && goals.size() < kMostWayGoals; ++i) {
      const WorkStance& stance = stances[i];
      const bool is_rejected = std::ranges::any_of(rejected_, [&](const FloorPlace& other) {
        return std::hypot(stance.base.x - other.x, stance.base.y - other.y) < kSameStance &&
               std::abs(std::remainder(stance.base.yaw - other.yaw, 2 * kPi)) < kSameStanceTurn;
      });
      if (is_out[i] || is_rejected || stance.grasps < least) continue;
      goals.push_back(PlaceOf(PoseOf(stance.base, height) * drive_frame));
      numbers.push_back(i);
    }
    if (goals.empty() && least <= 1) return;
    if (goals.empty()) {
      least = 1;
      continue;
    }
    const auto way = ways.FindWay(goals);
    if (!way) {
      for (const size_t i : numbers) is_out[i] = 1;
      continue;
    }
    ++tried;
    const Pose base = PoseOf(way->back(), height) * drive_frame.inverse();
    goal_ = PlaceOf(base);
    Rng trial = rng.Fork("place").Fork(static_cast<int64_t>(rejected_.size()));
    if (CanWorkAt(copy, base, trial)) {
      failure_.clear();
      ++drives_;
      waited_ = 0;
      base_.emplace(*robot_, *way, kDriveSpeeds, tick_);
      return;
    }
    failure_ = kNoStance;
    Reject(goal_);
  }
}

void DriveThen::See(const CellRow& row) {
  if (works_) expert_->See(row);
}

Action DriveThen::Act(const Scene& scene, Rng& rng) {
  if (!works_ && failure_.empty() && base_->Blocked()) failure_ = "the base is blocked";
  if (!works_ && failure_.empty() && base_->finished()) {
    phase_ = kSettlePhase;
    if (base_->AtRest() || ++waited_ * tick_ > kDriveSettle) {
      if (!BeginsWork(scene, rng)) {
        Reject(goal_);
        if (drives_ < kMostDrives)
          PlanDrive(scene, rng);
        else
          failure_ = expert_->failure();
      }
    }
  }
  if (works_) return expert_->Act(scene, rng);
  if (!base_) return {};
  if (failure_.empty() && !base_->finished()) phase_ = base_->turns() ? kTurnPhase : kDrivePhase;
  RobotAction action;
  action[robot_->base().name()] = GroupCommand::Joints(base_->Next());
  return {{robot_name_, std::move(action)}};
}

int DriveThen::phase() const { return works_ ? kOwnPhases + expert_->phase() : phase_; }

std::vector<std::string> DriveThen::phase_names() const {
  std::vector<std::string> names(std::begin(kDrivePhases), std::end(kDrivePhases));
  for (const std::string& name : expert_->phase_names()) names.push_back(name);
  return names;
}

std::shared_ptr<Expert> WithDrive(const RunConfig& run, const EpisodeStart& start,
                                  DriveThen::MakeExpert make) {
  if (!DrivesItself(run.robot.config)) return make();
  return std::make_shared<DriveThen>(run, start, std::move(make));
}

}  // namespace robocell::internal
