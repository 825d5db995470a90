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

constexpr double kAligned = 3e-4, kUpright = 0.012;  // m and rad over the hole
constexpr double kLeastAlign = 0.4, kMostAlign = 2;  // seconds
constexpr double kNear = 0.002;                      // m over the rim, where it is aligned again
constexpr double kToHoleSpeed = 0.04, kSlowSpeed = 0.015;  // m/s to there, and from there
constexpr double kPress = 0.003;                           // m that the target is below the object
constexpr double kStuckSeconds = 0.4;                      // without progress: the spiral begins
constexpr double kDeeper = 5e-4;                           // m that count as progress
constexpr double kSpiralSpeed = 4e-4, kSpiralTurns = 0.7;  // m and turns a second
constexpr double kMostSearch = 4, kMostLower = 15;         // seconds
constexpr double kEnough = 0.97;  // share of the depth at which the object is let go
constexpr int kMostInsertions = 4;

class InsertSkill final : public internal::HeldObjectSkill {
 public:
  using internal::HeldObjectSkill::HeldObjectSkill;

 private:
  enum class Stage { kOver, kNear, kDown };

  std::string path_phase() const override { return stage_ == Stage::kDown ? "insert" : "align"; }

  void BeginPath(const Scene& scene) override {
    insertion_.emplace(scene, goal().stated.subject, goal().stated.reference);
    tries_ = 1;
    Enter(Stage::kOver);
  }

  void Enter(Stage stage) {
    stage_ = stage;
    seconds_ = search_ = stuck_ = 0;
  }

  std::optional<Guidance> Guide(const Scene& scene) override {
    scene.SyncPoses();
    const double tick = settings().tick;
    const Eigen::Vector3d out = insertion_->mouth().rotation().col(2);
    const Pose& bottom = path().back();
    const Pose now = ObjectInWorld();
    const Eigen::Vector3d off = now.translation() - bottom.translation();
    const double height = off.dot(out);  // over the bottom
    const double top = (path().front().translation() - bottom.translation()).dot(out);
    const double near = top - internal::kOverHole + kNear;
    seconds_ += tick;
    if (stage_ != Stage::kDown) {
      const double wanted = stage_ == Stage::kOver ? top : near;
      height_ = stage_ == Stage::kOver ? top : std::max(near, height_ - kToHoleSpeed * tick);
      const bool is_aligned = (off - height * out).norm() < kAligned &&
                              AngleBetween(now.quaternion(), bottom.quaternion()) < kUpright &&
                              height < wanted + kNear / 2;
      if ((is_aligned && seconds_ >= kLeastAlign) || seconds_ >= kMostAlign) {
        if (stage_ == Stage::kNear) lowest_ = height;
        Enter(stage_ == Stage::kOver ? Stage::kNear : Stage::kDown);
      }
      return Guidance{Pose(height_ * out) * bottom};
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
      if (++tries_ > kMostInsertions) {
        BreakOff("the object does not go into the hole");
        return std::nullopt;
      }
      TakeHold();
      Enter(Stage::kOver);
      return Guidance{Pose(height * out) * bottom};
    }
    height_ = std::max({height_ - kSlowSpeed * tick, height - kPress, -kPress});
    const double angle = 2 * internal::kPi * kSpiralTurns * search_;
    const Eigen::Matrix3d across = insertion_->mouth().rotation();
    const Eigen::Vector3d spiral =
        kSpiralSpeed * search_ *
        (std::cos(angle) * across.col(0) + std::sin(angle) * across.col(1));
    return Guidance{.object_in_world = Pose(height_ * out + spiral) * bottom, .free_along = out};
  }

  std::optional<internal::Insertion> insertion_;
  Stage stage_ = Stage::kOver;
  int tries_ = 0;
  double seconds_ = 0, height_ = 0, lowest_ = 0, stuck_ = 0, search_ = 0;
};

}  // namespace

std::unique_ptr<Skill> MakeInsertSkill(const SkillSettings& settings,
                                       const RelationTask::Goal& goal) {
  return std::make_unique<InsertSkill>(settings, goal);
}

}  // namespace robocell
