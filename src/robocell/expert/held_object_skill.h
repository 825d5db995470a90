// HeldObjectSkill: picks an object up, moves it along a path that it plans with the object in the
// hand (task/held_motion.h), lets it go and retreats. On the path it watches where the object is: what
// the arm's servos give way and what the object moved in the hand is corrected each tick.
//
// Skills derive from it and say where the object is to be next.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/expert/guided_arm.h"
#include "robocell/expert/pick_planner.h"
#include "robocell/expert/skill.h"
#include "robocell/robot/robot.h"
#include "robocell/task/held_motion.h"
#include "robocell/task/held_paths.h"

namespace robocell::internal {

// A place on a path, which moves on at a speed.
class PathWalk {
 public:
  // m/s and rad/s; `path` outlives the walk.
  PathWalk(const HeldPath& path, double speed, double turn_speed)
      : path_(&path), speed_(speed), turn_speed_(turn_speed) {}
  void Move(double seconds);
  Pose place() const;
  bool at_end() const { return at_ >= static_cast<double>(path_->size() - 1); }
  void Restart() { at_ = 0; }
  // Returns the place as an index into the path and the share of the way to the next pose.
  double at() const { return at_; }

 private:
  const HeldPath* path_;
  double speed_, turn_speed_;
  double at_ = 0;  // an index, and the share of the way to the next pose
};

// Returns the way back to the start of a path from a place on it (PathWalk::at); unset: from its end.
HeldPath BackAlong(const HeldPath& path, std::optional<double> at);

class HeldObjectSkill : public Skill {
 public:
  HeldObjectSkill(SkillSettings settings, const RelationTask::Goal& goal);
  ~HeldObjectSkill() override;

  void Begin(const Scene& scene, Rng& rng) override;
  Action Act(const Scene& scene, Rng& rng) override;
  bool done() const override { return finished_; }
  std::string failure() const override { return failure_; }
  std::string phase() const override;

 protected:
  // Where the object is to be.
  struct Guidance {
    Pose object_in_world;
    // Directions, unit vectors, along which it is not corrected: it is in contact there.
    std::optional<Eigen::Vector3d> free_along = {};
    // The place on the path (PathWalk::at), if it is near one: the arm keeps to the planned posture.
    std::optional<double> at = {};
  };
  // Called with the object at the start of the path, and each time it has been picked up again.
  virtual void BeginPath(const Scene& scene) = 0;
  // Returns the guidance of the next tick; unset when the object has been moved. Called once a tick.
  virtual std::optional<Guidance> Guide(const Scene& scene) = 0;
  // The name of the phase of the path.
  virtual std::string path_phase() const = 0;
  // Returns true if the object is put back to where it was picked up.
  virtual bool returns() const { return false; }

  const HeldPath& path() const { return path_; }
  const SkillSettings& settings() const { return settings_; }
  const RelationTask::Goal& goal() const { return goal_; }
  const Robot& robot() const { return *robot_; }
  Pose ObjectInWorld() const;
  // Measures again how the hand holds the object, after it moved in the hand.
  void TakeHold();
  // Ends the path with a failure: the object is let go where it is.
  void BreakOff(const std::string& why) { setback_ = why; }

 private:
  enum class Phase { kPick, kTransfer, kGuide, kReturn, kRelease, kRetreat };

  void PickAgain(const Scene& scene, Rng& rng);
  std::string Plan(const Scene& scene, Rng& rng);
  std::optional<JointPath> FindTransfer(const JointVector& goal, Rng& rng);
  void Enter(Phase phase);
  void Advance(const Scene& scene, Rng& rng);
  void Follow(const Guidance& guidance);
  void GiveUp(const std::string& why);
  Action Command() const;

  SkillSettings settings_;
  const RelationTask::Goal& goal_;
  std::string object_body_;
  PickPlanner pick_;
  std::optional<Robot> robot_;
  std::optional<GuidedArm> arm_;
  JointPath transfer_, along_, retreat_;
  HeldPath path_, back_;
  Pose at_rest_, object_in_tcp_;
  std::optional<Guidance> last_;  // guidance of the last tick
  Eigen::Vector3d shift_ = Eigen::Vector3d::Zero(), turn_ = Eigen::Vector3d::Zero();  // corrections
  double opening_ = 0, opening_step_ = 1;
  std::optional<PathWalk> walk_;  // along back_
  Phase phase_ = Phase::kPick;
  int ticks_ = 0, picks_ = 0;
  bool finished_ = false;
  std::string setback_, failure_;
};

}  // namespace robocell::internal
