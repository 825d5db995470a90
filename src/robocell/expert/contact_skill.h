// ContactSkill: executes a contact motion (task/contact_motion.h): reach, approach, grip (if it
// grips), follow the path, let go, retreat. The reach is planned by the MotionPlanner where the
// straight way is not free.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/expert/guided_arm.h"
#include "robocell/expert/skill.h"
#include "robocell/motion/gripper_shape.h"
#include "robocell/robot/robot.h"
#include "robocell/task/contact_motion.h"

namespace robocell {

struct ContactSkillPlan {
  // Returns the source of the paths from the present state. The shape outlives it.
  std::function<ContactPathSource(const Robot&, const GripperShape&)> paths;
  std::string target_body;       // which the hand may touch
  std::string follow_phase;      // "follow", "press", "push"
  std::string without_paths;     // the failure if there is none: "no grasp of the handle"
  bool grips = false;            // closes the fingers at the contact, if the path is one that grips
  double least_share = 1;        // of the path that has to be possible
  double seconds_per_metre = 8;  // of the TCP on the path, at least
  // Ends the path before its end.
  std::function<bool()> reached = {};
};

class ContactSkill final : public Skill {
 public:
  ContactSkill(SkillSettings settings, ContactSkillPlan plan);

  void Begin(const Scene& scene, Rng& rng) override;
  Action Act(const Scene& scene, Rng& rng) override;
  bool done() const override { return finished_; }
  std::string failure() const override { return failure_; }
  std::string phase() const override;

 private:
  enum class Phase { kReach, kApproach, kClose, kFollow, kRelease, kRetreat };

  void Plan(const Scene& scene, Rng& rng);
  std::optional<JointPath> FindReach(PlanningScene& planning, const JointVector& goal, double gap,
                                     Rng& rng) const;
  void Enter(Phase phase);
  void Advance();
  void BreakOff();
  void LeaveClose();
  void GiveUp(const std::string& why);
  double OpeningFor(double gap) const;
  bool HandIsEmpty() const;
  bool Grips() const { return plan_.grips && grips_; }
  double PathSeconds() const;
  JointPath Along(size_t begin, size_t end) const;

  SkillSettings settings_;
  ContactSkillPlan plan_;
  std::optional<Robot> robot_;
  std::shared_ptr<const GripperShape> shape_;
  std::optional<GuidedArm> arm_;
  std::optional<ContactMotion> motion_;
  JointPath reach_;
  bool grips_ = true;     // the path does
  size_t closed_at_ = 0;  // point of the path at which the fingers have closed
  double free_opening_ = 1, contact_opening_ = 1, opening_ = 1, opening_step_ = 1;
  double length_ = 0, after_ = 0;  // of the TCP's path, and of the way out, m
  Eigen::Vector3d away_in_tcp_ = Eigen::Vector3d::UnitZ();
  Phase phase_ = Phase::kReach;
  int ticks_ = 0, squeezed_ = 0;
  double last_gap_ = 0;
  bool finished_ = false;
  std::string setback_, failure_;
};

}  // namespace robocell
