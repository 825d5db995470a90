#include "robocell/rollout/episode_columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <functional>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/features/units.h"
#include "robocell/mujoco/names.h"

namespace robocell::internal {
namespace {

// Returns "rad" when all units are equal, else all in order.
std::string OneOrAll(const std::vector<std::string>& units) {
  const bool same =
      std::adjacent_find(units.begin(), units.end(), std::not_equal_to<>()) == units.end();
  if (same && !units.empty()) return units.front();
  return fmt::format("{}", fmt::join(units, ", "));
}

}  // namespace

FeatureColumns::FeatureColumns(EpisodeSchema& schema, const FeatureSchema& features) {
  for (const Feature& feature : features.features())
    columns_.push_back({schema.AddColumn(feature.column), static_cast<size_t>(feature.size())});
}

void FeatureColumns::Put(EpisodeWriter& writer, std::span<const double> numbers) const {
  size_t size = 0;
  for (const Column& column : columns_) size += column.size;
  if (numbers.size() != size) {
    throw ArgumentError(fmt::format("a row has {} numbers for {} columns of {}", numbers.size(),
                                    columns_.size(), size));
  }
  for (const Column& column : columns_) {
    writer.Put(column.id, numbers.first(column.size));
    numbers = numbers.subspan(column.size);
  }
}

OutcomeColumns::OutcomeColumns(EpisodeSchema& schema, Scene scene, std::vector<std::string> phases,
                               std::vector<std::string> subtasks)
    : scene_(std::move(scene)),
      phases_(phases),
      has_subtasks_(!subtasks.empty()),
      warnings_before_(ReadWarnings(scene_.data())) {
  phase_ =
      AddLabel(schema, {.name = "phase", .type = ColumnType::kInt32, .values = std::move(phases)});
  reward_ = AddLabel(
      schema,
      {.name = "reward", .units = "1", .description = "Of the state that the action led to."});
  progress_ = AddLabel(schema, {.name = "progress",
                                .units = "1",
                                .description = "From 0 at the start to 1 at success, as the task "
                                               "sees it."});
  if (has_subtasks_) {
    subtask_ = AddLabel(schema, {.name = "subtask",
                                 .type = ColumnType::kInt32,
                                 .values = std::move(subtasks),
                                 .description = "Which part of the task the action worked at."});
  }
  success_ = AddLabel(schema, {.name = "success",
                               .type = ColumnType::kBool,
                               .description = "Whether the action led to success."});
  terminated_ = AddLabel(schema, {.name = "terminated",
                                  .type = ColumnType::kBool,
                                  .description = "The episode ended with this action."});
  truncated_ = AddLabel(schema, {.name = "truncated",
                                 .type = ColumnType::kBool,
                                 .description = "The episode was cut off after this action."});
  ik_failed_ = AddLabel(schema, {.name = "ik_failed",
                                 .type = ColumnType::kBool,
                                 .description = "A pose command of the action had no solution: its "
                                                "group kept its target."});
  warnings_ = AddLabel(schema, {.name = "engine_warnings",
                                .type = ColumnType::kInt32,
                                .description = "Engine warnings since the start of the episode."});
  control_ = schema.AddTable("control");
  const mjModel* m = scene_.model();
  control_time_ = schema.AddColumn({.name = "time", .units = "s"}, control_);
  if (m->nu > 0) {
    std::vector<std::string> names;
    for (int a = 0; a < m->nactuator; ++a) {
      for (int k = 0; k < m->actuator_ctrlnum[a]; ++k)
        names.push_back(ElementName(m, mjOBJ_ACTUATOR, a));
    }
    control_ctrl_ = schema.AddColumn(
        {.name = "ctrl",
         .shape = {m->nu},
         .units = OneOrAll(CtrlUnits(m)),
         .names = std::move(names),
         .description = "Raw controls that act from this time on; replaying them from the "
                        "first row's state gives the episode."},
        control_);
  }
}

ColumnId OutcomeColumns::AddLabel(EpisodeSchema& schema, ColumnSpec column) {
  labels_.Add({.column = column, .role = FeatureRole::kLabel, .source = "rollout"});
  return schema.AddColumn(std::move(column));
}

// Experts without names of phases are in phase 0 throughout.
void OutcomeColumns::RequirePhase(int phase) const {
  if (phase >= 0 && phase < std::max(1, static_cast<int>(phases_.size()))) return;
  const std::string allowed =
      phases_.empty() ? "phase_names() is empty, so it must be 0"
                      : fmt::format("it must be 0 to {}, an index into phase_names(): {}",
                                    phases_.size() - 1, ListNames(phases_));
  throw ArgumentError(fmt::format("the expert's phase() is {}; {}", phase, allowed));
}

void OutcomeColumns::PutPhase(EpisodeWriter& writer, int phase) {
  RequirePhase(phase);
  writer.Put(phase_, static_cast<int32_t>(phase));
}

void OutcomeColumns::PutOutcome(EpisodeWriter& writer, const RowOutcome& outcome) {
  writer.Put(reward_, outcome.reward);
  writer.Put(progress_, outcome.progress);
  if (has_subtasks_) writer.Put(subtask_, static_cast<int32_t>(outcome.subtask));
  writer.Put(success_, outcome.success);
  writer.Put(terminated_, outcome.terminated);
  writer.Put(truncated_, outcome.truncated);
  writer.Put(ik_failed_, outcome.ik_failed);
  writer.Put(warnings_, static_cast<int32_t>(outcome.warnings));
}

void OutcomeColumns::PutControl(EpisodeWriter& writer, double time, std::span<const double> ctrl) {
  writer.Put(control_time_, time);
  if (!ctrl.empty()) writer.Put(control_ctrl_, ctrl);
  writer.EndRow(control_);
}

}  // namespace robocell::internal
