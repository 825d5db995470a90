// ObjectTask: the common part of tasks about one object: it places the object, and measures its
// height and whether a robot holds it.
//
// The task names an object of the scene, or draws objects of the catalogue. In a run the kinds take
// turns: each start has a target of one kind, and up to two objects of other kinds. The scene of an
// environment has one object of each kind, and each start draws its target among them
// (drawn_objects.h). The stages of the start place the drawn objects. A start without a grasp in
// reach is refused if the object is drawn, and in all runs.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/scene/body_handle.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/spec/types.h"
#include "robocell/task/grasp_check.h"
#include "robocell/task/start_contents.h"
#include "robocell/task/task.h"

namespace robocell {

// The fields of a task that describe its object.
struct ObjectOfTask {
  std::string name = {};   // name in the scene; "" if the task draws its objects
  std::string word = {};   // its name in the instruction; `name` unless set
  double lift_height = 0;  // metres
  Vec2 spread = {0, 0};    // random offset of its position, metres
  bool rotate = false;     // about the vertical at its place
  bool refer = false;      // instructions tell it from all other objects (scenes/referral.h)
  // Kinds and categories of the catalogue that objects are drawn from; empty for the default kinds.
  std::vector<std::string> kinds = {};
  // Objects whose poses are observed; {name} unless set.
  std::optional<std::vector<std::string>> all = {};
};

class ObjectTask : public Task {
 public:
  explicit ObjectTask(ObjectOfTask object);

  // Adds the drawn objects.
  void Prepare(SceneSpec& spec, Rng& rng) override;
  // Throws ArgumentError if the object cannot move and NotFoundError if it does not exist. Begin
  // binds an unbound task with all robots of the scene.
  void Bind(const Scene& scene, const TaskSetting& setting) override;
  // Refuses starts that no robot can reach.
  std::optional<Refusal> Arrange(Scene& scene, Rng& rng) override;
  // In runs and with drawn objects, refuses a start in which no robot has a grasp in reach, or none
  // that is of use.
  std::optional<Refusal> CheckStart(const Scene& scene) override;
  void Begin(const Scene& scene) override;
  // Returns the reward 1 at success, else the largest progress so far.
  TaskVerdict Judge(const Scene& scene) override;
  // Returns "target" for the object that each start draws from those of the scene, and "object_1" and
  // "object_2" for those beside it.
  std::vector<std::string> objects() const override;
  std::string object_of(const std::string& name) const override;
  std::string kind_of(const std::string& object) const override;
  std::vector<std::string> resting_objects() const override;
  // Returns the kinds of the objects to draw, the target's first: the one whose turn it is, and up
  // to two others, so that the words mean one object. For a scene that serves all starts
  // (is_prepared_once): the kinds of the task's fields, by default three of the catalogue.
  virtual std::vector<std::string> ChooseKinds(Rng& rng);
  // Returns contents that together have each of `kinds` as the target, with all others beside it:
  // those that one start has are named as there, and further ones by their kind.
  static std::vector<StartContents> PossibleContents(const std::vector<std::string>& kinds);
  // Returns the position where the episode began, and the number of a target that each start draws.
  std::vector<double> memory() const override;
  void Recall(std::span<const double> memory) override;
  // Requires finite numbers, and a target that the scene has.
  std::string WhyNotRecalled(std::span<const double> memory) const override;

 protected:
  // Returns why a number of a memory, `what`, is no whole number from 0 to `count` - 1; "" if it is.
  static std::string WhyNoIndex(std::span<const double> memory, size_t number, const char* what,
                                size_t count);
  virtual bool IsDone(const Scene& scene) = 0;
  // Returns the progress of a state without success, less than 1.
  virtual double Progress() const = 0;

