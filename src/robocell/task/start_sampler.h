// StartSampler: makes the starts of a run's episodes, of any registered task, stage by stage: a base
// scene from the run's source, what the task adds to it (Task::Prepare), objects that come to rest on
// its support or where `start.places` puts them, the task's own arrangement, a robot placed beside
// the first object (base_placement.h), the task's conditions (Task::CheckStart), cameras
// (start_cameras.h) that see the object, and settling. Without objects the robot stands beside the
// middle of the support, and cameras are not checked. Distances and heights are spread evenly over the episodes of a run (a
// low-discrepancy sequence), so that a short run covers the ranges too.
//
// Subclasses can replace single stages, in C++ and in Python. All randomness comes from the Rng
// passed to Sample; a start that cannot be made is a Refusal with its stage and reason.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>
#include <Eigen/Core>

#include "robocell/base/rng.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/scenes/support.h"
#include "robocell/spec/randomize_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/start_contents.h"
#include "robocell/task/task.h"
#include "robocell/task/task_sampler.h"

namespace robocell {

namespace internal {
class Landmarks;
class RelatedPlaces;
class StartCameras;
struct StatedPlaces;
struct StillBox;
}  // namespace internal
class BodyImages;
class SceneSource;
class TaskKind;

class StartSampler : public TaskSampler {
 public:
  // Throws NotFoundError for an unknown kind of task, and the errors of its fields.
  explicit StartSampler(RunConfig run);
  ~StartSampler() override;

  SampleResult Sample(const SampleRequest& request, Rng& rng) override;
  // Adds problems for a robot that cannot be placed, a task that does not repeat what it prepares,
  // and placements, of `start.places` and of the task, that no start can satisfy.
  void ValidateStarts(std::span<const int> scenes, Problems& problems) override;
  // Adds problems of a base range, of `start` or of the task, that goes beyond the reach of the
  // run's robot. Without an object to reach there are none.
  void ValidateBaseRange(const Robot& robot, Problems& problems) override;
  const RunConfig& run() const { return run_; }
  const std::shared_ptr<SceneSource>& source() const override { return source_; }
  void DropSource() override { source_.reset(); }
  // Returns the annotations of a base scene: the source's (checked), else derived from the
  // geometry.
  std::shared_ptr<const SceneAnnotations> AnnotationsOf(int scene_index);

  // The stages, in order.
  virtual SceneSpec MakeBaseScene(int scene_index);
  // Returns where objects are put in the base scene: one of the supports that the source declares,
  // chosen at random, else the one found from its geometry.
  virtual Support FindSupportOf(const SceneSpec& base, int scene_index, Rng& rng);
  // Returns the episode's task, which has not prepared a scene yet: one of the run's kind.
  virtual std::shared_ptr<Task> MakeTask();
  // Puts the objects without a pose on the support without overlap. Returns false without room.
  // Objects that have a place in relation to something (`start.places`) are not among them.
  virtual bool PlaceObjects(const Support& support, std::vector<SceneObject>& objects, Rng& rng);
  // Returns distance and height, spread evenly over the ranges by the episode's number.
  virtual BasePlacement ChooseBasePlacement(const SampleRequest& request, Rng& rng);
  // Returns a pose for the robot's base (the bottom of its pedestal) around the target, facing it,
  // in which the robot's present configuration keeps clear of the scene, whose objects are in their
  // places, and of the swing of doors; unset if there is none. Where the source annotates free floor,
  // the base stands on it. The objects are then placed again.
  virtual std::optional<Pose> ProposeBasePose(const Robot& robot, const Support& support,
                                              const Pose& target_in_world,
                                              const BasePlacement& placement, Rng& rng);
  // Refuses a base where the robot is in collision or in the swing of a door, or the target is out of
  // reach, with the reason.
  // The task's own conditions follow (Task::CheckStart).
  virtual std::optional<Refusal> ValidateBasePose(Scene& scene, Robot& robot,
                                                  const std::string& target_body);
  // Refuses a start in which the cameras of `start.visible_from` do not see the target, with the
  // reason.
  virtual std::optional<Refusal> ValidateCameras(Scene& scene, const std::string& target_body);

