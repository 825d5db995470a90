// The built-in tasks that need skill with an object in the hand: insert, sort, wipe, pour. The
// constructors throw SpecError for fields that are not valid.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/scene/body_handle.h"
#include "robocell/task/held_task_config.h"
#include "robocell/task/relation_task.h"

namespace robocell::internal {

// A peg is put into its hole, or a plug into its socket.
class InsertTask final : public RelationTask {
 public:
  static constexpr double kHoleWidth = 0.03;  // m, of the models square_hole and round_hole

  explicit InsertTask(const InsertTaskConfig& fields);
  static std::vector<std::string> AllShapes();
  // Returns an object of a shape, without a pose.
  static SceneObject MakePeg(const std::string& shape, const std::string& name, double clearance);

  std::vector<Feature> signals() const override;
  void Observe(const Scene& scene, std::span<double> out) const override;

 private:
  void AddObjects(SceneSpec& spec, Rng& rng) override;
  void Found(const Scene& scene, const TaskSetting& setting) override;
  std::vector<std::string> StatedGoal() const override;
  std::string WordFor(const std::string& name) const override;

  InsertTaskConfig task_;
};

// Cubes are put on the plates of their colours.
class SortTask final : public RelationTask {
 public:
  explicit SortTask(const SortTaskConfig& fields);
  // Refuses a start unless each cube can be put on its plate.
  std::optional<Refusal> CheckStart(const Scene& scene) override;

 private:
  void AddObjects(SceneSpec& spec, Rng& rng) override;
  void Found(const Scene& scene, const TaskSetting& setting) override;
  std::vector<std::string> StatedGoal() const override;
  std::string WordFor(const std::string& name) const override;

  SortTaskConfig task_;
};

// A marked area is wiped with a sponge.
class WipeTask final : public RelationTask {
 public:
  explicit WipeTask(const WipeTaskConfig& fields);
  std::vector<Feature> signals() const override;
  void Observe(const Scene& scene, std::span<double> out) const override;
  // Returns the number of cells of the area, as many in every scene: they are recorded.
  static int CellCount();

 private:
  void AddObjects(SceneSpec& spec, Rng& rng) override;
  void Found(const Scene& scene, const TaskSetting& setting) override;
  std::optional<Refusal> Draw(Scene& scene, Rng& rng) override;
  std::vector<std::string> StatedGoal() const override;
  std::string WordFor(const std::string& name) const override;

  WipeTaskConfig task_;
  std::optional<BodyHandle> sponge_;
};

// What is in a vessel is poured into another one.
class PourTask final : public RelationTask {
 public:
  static constexpr const char* kDefaultVessel = "open_bottle";

  explicit PourTask(const PourTaskConfig& fields);
  // Returns why nothing can be poured from a kind of vessel, or into it; "" if it can.
  static std::string WhyNotFrom(const std::string& kind, const PourTaskConfig& fields);
  static std::string WhyNotInto(const std::string& kind);
  // Refuses a start in which grains are beside the vessel.
  std::optional<Refusal> CheckStart(const Scene& scene) override;
  std::vector<Feature> signals() const override;
  void Observe(const Scene& scene, std::span<double> out) const override;

 private:
  void AddObjects(SceneSpec& spec, Rng& rng) override;
  void Found(const Scene& scene, const TaskSetting& setting) override;
  std::optional<Refusal> Draw(Scene& scene, Rng& rng) override;
  std::vector<std::string> StatedGoal() const override;

  PourTaskConfig task_;
};

}  // namespace robocell::internal