  // Returns true if the task draws its objects: it names none.
  bool draws_objects() const { return draws_objects_; }
  // Returns true in runs, where each start draws a place of the robot's base.
  bool is_run() const { return is_run_; }
  // Returns true if a start is refused without a grasp in reach.
  bool checks_grasps() const { return draws_objects_ || is_run_; }
  // Draws which of the objects is the target, if one scene serves all starts.
  void DrawTarget(Rng& rng);
  // Refuses a grasp in reach after which the task could not go on.
  virtual std::optional<Refusal> RefuseGrasp(const Scene& /*scene*/, PlanningScene& /*planning*/,
                                             const GraspMotion& /*motion*/) {
    return {};
  }
  // Adds an object to the drawn ones, after the target.
  void AddDrawn(SceneSpec& spec, const SceneObject& object, const std::string& kind);
  // Adds another object of the scene to the observed ones.
  void Observed(const std::string& object, const std::string& kind);
  // Adds an object that is observed as `part` while the part stands for it (Stand).
  void ObservedAs(const std::string& part, const std::string& object, const std::string& kind);
  void Stand(const std::string& part, const std::string& object) { stands_for_[part] = object; }
  // Returns all objects of the task in the scene, including those that this start has not drawn.
  const std::vector<std::string>& all_objects() const { return all_; }

  const ObjectOfTask& fields() const { return fields_; }
  std::string word() const { return fields_.word.empty() ? fields_.name : fields_.word; }
  // Returns the object as instructions name it: "the mug", "the mug left of the laptop".
  std::string phrase() const { return referral_.empty() ? "the " + word() : referral_; }
  const BodyHandle& object() const { return *object_; }
  const Pose& root() const { return root_; }
  const std::string& place() const { return place_; }
  const std::vector<Robot>& robots() const { return robots_; }
  Eigen::Vector3d ObjectInWorld() const { return object_->pose_in_world().translation(); }

  // Moves a place in the root frame by up to `spread`.
  static Pose Around(const Pose& offset, const Vec2& spread, Rng& rng);
  // Returns a start pose for the object in the root frame.
  Pose Start(Rng& rng) const;

  // Returns 1 with a TCP at the object; falls with the distance.
  double Nearness() const;
  // Returns the height above the start of the episode along the world's z, m.
  double Lift() const;
  // Returns the share of lift_height, 0 to 1.
  double Lifted() const;
  // Returns true if the object is lifted far enough and held (task/held.h).
  bool IsLifted(const Scene& scene) const;

 private:
  // An object of a scene that serves all starts, which may be drawn as the target.
  struct Candidate {
    std::string name, kind;
    BodyHandle body;
  };
  // What the scene without the task's objects has.
  struct Surroundings {
    std::vector<ObjectWords> words;
    std::vector<Container> containers;
  };
  Surroundings SurroundingsOf(const Scene& scene) const;
  // Finds words that mean the object alone in the scene's present state; "" if there are none.
  std::string FindReferral(const Scene& scene) const;
  void FindCandidates(const Scene& scene, const TaskSetting& setting);
  void Choose(size_t candidate);
  void RequireMovable(const Scene& scene) const;

  ObjectOfTask fields_;
  bool draws_objects_;
  bool is_run_ = false;
  std::vector<Candidate> candidates_;  // none if the scene has one target
  size_t chosen_ = 0;                  // among candidates_
  std::vector<std::string> all_;
  std::map<std::string, std::string> kinds_;       // of the drawn objects, by name
  std::map<std::string, std::string> parts_;       // part of each object that ObservedAs names
  std::map<std::string, std::string> stands_for_;  // object of each part
  std::map<std::string, GraspCheck> grasps_;       // of each robot
  std::optional<Surroundings> surroundings_;       // of a task that refers, from Prepare or Bind
  std::string referral_;
  std::string place_ = "task";
  Pose root_, offset_;
  std::optional<BodyHandle> object_;
  std::vector<Robot> robots_;
  Eigen::Vector3d start_ = Eigen::Vector3d::Zero();  // position in the root frame at the start
};

// Returns 1 at distance 0 (m), falling to 0 far away.
double Near(double distance);

}  // namespace robocell
