// The skill that wipes a region with an object: it lowers the object until it presses, and follows the
// lanes of the path. The height follows the force, so that the object keeps touching.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "robocell/expert/held_object_skill.h"
#include "robocell/expert/skill.h"
#include "robocell/math/rotation.h"
#include "robocell/scene/body_handle.h"
#include "robocell/task/held.h"
#include "robocell/task/wiping.h"

namespace robocell {
namespace {

constexpr double kWipeSpeed = 0.06;                   // m/s
constexpr double kTurnSpeed = 0.5;                    // rad/s
constexpr double kDownSpeed = 0.02;                   // m/s
constexpr double kWantedForce = 3, kForceBand = 1.5;  // N
constexpr double kForceStep = 3e-4;  // m a tick, by which the height follows the force
constexpr double kDeepest = 0.03;    // m below the region that the target may be
constexpr double kMostLowering = 4;  // seconds
constexpr int kMostRounds = 2;       // of the path
constexpr double kBehind = 0.008;    // m from which on the path waits for the object ...
constexpr double kLeastShare = 0.2;  // ... and the least share of the speed

class WipeSkill final : public internal::HeldObjectSkill {
 public:
  using internal::HeldObjectSkill::HeldObjectSkill;

 private:
  std::string path_phase() const override { return "wipe"; }

  void BeginPath(const Scene& scene) override {
    sponge_.emplace(scene, scene.compiled()->object(goal().stated.subject).root_body);
    walk_.emplace(path(), kWipeSpeed, kTurnSpeed);
    lowering_ = 0;
    rounds_ = 0;
    down_ = 0;
    presses_ = false;
  }

  std::optional<Guidance> Guide(const Scene& scene) override {
    const double tick = settings().tick;
    if (goal().Holds() && presses_) return std::nullopt;
    const double force = internal::ForceOnOthers(scene, sponge_->id());
    const Eigen::Vector3d up = path().front().rotation().col(2);
    if (!presses_) {
      lowering_ += tick;
      presses_ = force > kWantedForce - kForceBand;
      if (lowering_ > kMostLowering) {
        BreakOff("the object does not reach the region");
        return std::nullopt;
      }
    }
    if (force < kWantedForce - kForceBand)
      down_ += presses_ ? kForceStep : kDownSpeed * tick;
    else if (force > kWantedForce + kForceBand)
      down_ -= 2 * kForceStep;
    down_ = std::clamp(down_, -internal::kOverWiped, kDeepest);
    if (presses_) Walk(tick, up);
    if (walk_->at_end()) {
      if (++rounds_ >= kMostRounds) {
        BreakOff("the region was not wiped");
        return std::nullopt;
      }
      walk_->Restart();
    }
    return Guidance{
        .object_in_world = Pose(-down_ * up) * walk_->place(), .free_along = up, .at = walk_->at()};
  }

  // Moves on along the path, more slowly the farther the object is behind.
  void Walk(double tick, const Eigen::Vector3d& up) {
    Eigen::Vector3d behind = walk_->place().translation() - ObjectInWorld().translation();
    behind -= behind.dot(up) * up;
    walk_->Move(tick * std::clamp(2 - behind.norm() / kBehind, kLeastShare, 1.0));
  }

  std::optional<BodyHandle> sponge_;
  std::optional<internal::PathWalk> walk_;
  double lowering_ = 0, down_ = 0;
  int rounds_ = 0;
  bool presses_ = false;
};

}  // namespace

std::unique_ptr<Skill> MakeWipeSkill(const SkillSettings& settings,
                                     const RelationTask::Goal& goal) {
  return std::make_unique<WipeSkill>(settings, goal);
}

}  // namespace robocell
