// The skill that sets down an object that is in a hand: straight down until something is in the way,
// then the hand opens and draws back. With several arms it comes before another arm takes the object.
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

#include "robocell/expert/arm_pair.h"
#include "robocell/expert/guided_arm.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/expert/skill.h"
#include "robocell/math/rotation.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/motion/joint_path.h"
#include "robocell/motion/motion_planner.h"
#include "robocell/mujoco/names.h"
#include "robocell/scenes/landmarks.h"

namespace robocell {
namespace internal::put_down {
namespace {

constexpr double kOverSupport = 0.002;                      // m at which the object is let go
constexpr double kMostDown = 1.5, kRetreat = 0.1;           // m
constexpr double kSpeed = 0.4;                              // rad/s (m/s) of the fastest joint
constexpr double kLeast = 0.6, kMost = 6, kMostOpen = 1.5;  // s
constexpr double kOpenSpeed = 0.15;  // m/s of the distance between the fingers

class PutDownSkill final : public Skill {
 public:
  PutDownSkill(SkillSettings settings, const RelationTask::Goal& goal)
      : settings_(std::move(settings)), goal_(goal) {}

  void Begin(const Scene& scene, Rng& rng) override;
  Action Act(const Scene& scene, Rng& rng) override;
  bool done() const override { return finished_; }
  std::string failure() const override { return failure_; }
  std::string phase() const override {
    static const std::array<std::string, 3> names = {"lower", "release", "retreat"};
    return names[static_cast<size_t>(phase_)];
  }

 private:
  enum class Phase { kLower, kRelease, kRetreat };

  JointPath Line(const MotionOptions& options, const Eigen::Vector3d& by) const;
  void Advance();

  SkillSettings settings_;
  const RelationTask::Goal& goal_;
  std::optional<Robot> robot_;
  std::optional<GuidedArm> arm_;
  std::shared_ptr<const GripperShape> shape_;
  std::string body_;
  Phase phase_ = Phase::kLower;
  double opening_ = 0;
  int ticks_ = 0;
  bool finished_ = false;
  std::string failure_;
};

// Returns a straight motion of the TCP, without its first point; a part of it if something is in the way.
JointPath PutDownSkill::Line(const MotionOptions& options, const Eigen::Vector3d& by) const {
  MotionPlanner planner(*robot_, options);
  const Pose tcp = robot_->tcp_in_world();
  const JointVector& now = arm_->target();
  const MotionResult line = planner.PlanLine(std::vector<double>(now.begin(), now.end()),
                                             Pose(tcp.translation() + by, tcp.quaternion()));
  JointPath path;
  for (size_t i = 1; i < line.path.size(); ++i) path.emplace_back(line.path[i]);
  return path;
}

void PutDownSkill::Begin(const Scene& scene, Rng& /*rng*/) {
  robot_ = Robot::Of(scene, settings_.robot);
  arm_.emplace(*robot_, settings_.tick);
  shape_ = GripperShape::Of(robot_->config(), settings_.sim, scene.timestep());
  body_ = ElementName(scene.model(), mjOBJ_BODY, RequireObjectOrBody(scene, goal_.stated.subject));
  finished_ = false;
  failure_.clear();
  opening_ = 0;
  ticks_ = 0;
  phase_ = Phase::kLower;
  const JointPath down = Line({.groups = {robot_->arm().name()},
                               .clearance = kOverSupport,
                               .attached = {{body_, LastLinkOf(*robot_)}}},
                              {0, 0, -kMostDown});
  arm_->Begin();
  if (!down.empty()) arm_->AddLeg(down, kSpeed, arm_->GentleSeconds(down, kLeast, kMost));
}

Action PutDownSkill::Act(const Scene& /*scene*/, Rng& /*rng*/) {
  if (!finished_) Advance();
  if (!finished_) {
    arm_->Next();
    const double range = shape_->open_gap() - shape_->closed_gap();
    const double step = range > 0 ? kOpenSpeed * settings_.tick / range : 1;
    if (phase_ != Phase::kLower) opening_ = std::min(1.0, opening_ + step);
    ++ticks_;
  }
  RobotAction action;
  action[robot_->arm().name()] =
      GroupCommand::Joints(std::vector<double>(arm_->target().begin(), arm_->target().end()));
  action[robot_->gripper().name()] = GroupCommand::Opening(opening_);
  return {{robot_->name(), std::move(action)}};
}

void PutDownSkill::Advance() {
  if (arm_->Blocked()) {
    failure_ = "the arm is blocked";
    finished_ = true;
    return;
  }
  switch (phase_) {
    case Phase::kLower:
      if (!arm_->Settled()) return;
      phase_ = Phase::kRelease;
      ticks_ = 0;
      return;
    case Phase::kRelease: {
      if (opening_ < 1) return;
      if (robot_->gripper().opening() < PickPlanner::kOpened && ticks_ < arm_->Ticks(kMostOpen))
        return;
      phase_ = Phase::kRetreat;
      const Eigen::Vector3d back =
          -Rotate(robot_->tcp_in_world().quaternion(), shape_->grasp_in_tcp().rotation().col(2));
      const JointPath out = Line({.groups = {robot_->arm().name()},
                                  .clearance = 0,
                                  .allowed_contacts = {{body_, LastLinkOf(*robot_)}}},
                                 kRetreat * back);
      arm_->Begin();
      if (!out.empty()) arm_->AddLeg(out, kSpeed, kLeast);
      return;
    }
    case Phase::kRetreat:
      if (arm_->Settled()) finished_ = true;
      return;
  }
}

}  // namespace
}  // namespace internal::put_down

std::unique_ptr<Skill> MakePutDownSkill(const SkillSettings& settings,
                                        const RelationTask::Goal& goal) {
  return std::make_unique<internal::put_down::PutDownSkill>(settings, goal);
}

}  // namespace robocell
