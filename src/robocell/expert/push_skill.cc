// The skill that pushes an object into a region.
#include <mujoco/mujoco.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "robocell/expert/contact_skill.h"
#include "robocell/expert/skill.h"
#include "robocell/mujoco/names.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/task/push_motion.h"

namespace robocell {
namespace {

constexpr double kPushSecondsPerMetre = 15;
constexpr double kStopBefore = 0.004;  // m: the object slides on, and the arm lags

class PushSkill final : public Skill {
 public:
  PushSkill(SkillSettings settings, StatedRelation stated,
            std::shared_ptr<const BoundRelation> bound)
      : settings_(std::move(settings)), stated_(std::move(stated)), bound_(std::move(bound)) {}

  void Begin(const Scene& scene, Rng& rng) override {
    scene.SyncPoses();
    // The middle of the region, if that is free.
    const std::vector<Pose> poses = bound_->Sample(rng, 1).poses;
    const BodyHandle object(scene.inner(),
                            ElementName(scene.model(), mjOBJ_BODY,
                                        internal::RequireObjectOrBody(scene, stated_.subject)));
    const auto middle = [object, scene = scene.inner()]() -> Eigen::Vector2d {
      scene.SyncPoses();
      return Eigen::Vector3d(scene.data()->subtree_com + 3 * object.id()).head<2>();
    };
    // Without a free place there is no path either.
    const Eigen::Vector2d place =
        poses.empty() ? middle() : Eigen::Vector2d(poses.front().translation().head<2>());
    const Eigen::Vector2d along = (place - middle()).normalized();
    skill_ = std::make_unique<ContactSkill>(
        settings_, ContactSkillPlan{
                       .paths =
                           [this, place](const Robot& robot, const GripperShape& shape) {
                             return SourceOf(
                                 internal::PushPaths(robot.scene(), stated_.subject, place, shape));
                           },
                       .target_body = object.name(),
                       .follow_phase = "push",
                       .without_paths = internal::kNoPush,
                       .seconds_per_metre = kPushSecondsPerMetre,
                       .reached = [middle, place,
                                   along] { return (place - middle()).dot(along) < kStopBefore; }});
    skill_->Begin(scene, rng);
  }
  Action Act(const Scene& scene, Rng& rng) override { return skill_->Act(scene, rng); }
  bool done() const override { return skill_->done(); }
  std::string failure() const override { return skill_->failure(); }
  std::string phase() const override { return skill_->phase(); }

 private:
  SkillSettings settings_;
  StatedRelation stated_;
  std::shared_ptr<const BoundRelation> bound_;
  std::unique_ptr<ContactSkill> skill_;
};

}  // namespace

std::unique_ptr<Skill> MakePushSkill(const SkillSettings& settings,
                                     const RelationTask::Goal& goal) {
  return std::make_unique<PushSkill>(settings, goal.stated, goal.bound);
}

}  // namespace robocell
