// Skills for joints of the surroundings: open and close by the handle, press.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "robocell/expert/contact_skill.h"
#include "robocell/expert/skill.h"
#include "robocell/mujoco/names.h"
#include "robocell/scenes/joint_opening.h"
#include "robocell/task/handle_motion.h"

namespace robocell {
namespace {

constexpr double kGripSecondsPerMetre = 10;  // a door and the hand on it have mass
constexpr double kPressSecondsPerMetre = 25;

// Knows the moved body once it sees the scene.
class JointSkill final : public Skill {
 public:
  JointSkill(SkillSettings settings, StatedRelation stated)
      : settings_(std::move(settings)), stated_(std::move(stated)) {}

  void Begin(const Scene& scene, Rng& rng) override {
    const JointOpening opening = JointOpening::Of(scene, stated_.subject);
    const bool presses = stated_.relation == "pressed";
    skill_ = std::make_unique<ContactSkill>(
        settings_,
        ContactSkillPlan{
            .paths =
                [this](const Robot& robot, const GripperShape& shape) {
                  return internal::JointPaths(robot, stated_, shape, settings_.failures);
                },
            .target_body = ElementName(scene.model(), mjOBJ_BODY, opening.body_id()),
            .follow_phase = presses ? "press" : "follow",
            .without_paths = internal::WhyNoJointPaths(stated_),
            .grips = !presses,
            .least_share = presses ? 1 : internal::kLeastFollowed,
            .seconds_per_metre = presses ? kPressSecondsPerMetre : kGripSecondsPerMetre});
    skill_->Begin(scene, rng);
  }
  Action Act(const Scene& scene, Rng& rng) override { return skill_->Act(scene, rng); }
  bool done() const override { return skill_->done(); }
  std::string failure() const override { return skill_->failure(); }
  std::string phase() const override { return skill_->phase(); }

 private:
  SkillSettings settings_;
  StatedRelation stated_;
  std::unique_ptr<ContactSkill> skill_;
};

}  // namespace

std::unique_ptr<Skill> MakeJointSkill(const SkillSettings& settings,
                                      const RelationTask::Goal& goal) {
  return std::make_unique<JointSkill>(settings, goal.stated);
}

}  // namespace robocell
