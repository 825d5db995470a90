// RelationTask: a task whose goal is a list of relations (scenes/relations.h). Success: all hold,
// for a time, and no robot touches their free objects, subjects and references, except those that are
// to be held. Progress
// is the mean of how near each relation is; each goal is a sub-task.
//
// Kinds of tasks derive from it (relation_tasks.h): they add objects and say the sentences.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scenes/joint_opening.h"
#include "robocell/scenes/relations.h"
#include "robocell/task/grasp_check.h"
#include "robocell/task/task.h"

namespace robocell {

class RelationTask : public Task {
 public:
  // One relation of the goal, in the scene.
  struct Goal {
    StatedRelation stated;
    std::shared_ptr<BoundRelation> bound;
    bool is_momentary = false;
    bool has_held = false;  // of a momentary one: in this episode
    bool Holds() const { return has_held || bound->Holds(); }
  };

  void Prepare(SceneSpec& spec, Rng& rng) override;
  void Bind(const Scene& scene, const TaskSetting& setting) override;
  std::optional<Refusal> Arrange(Scene& scene, Rng& rng) override;
  std::optional<Refusal> CheckStart(const Scene& scene) override;
  void Begin(const Scene& scene) override;
  TaskVerdict Judge(const Scene& scene) override;
  std::string instruction() const override;
  std::vector<std::string> objects() const override { return names_; }
  std::string kind_of(const std::string& object) const override;
  std::vector<std::string> resting_objects() const override;
  std::vector<std::string> subtasks() const override;
  Map<ObjectPlace> places() const override;
  BaseRange base_range() const override;
  std::string why_not_done() const override;
  std::vector<double> memory() const override;
  void Recall(std::span<const double> memory) override;
  std::string WhyNotRecalled(std::span<const double> memory) const override;

  const std::vector<Goal>& goals() const { return goals_; }
  double hold_seconds() const { return hold_seconds_; }
  // Returns true if no robot touches the free objects of the goal, subjects and references, that are
  // not to be held.
  bool IsReleased(const Scene& scene) const;
  // Returns true if objects are to be pushed into regions; else they are picked up and put there.
  virtual bool pushes() const { return false; }

 protected:
  explicit RelationTask(double hold_seconds = 0.3);

  // Adds the objects. The names of what it adds follow from the fields: another task of the same
  // fields may be the one that is bound.
  virtual void AddObjects(SceneSpec& spec, Rng& rng) = 0;
  // The sentences of the present start.
  virtual std::vector<std::string> StatedGoal() const = 0;
  virtual std::vector<std::string> StatedStart() const { return {}; }
  // Draws what differs between the starts of one scene, before StatedGoal() is asked.
  virtual std::optional<Refusal> Draw(Scene& /*scene*/, Rng& /*rng*/) { return {}; }
  // Returns the word of a name in the instruction, "" for the object's own.
  virtual std::string WordFor(const std::string& /*name*/) const { return ""; }
  // The number of what Draw chose, for memory(), and below which number it is.
  virtual size_t chosen() const { return 0; }
  virtual size_t choices() const { return 1; }
  virtual void Choose(size_t /*chosen*/) {}
  // Called by Bind.
  virtual void Found(const Scene& /*scene*/, const TaskSetting& /*setting*/) {}

  // Adds an object of a kind of the catalogue or of equipment, which moves unless it has a pose.
  SceneObject& Add(SceneSpec& spec, const std::string& name, const std::string& kind, Rng& rng);
  void Name(const std::string& object, const std::string& kind);
  const std::vector<std::string>& names() const { return names_; }
  bool is_run() const { return is_run_; }
  const std::vector<Robot>& robots() const { return robots_; }
  const std::string& place() const { return place_; }
  void BindGoals(const Scene& scene);
  // Refuses a start from which no robot can bring about the goal.
  std::optional<Refusal> CheckGoal(const Scene& scene, const Goal& goal);

 private:
  std::string Word(const std::string& name) const;
  std::optional<Refusal> ApplyStart(Scene& scene, Rng& rng);

  double hold_seconds_;
  std::vector<std::string> names_;            // of its objects, the first one of the goal first
  std::map<std::string, std::string> kinds_;  // of these
  bool is_run_ = false;
  std::string place_ = "task";
  std::vector<Robot> robots_;
  std::vector<Goal> goals_;
  std::vector<BodyHandle> released_;          // that no robot may touch at the end
  std::vector<std::string> moved_;            // objects that ApplyStart has put somewhere
  std::optional<Scene> scene_;                // that the goals are bound to
  std::map<std::string, GraspCheck> grasps_;  // of each robot
  double since_ = -1;                         // time at which all began to hold; -1: they do not
};

}  // namespace robocell
