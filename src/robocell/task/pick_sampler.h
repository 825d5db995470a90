// PickTaskSampler: objects settled on a support, one of them the target, and a robot placed beside
// it: its base in an annulus around the target with a height offset and noise, facing it, free of
// collisions and with the target in reach. Kinds of objects take turns, and distances and heights
// are spread evenly over the episodes of a run (a low-discrepancy sequence), so that a short run
// covers the configured ranges too.
//
// Stages can be replaced one by one by subclassing, in C++ and in Python. All randomness comes
// from the Rng given to Sample; a start that cannot be made is a Refusal with its reason.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "robocell/scenes/support.h"
#include "robocell/spec/run_config.h"
#include "robocell/task/base_placement.h"
#include "robocell/task/task.h"

namespace robocell {

class PickTaskSampler : public TaskSampler {
 public:
  static constexpr double kReachShare = 0.95;  // of the robot's reach that is used

  explicit PickTaskSampler(RunConfig run);
  ~PickTaskSampler() override;

  SampleResult Sample(const SampleRequest& request, Rng& rng) override;
  const RunConfig& run() const { return run_; }

  // The stages, in their order.
  virtual SceneSpec MakeBaseScene(int scene_index);
  // The target's kind first. Kinds take turns over the episodes of a scene and over the scenes, in
  // an order that changes.
  virtual std::vector<std::string> ChooseKinds(const SampleRequest& request, Rng& rng);
  // Puts the objects on the support without overlap; false when there is no room.
  virtual bool PlaceObjects(const Support& support, std::vector<SceneObject>& objects, Rng& rng);
  // Distance and height, spread evenly over the configured ranges by the episode's number.
  virtual BasePlacement ChooseBasePlacement(const SampleRequest& request, Rng& rng);
  // A pose for the robot's base (the bottom of its pedestal) around the target, facing it, where
  // the robot as it stands now keeps clear of the support; nothing when there is none. Then the
  // objects are placed anew.
  virtual std::optional<Pose> ProposeBasePose(const Robot& robot, const Support& support,
                                              const Pose& target_in_world,
                                              const BasePlacement& placement, Rng& rng);
  // Whether the robot stands free there and reaches a grasp of the target; the refusal says why
  // not.
  virtual std::optional<Refusal> CheckBasePose(Scene& scene, Robot& robot,
                                               const std::string& target_body);
  // What the episode is about: `target` among `objects`, names in the scene.
  virtual std::shared_ptr<Task> MakeTask(const std::string& target, const std::string& kind,
                                         const std::vector<std::string>& objects);

 private:
  struct Setup;  // the scene being made
  struct Measured;
  std::string KindOfTurn(std::vector<std::string> kinds, const SampleRequest& request) const;
  Support SupportOf(const SceneSpec& base);
  std::optional<Refusal> Arrange(Setup& setup, const Support& support,
                                 const BasePlacement& placement, Rng& rng);
  std::optional<Refusal> ArrangeOnce(Setup& setup, const Support& support,
                                     const BasePlacement& placement, Rng& rng);
  std::optional<Refusal> Prepare(Setup& setup, const Support& support,
                                 const BasePlacement& placement, Rng& rng);
  std::optional<Refusal> CheckGrasps(const Scene& scene, const Robot& robot,
                                     const std::string& target_body) const;

  RunConfig run_;
  std::map<std::string, Support> supports_;  // by the base scene's spec
  Measured* measured_ = nullptr;             // during Sample
};

std::unique_ptr<TaskSampler> MakePickSampler(const RunConfig& run);

}  // namespace robocell
