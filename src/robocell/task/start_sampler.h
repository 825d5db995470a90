// StartSampler: makes the starts of a run's episodes stage by stage: a base scene from the run's
// source, objects that come to rest on its support or where `start.places` puts them, the task's
// own arrangement, a robot placed beside the first object (base_placement.h), cameras that see it,
// and settling. Without objects the robot stands beside the middle of the support, and cameras are
// not checked. Distances and heights are spread evenly over the episodes of a run (a
// low-discrepancy sequence), so that a short run covers the ranges too.
//
// Subclasses can replace single stages, in C++ and in Python. All randomness comes from the Rng
// passed to Sample; a start that cannot be made is a Refusal with its stage and reason.
// TaskStartSampler makes starts of any registered task.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/support.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/task.h"

namespace robocell {

namespace internal {
class Landmarks;
class RelatedPlaces;
struct SaidPlaces;
}  // namespace internal
class GripperShape;
class SceneSource;
class TaskKind;

// The objects of a start, the target first.
struct StartContents {
  std::vector<SceneObject> objects;
  std::vector<std::string> kinds;  // what to call each, by the catalogue where it is from there
};

class StartSampler : public TaskSampler {
 public:
  explicit StartSampler(RunConfig run);
  ~StartSampler() override;

  SampleResult Sample(const SampleRequest& request, Rng& rng) override;
  // Places of `start.places` and of the task that no start can have.
  void ValidateStarts(std::span<const int> scenes, Problems& problems) override;
  const RunConfig& run() const { return run_; }
  // What is known of a base scene: what its source says, checked, else what follows from its
  // geometry.
  std::shared_ptr<const SceneAnnotations> AnnotationsOf(int scene_index);

  // The stages, in order.
  virtual SceneSpec MakeBaseScene(int scene_index);
  // Returns where objects are put in the base scene: one of the supports that the source declares,
  // chosen at random, else the one found from its geometry.
  virtual Support FindSupportOf(const SceneSpec& base, int scene_index, Rng& rng);
  // Adds the episode's objects to the base scene and returns what was added.
  virtual StartContents AddContents(const SampleRequest& request, SceneSpec& spec, Rng& rng) = 0;
  // Puts the objects without a pose on the support without overlap; false when there is no room.
  // Objects that have a place in relation to something (`start.places`) are not among them.
  virtual bool PlaceObjects(const Support& support, std::vector<SceneObject>& objects, Rng& rng);
  // Returns distance and height, spread evenly over the ranges by the episode's number.
  virtual BasePlacement ChooseBasePlacement(const SampleRequest& request, Rng& rng);
  // Returns a pose for the robot's base (the bottom of its pedestal) around the target, facing it,
  // in which the robot's present configuration keeps clear of the support; unset if there is none.
  // The objects are then placed anew.
  virtual std::optional<Pose> ProposeBasePose(const Robot& robot, const Support& support,
                                              const Pose& target_in_world,
                                              const BasePlacement& placement, Rng& rng);
  // Refuses a base where the robot is in collision or the target is out of reach, with the reason.
  virtual std::optional<Refusal> ValidateBasePose(Scene& scene, Robot& robot,
                                                  const std::string& target_body);
  // Refuses a start in which the cameras of `start.visible_from` do not see the target, with the
  // reason.
  virtual std::optional<Refusal> ValidateCameras(Scene& scene, const std::string& target_body);
  // Returns the episode's task: `target` is among `objects`, all names in the scene.
  virtual std::shared_ptr<Task> MakeTask(const std::string& target, const std::string& kind,
                                         const std::vector<std::string>& objects) = 0;

 protected:
  // Returns the task's own range of base poses, for what `start` of the run leaves open.
  virtual BaseRange own_base_range() const { return {}; }
  // Returns true if an object of another start may have this name or kind, so that `start.places`
  // may name an object that this start lacks.
  virtual bool MayHaveObject(const std::string& /*name*/) const { return false; }
  // Contents of a few starts that have among them what starts of this scene may have.
  virtual std::vector<StartContents> PossibleContents(int scene_index);
  // Returns the task's own places of objects in relation to others; those of `start` take
  // precedence.
  virtual Map<ObjectPlace> own_places() const { return {}; }
  // Returns where the task itself puts bodies of the scene, by name. Called before the base is
  // placed, each time that objects are placed.
  virtual BodyPoses TaskStarts(Rng& /*rng*/) { return {}; }
  // Arranges the scene for the task, with everything in its place and before it settles.
  virtual std::optional<Refusal> ArrangeTask(Scene& /*scene*/, Rng& /*rng*/) { return {}; }
  // Returns the sizes of objects, measured once in a call of Sample.
  ObjectSizes& sizes();
  // Returns the gripper's shape, which reads the disk and stays the same in one call of Sample.
  std::shared_ptr<const GripperShape>& shape();

 private:
  struct Setup;  // the scene under construction
  struct Measured;
  std::optional<Refusal> Arrange(Setup& setup, const Support& support,
                                 const BasePlacement& placement, Rng& rng);
  BaseRange base_range() const { return BaseRangeOf(run_.start, own_base_range()); }
  std::vector<internal::SaidPlaces> SaidOfPlaces() const;
  const std::shared_ptr<const internal::Landmarks>& LandmarksOf(const SceneSpec& base,
                                                                int scene_index);
  std::optional<internal::RelatedPlaces> RelationsOf(const SceneSpec& spec, size_t before,
                                                     int scene_index,
                                                     const StartContents& contents);
  std::optional<Refusal> PutObjects(const Support& support,
                                    const std::optional<internal::RelatedPlaces>& related,
                                    std::vector<SceneObject>& objects, Rng& rng);
  std::optional<Refusal> ValidateDistance(const Setup& setup, const Pose& proposed_for) const;
  std::optional<Refusal> ValidatePlaced(Setup& setup);
  std::optional<Refusal> ArrangeOnce(Setup& setup, const Support& support,
                                     const BasePlacement& placement, Rng& rng);
  std::optional<Refusal> PrepareStart(Setup& setup, const Support& support,
                                      const BasePlacement& placement, Rng& rng);

  RunConfig run_;
  std::shared_ptr<SceneSource> source_;
  std::map<std::string, Support> supports_;  // by the spec of the base scene
  std::map<std::string, std::shared_ptr<const internal::Landmarks>> landmarks_;  // likewise
  std::map<std::string, std::shared_ptr<const SceneAnnotations>> annotations_;   // the same
  std::unique_ptr<Measured> measured_;  // renewed in each Sample
};

// Starts of a registered task: Task::Prepare adds the objects. Those without a pose are put on the
// support; the task may move them with Starts and Arrange.
class TaskStartSampler : public StartSampler {
 public:
  explicit TaskStartSampler(const RunConfig& run);

  SampleResult Sample(const SampleRequest& request, Rng& rng) override;
  StartContents AddContents(const SampleRequest& request, SceneSpec& spec, Rng& rng) override;
  std::shared_ptr<Task> MakeTask(const std::string& target, const std::string& kind,
                                 const std::vector<std::string>& objects) override;
  void ValidateStarts(std::span<const int> scenes, Problems& problems) override;

 protected:
  BaseRange own_base_range() const override;
  Map<ObjectPlace> own_places() const override;
  BodyPoses TaskStarts(Rng& rng) override;
  std::optional<Refusal> ArrangeTask(Scene& scene, Rng& rng) override;

 private:
  Task& task() const;

  std::shared_ptr<const TaskKind> kind_;
  // Of the start under construction. A finished start is the only owner of its task.
  mutable std::shared_ptr<Task> task_;
};

}  // namespace robocell
