#include "robocell/task/two_arm_relations.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/mujoco/names.h"
#include "robocell/scenes/landmarks.h"
#include "robocell/task/arm_contacts.h"

namespace robocell::internal {
namespace {

ArmContacts ContactsOf(const Scene& scene, const StatedRelation& stated) {
  ArmContacts contacts(
      scene, ElementName(scene.model(), mjOBJ_BODY, RequireObjectOrBody(scene, stated.subject)));
  if (contacts.arms().size() >= 2) return contacts;
  throw ArgumentError(
      fmt::format("'{}' needs two arms with grippers, and scene '{}' has {}. Use a robot with two "
                  "arms, such as "
                  "examples/duo/duo.yaml",
                  stated.relation, scene.name(),
                  contacts.arms().empty() ? "none" : "one, " + ListNames(contacts.arms())));
}

class HandedOver final : public BoundRelation {
 public:
  HandedOver(const Scene& scene, const StatedRelation& stated)
      : contacts_(ContactsOf(scene, stated)), had_(contacts_.arms().size(), 0) {}

  bool Holds() const override {
    const int holder = contacts_.Look().only_holder();
    if (holder < 0) return false;
    for (size_t i = 0; i < had_.size(); ++i)
      if (static_cast<int>(i) != holder && had_[i] != 0) return true;
    return false;
  }

  double Progress() const override {
    if (Holds()) return 1;
    const ArmContacts::Seen seen = contacts_.Look();
    const bool was_held = std::ranges::find(had_, 1.0) != had_.end();
    return (was_held ? 0.5 : 0) + 0.15 * std::min(2, seen.grasping());
  }

  RelationSamples Sample(Rng& /*rng*/, int /*count*/) const override { return {}; }

  void Watch() override {
    const ArmContacts::Seen seen = contacts_.Look();
    if (seen.other) std::ranges::fill(had_, 0);
    if (const int holder = seen.only_holder(); holder >= 0) had_[static_cast<size_t>(holder)] = 1;
  }

  std::vector<double> memory() const override { return had_; }
  void Recall(std::span<const double> memory) override {
    had_.assign(memory.begin(), memory.end());
  }

 private:
  ArmContacts contacts_;
  std::vector<double> had_;  // 1 for each arm that has held it alone since it was picked up
};

class Carried final : public BoundRelation {
 public:
  Carried(const Scene& scene, const StatedRelation& stated)
      : contacts_(ContactsOf(scene, stated)),
        scene_(scene.inner()),
        in_region_(BindRelation(scene, {stated.subject, "in_region", stated.reference})),
        most_tilt_(stated.numbers[0]) {}

  bool Holds() const override {
    return carried_ && !spoilt_ && contacts_.Look().other && in_region_->Holds();
  }

  double Progress() const override {
    if (Holds()) return 1;
    return spoilt_ ? 0 : (carried_ ? 0.4 : 0) + 0.4 * in_region_->Progress();
  }

  RelationSamples Sample(Rng& rng, int count) const override {
    return in_region_->Sample(rng, count);
  }

  // In the air two arms at least hold it, and it stays level.
  void Watch() override {
    const ArmContacts::Seen seen = contacts_.Look();
    if (seen.other) return;
    if (seen.grasping() >= 2)
      carried_ = true;
    else
      spoilt_ = spoilt_ || carried_ || seen.touching() > 0;
    const double up = scene_.body_pose(contacts_.body().name()).rotation().col(2).z();
    if (std::acos(std::clamp(up, -1.0, 1.0)) > most_tilt_) spoilt_ = true;
  }

  std::vector<double> memory() const override {
    return {carried_ ? 1.0 : 0.0, spoilt_ ? 1.0 : 0.0};
  }
  void Recall(std::span<const double> memory) override {
    carried_ = memory[0] != 0;
    spoilt_ = memory[1] != 0;
  }

 private:
  ArmContacts contacts_;
  Scene scene_;
  std::unique_ptr<BoundRelation> in_region_;
  double most_tilt_;
  bool carried_ = false;  // two arms have held it in the air
  bool spoilt_ = false;   // it was tilted, or in the air with fewer arms
};

}  // namespace

RelationKind HandedOverRelation() {
  return {.words = "hand the {0} over from one arm to the other",
          .bind = [](const Scene& scene, const StatedRelation& stated) {
            return std::make_unique<HandedOver>(scene, stated);
          }};
}

RelationKind CarriedRelation() {
  return {.reference = RelationReference::kRequired,
          .defaults = {0.3},
          .numbers_text = "the largest tilt in radians",
          .comparison = "<=",
          .words = "carry the {0} with both arms to the {1}",
          .bind = [](const Scene& scene, const StatedRelation& stated) {
            return std::make_unique<Carried>(scene, stated);
          }};
}

}  // namespace robocell::internal
