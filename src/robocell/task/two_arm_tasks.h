// The built-in tasks for two arms: handover, carry. The constructors throw SpecError for fields that
// are not valid.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robocell/task/relation_task.h"
#include "robocell/task/two_arm_task_config.h"

namespace robocell::internal {

// One arm picks an object up, and another one takes it in the air.
class HandoverTask final : public RelationTask {
 public:
  static constexpr int kArms = 2;

  explicit HandoverTask(const HandoverTaskConfig& fields);

 private:
  void AddObjects(SceneSpec& spec, Rng& rng) override;
  void Found(const Scene& scene, const TaskSetting& setting) override;
  std::vector<std::string> StatedGoal() const override;

  HandoverTaskConfig task_;
};

// Two arms lift a wide object, carry it level, and set it down in a marked region.
class CarryTask final : public RelationTask {
 public:
  static constexpr int kArms = 2;

  explicit CarryTask(const CarryTaskConfig& fields);
  // Refuses a start unless two arms can grasp the object at its two ends.
  std::optional<Refusal> CheckStart(const Scene& scene) override;

 private:
  void AddObjects(SceneSpec& spec, Rng& rng) override;
  void Found(const Scene& scene, const TaskSetting& setting) override;
  std::optional<Refusal> Draw(Scene& scene, Rng& rng) override;
  std::vector<std::string> StatedGoal() const override;
  std::string WordFor(const std::string& name) const override;

  CarryTaskConfig task_;
};

}  // namespace robocell::internal
