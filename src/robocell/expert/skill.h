// Skills: what the expert of relation tasks does for one relation: pick an object up, put it
// somewhere, move a joint by its handle, press, push (skill_expert.h). A skill plans from the present
// state, acts once per policy tick, and ends done or failed.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/robot/action.h"
#include "robocell/scene/scene.h"
#include "robocell/spec/sim_options.h"
#include "robocell/task/relation_task.h"

namespace robocell {

class Skill {
 public:
  virtual ~Skill() = default;
  virtual void Begin(const Scene& scene, Rng& rng) = 0;
  virtual Action Act(const Scene& scene, Rng& rng) = 0;
  virtual bool done() const = 0;
  // Returns why it gave up, "" otherwise; one of few texts.
  virtual std::string failure() const = 0;
  // Returns the name of the present phase, one of SkillPhases().
  virtual std::string phase() const = 0;
};

// Returns the phases of all skills, in the order of their numbers in episodes.
const std::vector<std::string>& SkillPhases();
// Returns those in which the hand moves through free space, to where it goes on. Nothing that is held
// is guided in them: a vessel that is carried upright ("carry") is.
const std::vector<std::string>& FreeSkillPhases();

// Returns the phases of skills for two arms: those of all skills, and some more.
const std::vector<std::string>& TwoArmSkillPhases();

// What skills need of a run.
struct SkillSettings {
  std::string robot;  // its name, or that of its arm that acts (Robot::Of)
  SimOptions sim;
  double tick = 0.066;                 // seconds between actions
  int failures = 0;                    // how often skills for this goal have failed
  std::vector<std::string> arms = {};  // all that may act, by names for Robot::Of; empty: `robot`
};

// The skills of one file each. `goal` outlives the skill.
std::unique_ptr<Skill> MakePlaceSkill(const SkillSettings& settings,
                                      const RelationTask::Goal& goal);  // place_skill.cc
std::unique_ptr<Skill> MakeHoldSkill(const SkillSettings& settings,
                                     const RelationTask::Goal& goal);  // place_skill.cc
std::unique_ptr<Skill> MakeJointSkill(const SkillSettings& settings,
                                      const RelationTask::Goal& goal);  // joint_skill.cc
std::unique_ptr<Skill> MakePushSkill(const SkillSettings& settings,
                                     const RelationTask::Goal& goal);  // push_skill.cc
std::unique_ptr<Skill> MakeInsertSkill(const SkillSettings& settings,
                                       const RelationTask::Goal& goal);  // insert_skill.cc
std::unique_ptr<Skill> MakeWipeSkill(const SkillSettings& settings,
                                     const RelationTask::Goal& goal);  // wipe_skill.cc
std::unique_ptr<Skill> MakePourSkill(const SkillSettings& settings,
                                     const RelationTask::Goal& goal);  // pour_skill.cc

// Sets down the goal's object, which is in the hand of `settings.robot`, and draws back.
std::unique_ptr<Skill> MakePutDownSkill(const SkillSettings& settings,
                                        const RelationTask::Goal& goal);  // put_down_skill.cc

// The skill uses two arms of `settings.arms`.
std::unique_ptr<Skill> MakeHandoverSkill(const SkillSettings& settings,
                                         const RelationTask::Goal& goal);  // handover_skill.cc
std::unique_ptr<Skill> MakeCarrySkill(const SkillSettings& settings,
                                      const RelationTask::Goal& goal);  // carry_skill.cc

}  // namespace robocell
