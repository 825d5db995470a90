// The skill that pours: it carries a vessel upright over another one, tilts it slowly, waits until
// nothing more comes, and puts it back.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "robocell/expert/held_object_skill.h"
#include "robocell/expert/skill.h"
#include "robocell/math/rotation.h"

namespace robocell {
namespace {

constexpr double kUprightSpeed = 0.16;  // m/s
constexpr double kTiltSpeed = 0.9;      // rad/s
constexpr double kPourSeconds = 1.2;    // with the vessel tilted, while grains may still come

class PourSkill final : public internal::HeldObjectSkill {
 public:
  using internal::HeldObjectSkill::HeldObjectSkill;

 private:
  std::string path_phase() const override {
    const bool is_tilted =
        AngleBetween(walk_->place().quaternion(), path().front().quaternion()) > 0.1;
    return is_tilted ? "pour" : "carry";
  }
  bool returns() const override { return true; }

  void BeginPath(const Scene& /*scene*/) override {
    walk_.emplace(path(), kUprightSpeed, kTiltSpeed);
    waited_ = 0;
  }

  std::optional<Guidance> Guide(const Scene& scene) override {
    scene.SyncPoses();
    if (goal().bound->Progress() >= 1) return std::nullopt;  // every grain is in the other vessel
    if (walk_->at_end()) {
      waited_ += settings().tick;
      if (waited_ >= kPourSeconds) return std::nullopt;
      return Guidance{path().back()};
    }
    walk_->Move(settings().tick);
    return Guidance{.object_in_world = walk_->place(), .free_along = {}, .at = walk_->at()};
  }

  std::optional<internal::PathWalk> walk_;
  double waited_ = 0;
};

}  // namespace

std::unique_ptr<Skill> MakePourSkill(const SkillSettings& settings,
                                     const RelationTask::Goal& goal) {
  return std::make_unique<PourSkill>(settings, goal);
}

}  // namespace robocell