 protected:
  // Moves the base to where the episode begins, once all else of the start is made. It stays beside
  // the target by default. Cameras are then placed and checked again.
  virtual std::optional<Refusal> MoveBase(const Robot& /*robot*/, int /*scene_index*/,
                                          Rng& /*rng*/) {
    return {};
  }

 private:
  SceneSource& RequireSource() const;
  struct Setup;  // the scene under construction
  // Makes a task and lets it add the episode's objects to the base scene.
  StartContents AddContents(const SampleRequest& request, SceneSpec& spec, Rng& rng);
  // Returns a few contents that together cover all possible objects of this scene's starts.
  std::vector<StartContents> PossibleContents(int scene_index);
  // Returns the names and kinds of these: `start.places` may name an object that one start lacks.
  const std::set<std::string>& PossibleNames(int scene_index);
  // Requires that prepare() makes the same of one random stream each time.
  void ValidateRepeats(int scene, Problems& problems);
  std::optional<Refusal> Arrange(Setup& setup, const BasePlacement& placement, Rng& rng);
  // Adds the objects that `randomize.clutter` draws, and returns their values.
  RandomizedValues AddClutter(const SampleRequest& request, StartContents& contents,
                              const Rng& rng) const;
  BaseRange base_range();
  std::vector<internal::StatedPlaces> PlacesStated();
  // Moves the objects among the first `before` of a scene that have a place in relation to something
  // to its end, without their poses, and returns them: they are placed like the task's.
  StartContents TakePlaced(SceneSpec& spec, size_t before);
  const std::shared_ptr<const internal::Landmarks>& LandmarksOf(const SceneSpec& base,
                                                                int scene_index);
  std::optional<internal::RelatedPlaces> RelationsOf(const SceneSpec& spec, size_t before,
                                                     int scene_index,
                                                     const StartContents& contents);
  std::optional<Refusal> PutObjects(const Support& support,
                                    const std::optional<internal::RelatedPlaces>& related,
                                    std::vector<SceneObject>& objects, Rng& rng);
  std::optional<Refusal> ValidateDistance(const Setup& setup, const Pose& proposed_for);
  static std::optional<Refusal> ValidateWithoutRobot(Setup& setup);
  // `camera_draws`: places the cameras of `start.cameras`; unset once they are placed.
  std::optional<Refusal> ValidatePlaced(Setup& setup, const std::optional<Rng>& camera_draws);
  std::optional<Refusal> ValidateStartCameras(Setup& setup, const std::optional<Rng>& camera_draws);
  // Returns the cameras of `start.cameras` for scenes of this base; null if there are none.
  std::shared_ptr<internal::StartCameras> CamerasOf(const SceneSpec& base);
  std::optional<Refusal> ArrangeOnce(Setup& setup, const BasePlacement& placement, Rng& rng);
  void FindStillBoxes(const Setup& setup);
  double FloorHeight(int scene_index);
  static std::vector<std::string> RestingObjects(const Setup& setup);
  std::optional<Refusal> PrepareStart(Setup& setup, const BasePlacement& placement, Rng& rng);
  std::optional<Refusal> BeginElsewhere(Setup& setup, Rng& rng);

  static constexpr size_t kMostScenes = 64;  // whose supports, landmarks and cameras are kept

  RunConfig run_;
  std::shared_ptr<const TaskKind> kind_;
  std::shared_ptr<SceneSource> source_;
  // Task of the start under construction; a finished start owns its task alone.
  std::shared_ptr<Task> task_;
  // Results by base scene.
  std::map<std::string, Support> supports_;
  std::map<std::string, std::shared_ptr<const internal::Landmarks>> landmarks_;
  std::map<std::string, std::shared_ptr<const SceneAnnotations>> annotations_;
  std::map<int, std::set<std::string>> possible_names_;
  std::map<std::string, std::shared_ptr<internal::StartCameras>> cameras_;
  std::shared_ptr<BodyImages> images_;
  std::vector<Eigen::Vector2d> rejected_bases_;  // touching something, in this start
  std::vector<Articulation> doors_;              // of the base scene in use
  std::vector<internal::StillBox> still_boxes_;  // of the base scene in use, once it is compiled
  std::vector<FloorArea>
      free_floor_;  // of the base scene in use, from the source; empty if unknown
  std::unique_ptr<ObjectSizes> sizes_;  // renewed in each Sample: models may change on the disk
};

}  // namespace robocell
