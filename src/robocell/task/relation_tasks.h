// The built-in tasks whose goals are relations: `relations` (written in a file), `stack`,
// `place_next_to`, `open`, `close`, `press`, `push`. The constructors throw SpecError for fields that
// are not valid.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "robocell/spec/types.h"
#include "robocell/task/relation_task.h"
#include "robocell/task/relation_task_config.h"

namespace robocell {

// Goals and starts as in a file.
class RelationsTask final : public RelationTask {
 public:
  explicit RelationsTask(const RelationsTaskConfig& fields);
  std::string instruction() const override;

 private:
  void AddObjects(SceneSpec& spec, Rng& rng) override;
  void Found(const Scene& scene, const TaskSetting& setting) override;
  std::vector<std::string> StatedGoal() const override { return task_.goal.names; }
  std::vector<std::string> StatedStart() const override { return task_.start.names; }

  RelationsTaskConfig task_;
};

// Cubes of different colours, each on the one before it.
class StackTask final : public RelationTask {
 public:
  explicit StackTask(const StackTaskConfig& fields);
  // Throws SpecError for a number that StackTaskConfig does not allow.
  static std::vector<std::string> NamesOf(int cubes);

 private:
  void AddObjects(SceneSpec& spec, Rng& rng) override;
  void Found(const Scene& scene, const TaskSetting& setting) override;
  std::vector<std::string> StatedGoal() const override;
  std::string WordFor(const std::string& name) const override;

  StackTaskConfig task_;
};

// One object beside another one.
class PlaceNextToTask final : public RelationTask {
 public:
  explicit PlaceNextToTask(const PlaceNextToTaskConfig& fields);

 private:
  void AddObjects(SceneSpec& spec, Rng& rng) override;
  void Found(const Scene& scene, const TaskSetting& setting) override;
  std::vector<std::string> StatedGoal() const override;

  PlaceNextToTaskConfig task_;
};

// One joint of an object is opened, closed or pressed.
class JointTask final : public RelationTask {
 public:
  explicit JointTask(const OpenTaskConfig& fields);
  explicit JointTask(const CloseTaskConfig& fields);
  explicit JointTask(const PressTaskConfig& fields);

  // Returns the kinds of furniture that are drawn unless the task names some.
  static std::vector<std::string> DefaultKinds(const std::string& relation);
  BaseRange base_range() const override;
  std::vector<Feature> signals() const override;
  void Observe(const Scene& scene, std::span<double> out) const override;

 private:
  void AddObjects(SceneSpec& spec, Rng& rng) override;
  void Found(const Scene& scene, const TaskSetting& setting) override;
  std::optional<Refusal> Draw(Scene& scene, Rng& rng) override;
  std::vector<std::string> StatedGoal() const override;
  std::string WordFor(const std::string& name) const override;
  size_t chosen() const override { return chosen_; }
  size_t choices() const override { return std::max<size_t>(1, joints_.size()); }
  void Choose(size_t chosen) override { chosen_ = chosen; }
  std::string joint() const { return joints_.empty() ? "" : joints_[chosen_]; }

  std::string relation_, object_, joint_;
  std::vector<std::string> kinds_;
  bool draws_;
  double share_;
  Vec2 start_ = {0, 0};
  std::vector<std::string> joints_;  // full names
  size_t chosen_ = 0;
};

// An object is pushed into a marked region.
class PushTask final : public RelationTask {
 public:
  explicit PushTask(const PushTaskConfig& fields);
  bool pushes() const override { return true; }

 private:
  void AddObjects(SceneSpec& spec, Rng& rng) override;
  void Found(const Scene& scene, const TaskSetting& setting) override;
  std::optional<Refusal> Draw(Scene& scene, Rng& rng) override;
  std::vector<std::string> StatedGoal() const override;
  std::string WordFor(const std::string& name) const override;

  PushTaskConfig task_;
};

}  // namespace robocell
