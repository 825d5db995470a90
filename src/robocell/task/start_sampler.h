// StartSampler: where the episodes of a run start, stage by stage: a base scene from the run's
// source, objects that come to rest on its support or where `start.places` puts them, what the task
// does itself, a robot placed beside the first object (base_placement.h), cameras that see it, and
// settling. Without objects the robot stands beside the middle of the support, and cameras are not
// looked through. Distances and heights are spread evenly over the episodes of a run (a
// low-discrepancy sequence), so that a short run covers the ranges too.
//
// Stages can be replaced one by one by subclassing, in C++ and in Python. All randomness comes from
// the Rng given to Sample; a start that cannot be made is a Refusal with its stage and reason.
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

// The objects of a start: what it is about first.
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

  // The stages, in their order.
  virtual SceneSpec MakeBaseScene(int scene_index);
  // Where objects are put in the base scene: one of the supports that the source knows of, chosen
  // at random, else the one that its geometry has.
  virtual Support FindSupportOf(const SceneSpec& base, int scene_index, Rng& rng);
  // Adds what the episode is about to the base scene and says what was added.
  virtual StartContents AddContents(const SampleRequest& request, SceneSpec& spec, Rng& rng) = 0;
  // Puts the objects without a pose on the support without overlap; false when there is no room.
  // Objects that have a place in relation to something (`start.places`) are not among them.
  virtual bool PlaceObjects(const Support& support, std::vector<SceneObject>& objects, Rng& rng);
  // Distance and height, spread evenly over the ranges by the episode's number.
  virtual BasePlacement ChooseBasePlacement(const SampleRequest& request, Rng& rng);
  // A pose for the robot's base (the bottom of its pedestal) around the target, facing it, where
  // the robot as it stands now keeps clear of the support; nothing when there is none. Then the
  // objects are placed anew.
  virtual std::optional<Pose> ProposeBasePose(const Robot& robot, const Support& support,
                                              const Pose& target_in_world,
                                              const BasePlacement& placement, Rng& rng);
  // Whether the robot stands free there, with the target in reach; the refusal says why not.
  virtual std::optional<Refusal> ValidateBasePose(Scene& scene, Robot& robot,
                                                  const std::string& target_body);
  // Whether the cameras of `start.visible_from` see the target; the refusal says why not.
  virtual std::optional<Refusal> ValidateCameras(Scene& scene, const std::string& target_body);
  // What the episode is about: `target` among `objects`, names in the scene.
  virtual std::shared_ptr<Task> MakeTask(const std::string& target, const std::string& kind,
                                         const std::vector<std::string>& objects) = 0;

 protected:
  // The task's own range of base poses, where `start` of the run says nothing.
  virtual BaseRange own_base_range() const { return {}; }
  // Whether an object of another start may have this name or kind, so that `start.places` may name
  // what this start does not have.
  virtual bool MayHaveObject(const std::string& /*name*/) const { return false; }
  // Contents of a few starts that have among them what starts of this scene may have.
  virtual std::vector<StartContents> PossibleContents(int scene_index);
  // The task's own places of objects in relation to something; those of `start` come before them.
  virtual Map<ObjectPlace> own_places() const { return {}; }
  // Where the task itself puts bodies of the scene, by their names; asked before the base is placed,
  // each time that objects are.
  virtual BodyPoses TaskStarts(Rng& /*rng*/) { return {}; }
  // What the task does itself once everything is in its place, before it settles.
  virtual std::optional<Refusal> ArrangeTask(Scene& /*scene*/, Rng& /*rng*/) { return {}; }
  // Sizes of objects, measured once in a call of Sample.
  ObjectSizes& sizes();
  // What is the same in one call of Sample, and costs a look at the disk each time.
  std::shared_ptr<const GripperShape>& shape();

 private:
  struct Setup;  // the scene being made
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
  std::map<std::string, Support> supports_;  // by the base scene's spec
  std::map<std::string, std::shared_ptr<const internal::Landmarks>> landmarks_;  // the same
  std::map<std::string, std::shared_ptr<const SceneAnnotations>> annotations_;   // the same
  std::unique_ptr<Measured> measured_;  // anew in each Sample
};

// Starts of a registered task: Task::Prepare adds the objects. Those without a pose are put on the
// support; the task may move them with Starts and Arrange.
class TaskStartSampler : public StartSampler {
 public:
  explicit TaskStartSampler(const RunConfig& run);

  StartContents AddContents(const SampleRequest& request, SceneSpec& spec, Rng& rng) override;
  std::shared_ptr<Task> MakeTask(const std::string& target, const std::string& kind,
                                 const std::vector<std::string>& objects) override;

 protected:
  BaseRange own_base_range() const override;
  Map<ObjectPlace> own_places() const override;
  BodyPoses TaskStarts(Rng& rng) override;
  std::optional<Refusal> ArrangeTask(Scene& scene, Rng& rng) override;

 private:
  std::shared_ptr<const TaskKind> kind_;
  std::shared_ptr<Task> task_;  // of the start that is being made
};

}  // namespace robocell
