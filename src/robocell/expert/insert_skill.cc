// The skill that puts an object into a hole. Over the hole it aligns the object, then it lowers it. The
// force on a rim or a bottom stays small, because the target of the arm is never far below the object;
// what does not go in is moved along a spiral, and raised and tried again.
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "robocell/base/units.h"
#include "robocell/expert/held_object_skill.h"
#include "robocell/expert/skill.h"
#include "robocell/math/rotation.h"
#include "robocell/scenes/insertion.h"

namespace robocell {
namespace {

constexpr double kAligned = 4e-4, kUpright = 0.01;        // m and rad over the hole
constexpr double kLeastAlign = 0.5, kMostAlign = 2.5;      // seconds
constexpr double kLowerSpeed = 0.03;                       // m/s
constexpr double kPress = 0.006;                           // m that the target is below the object
constexpr double kStuckSeconds = 0.4;                      // without progress: the spiral begins
constexpr double kDeeper = 5e-4;                         // m that count as progress
constexpr double kSpiralSpeed = 4e-4, kSpiralTurns = 1.2;  // m and turns a second
constexpr double kMostSearch = 5, kMostLower = 15;         // seconds
constexpr double kEnough = 0.97;  // share of the depth at which the object is let go
constexpr int kMostInsertions = 3;

class InsertSkill final : public internal::HeldObjectSkill {
 public:
  using internal::HeldObjectSkill::HeldObjectSkill;

 private:
  std::string path_phase() const override { return is_aligned_ ? "insert" : "align"; }

  void BeginPath(const Scene& scene) override {
    insertion_.emplace(scene, goal().stated.subject, goal().stated.reference);
    tries_ = 0;
    Align();
  }

  void Align() {
    ++tries_;
    is_aligned_ = false;
    seconds_ = 0;
  }

  std::optional<Guidance> Guide(const Scene& scene) override {
    scene.SyncPoses();
    const double tick = settings().tick;
    const Eigen::Vector3d out = insertion_->mouth().rotation().col(2);
    const Pose& bottom = path().back();
    const Pose now = ObjectInWorld();
    const Eigen::Vector3d off = now.translation() - bottom.translation();
    const double height = off.dot(out);
    seconds_ += tick;
    if (!is_aligned_) {
      const double top = (path().front().translation() - bottom.translation()).dot(out);
      const double aside = (off - height * out).norm();
      const bool is_straight =
          AngleBetween(now.quaternion(), bottom.quaternion()) < kUpright && aside < kAligned;
      if ((is_straight && seconds_ >= kLeastAlign) || seconds_ >= kMostAlign) {
        is_aligned_ = true;
        height_ = lowest_ = height;
        seconds_ = search_ = stuck_ = 0;
      }
      return Guidance{Pose(top * out) * bottom};
    }
    if (height < lowest_ - kDeeper) {
      lowest_ = height;
      stuck_ = 0;
      search_ = std::max(0.0, search_ - 2 * tick);
    } else {
      stuck_ += tick;
    }
    const bool is_deep = insertion_->Depth() >= kEnough * insertion_->full_depth() - kDeeper;
    if (is_deep || (goal().Holds() && stuck_ > kStuckSeconds)) return std::nullopt;
    if (stuck_ > kStuckSeconds) search_ += tick;
    if (search_ > kMostSearch || seconds_ > kMostLower) {
      if (tries_ >= kMostInsertions) {
        BreakOff("the object does not go into the hole");
        return std::nullopt;
      }
      Align();
      return Guidance{Pose(height * out) * bottom};
    }
    height_ = std::max({height_ - kLowerSpeed * tick, height - kPress, -kPress});
    const double angle = 2 * internal::kPi * kSpiralTurns * search_;
    const Pose mouth = insertion_->mouth();
    const Eigen::Vector3d spiral =
        kSpiralSpeed * search_ *
        (std::cos(angle) * mouth.rotation().col(0) + std::sin(angle) * mouth.rotation().col(1));
    return Guidance{.object_in_world = Pose(height_ * out + spiral) * bottom, .free_along = out};
  }

  std::optional<internal::Insertion> insertion_;
  bool is_aligned_ = false;
  int tries_ = 0;
  double seconds_ = 0, height_ = 0, lowest_ = 0, stuck_ = 0, search_ = 0;
};

}  // namespace

std::unique_ptr<Skill> MakeInsertSkill(const SkillSettings& settings,
                                       const RelationTask::Goal& goal) {
  return std::make_unique<InsertSkill>(settings, goal);
}

}  // namespace robocell
