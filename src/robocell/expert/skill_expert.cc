#include "robocell/expert/skill_expert.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/expert/any_arm.h"
#include "robocell/expert/pick_expert.h"
#include "robocell/expert/skill_expert_kind.h"
#include "robocell/mujoco/names.h"
#include "robocell/robot/acting_arms.h"
#include "robocell/robot/robot.h"
#include "robocell/robot/unused_groups.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/scenes/relations.h"
#include "robocell/task/arm_contacts.h"
#include "robocell/task/run_arms.h"

namespace robocell {
namespace {

constexpr int kMostSkillTries = 4;       // of one goal
constexpr double kLeastProgress = 0.01;  // of a skill that has not failed
constexpr double kStaySeconds = 0.3;  // after the last skill, beside the time that the goal takes

std::shared_ptr<const RelationTask> RelationTaskOf(const RunConfig& run,
                                                   const EpisodeStart& start) {
  auto task = std::dynamic_pointer_cast<const RelationTask>(start.task);
  if (task) return task;
  throw SpecError(
      fmt::format("run '{}': this expert demonstrates tasks whose goals are relations, "
                  "such as `kind: relations`, and the task is '{}'",
                  run.run, run.task.kind()));
}

}  // namespace

const std::vector<std::string>& SkillPhases() {
  static const std::vector<std::string> phases = {
      "open",    "pregrasp", "grasp", "close",    "lift",   "transfer", "lower",
      "release", "retreat",  "reach", "approach", "follow", "press",    "push",
      "align",   "insert",   "wipe",  "carry",    "pour",   "done"};
  return phases;
}

// Phases have their numbers in episodes: more of them come after the others.
const std::vector<std::string>& TwoArmSkillPhases() {
  static const std::vector<std::string> phases = [] {
    std::vector<std::string> all = SkillPhases();
    all.insert(all.end(), {"meet", "take", "give"});
    return all;
  }();
  return phases;
}

const std::vector<std::string>& FreeSkillPhases() {
  static const std::vector<std::string> phases = {"open", "pregrasp", "transfer", "reach", "done"};
  return phases;
}

SkillExpert::SkillExpert(SkillSettings settings, std::shared_ptr<const RelationTask> task)
    : settings_(std::move(settings)), task_(std::move(task)) {}

SkillExpert::SkillExpert(const RunConfig& run, const EpisodeStart& start)
    : SkillExpert({.robot = internal::FirstArmOfRun(run),
                   .sim = run.options,
                   .tick = run.rates.policy_period(),
                   .arms = internal::ArmsOfRun(run, start.scene)},
                  RelationTaskOf(run, start)) {}

int SkillExpert::phase() const {
  const std::string name = skill_ ? skill_->phase() : "done";
  const auto at = std::ranges::find(*phases_, name);
  return static_cast<int>(at - phases_->begin());
}

std::unique_ptr<Skill> SkillExpert::SkillFor(const RelationTask::Goal& goal) const {
  const std::string& relation = goal.stated.relation;
  if (FindRelation(relation).subject == RelationSubject::kJoint)
    return MakeJointSkill(settings_, goal);
  if (relation == "inserted") return MakeInsertSkill(settings_, goal);
  if (relation == "wiped") return MakeWipeSkill(settings_, goal);
  if (relation == "poured_into") return MakePourSkill(settings_, goal);
  if (relation == "handed_over") return MakeHandoverSkill(settings_, goal);
  if (relation == "carried") return MakeCarrySkill(settings_, goal);
  if (relation == "held") return MakeHoldSkill(settings_, goal);
  if (relation == "in_region" && task_->pushes()) return MakePushSkill(settings_, goal);
  return MakePlaceSkill(settings_, goal);
}

void SkillExpert::Begin(const Scene& scene, Rng& rng) {
  const bool is_for_two = std::ranges::any_of(task_->goals(), [](const auto& goal) {
    return goal.stated.relation == "handed_over" || goal.stated.relation == "carried";
  });
  phases_ = is_for_two ? &TwoArmSkillPhases() : &SkillPhases();
  tries_.assign(task_->goals().size(), 0);
  failures_.assign(task_->goals().size(), 0);
  put_down_.assign(task_->goals().size(), 0);
  puts_down_ = false;
  waited_ = 0;
  finished_ = false;
  setback_.clear();
  failure_.clear();
  last_.clear();
  Next(scene, rng);
}

// Begins the skill of the first goal that does not hold; ends without one.
void SkillExpert::Next(const Scene& scene, Rng& rng) {
  scene.SyncPoses();
  for (;;) {
    skill_.reset();
    const std::vector<RelationTask::Goal>& goals = task_->goals();
    const auto open = std::ranges::find_if(goals, [](const auto& goal) { return !goal.Holds(); });
    if (open == goals.end()) return;
    goal_ = static_cast<size_t>(open - goals.begin());
    if (tries_[goal_] >= kMostSkillTries) {
      failure_ = setback_.empty() ? "the goal was not reached" : setback_;
      finished_ = true;
      return;
    }
    waited_ = 0;
    settings_.failures = failures_[goal_];
    if (PutsDown(scene, *open)) return skill_->Begin(scene, rng);
    ++tries_[goal_];
    ChooseArm(scene, *open);
    progress_ = open->bound->Progress();
    skill_ = SkillFor(*open);
    skill_->Begin(scene, rng);
    if (!skill_->done()) return;
    Finish();
  }
}

// The nearest arm begins; after a failure the next one has its turn.
void SkillExpert::ChooseArm(const Scene& scene, const RelationTask::Goal& goal) {
  if (settings_.arms.size() < 2) return;
  const bool is_joint = FindRelation(goal.stated.relation).subject == RelationSubject::kJoint;
  const std::vector<std::string> arms =
      is_joint ? settings_.arms : internal::NearestArms(scene, settings_.arms, goal.stated.subject);
  settings_.robot = arms[static_cast<size_t>(settings_.failures) % arms.size()];
}

// After a failure one of several arms may have the object in its hand. Returns true, with the skill for
// it, if it sets the object down before the next try; once after each failure.
bool SkillExpert::PutsDown(const Scene& scene, const RelationTask::Goal& goal) {
  if (settings_.arms.size() < 2 || settings_.failures <= put_down_[goal_]) return false;
  if (goal.stated.relation == "held" ||
      FindRelation(goal.stated.relation).subject == RelationSubject::kJoint)
    return false;
  const internal::ArmContacts contacts(
      scene, ElementName(scene.model(), mjOBJ_BODY,
                         internal::RequireObjectOrBody(scene, goal.stated.subject)));
  const int holder = contacts.Look().only_holder();
  if (holder < 0) return false;
  const std::string& arm = contacts.arms()[static_cast<size_t>(holder)];
  if (std::ranges::find(settings_.arms, arm) == settings_.arms.end()) return false;
  put_down_[goal_] = settings_.failures;
  settings_.robot = arm;
  skill_ = MakePutDownSkill(settings_, goal);
  puts_down_ = true;
  return true;
}

// A skill that did a part of its goal has not failed: what it did is worth doing again.
void SkillExpert::Finish() {
  if (std::exchange(puts_down_, false)) return skill_.reset();
  setback_ = skill_->failure();
  const RelationTask::Goal& goal = task_->goals()[goal_];
  const bool helped = goal.Holds() || goal.bound->Progress() > progress_ + kLeastProgress;
  if (!setback_.empty() || !helped) ++failures_[goal_];
  skill_.reset();
}

Action SkillExpert::Act(const Scene& scene, Rng& rng) {
  if (finished_) return last_;
  if (!skill_) {
    const int wait =
        static_cast<int>(std::ceil((kStaySeconds + task_->hold_seconds()) / settings_.tick));
    if (waited_ == 0 || waited_ >= wait) Next(scene, rng);  // has it stayed so?
    if (!skill_ && !finished_ && ++waited_ > wait) finished_ = true;
    if (!skill_) return last_;
  }
  last_ = skill_->Act(scene, rng);
  if (skill_->done()) Finish();
  return last_;
}

namespace internal {
namespace {

class KindOfSkillExpert final : public ExpertKind {
 public:
  std::shared_ptr<Expert> Make(const RunConfig& run, const EpisodeStart& start) const override {
    return std::make_shared<SkillExpert>(run, start);
  }
  bool is_built_in() const override { return true; }
  void Validate(const RunConfig& run, const Scene& scene, Robot& robot, Problems& problems,
                Problems& doubts) const override {
    const std::string unused =
        ArmNames(robot.config()).size() > 1 ? "" : DescribeUnusedGroups(robot);
    if (!unused.empty())
      doubts.AddAt("robot", "has several grippers, and this expert acts with one: " + unused);
    const Problems::Scope scope(problems, "robot");
    for (const std::string& arm : ArmsOfRun(run, scene)) {
      if (!ValidatePickRobot(Robot::Of(scene, arm), run.options, scene.timestep(), problems))
        return;
    }
  }
  void ValidateRobot(const Robot& robot, Problems& problems) const override {
    ValidatePickRobot(robot, robot.scene().compiled()->spec().options, robot.scene().timestep(),
                      problems);
  }
};

}  // namespace

std::shared_ptr<const ExpertKind> MakeSkillExpertKind() {
  return std::make_shared<KindOfSkillExpert>();
}

}  // namespace internal
}  // namespace robocell
