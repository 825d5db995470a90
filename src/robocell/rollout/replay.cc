#include "robocell/rollout/replay.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <span>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/version.h"
#include "robocell/env/env_state.h"
#include "robocell/env/object_variations.h"
#include "robocell/features/feature_source.h"
#include "robocell/robot/robot.h"
#include "robocell/rollout/env_of_episode.h"
#include "robocell/rollout/episode_reading.h"
#include "robocell/rollout/randomized_record.h"
#include "robocell/rollout/recorded_scene.h"
#include "robocell/scenes/randomized_model.h"
#include "robocell/spec/env_config.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

using Json = nlohmann::json;

const std::string kTicks(kControlTickColumn);

// A missing value differs from every number, but not from another missing value.
bool Differ(double a, double b, double tolerance) {
  if (std::isnan(a) || std::isnan(b)) return std::isnan(a) != std::isnan(b);
  return std::abs(a - b) > tolerance;
}

// A recorded column and how to read it from the simulation.
struct Quantity {
  std::string column;
  std::vector<double> recorded;  // all rows
  std::function<void(std::span<double>)> read;
  std::function<std::string(size_t)> name;
  std::string units;
  std::vector<double> now;  // values of one row

  std::span<const double> Row(int64_t row) const {
    return std::span(recorded).subspan(now.size() * static_cast<size_t>(row), now.size());
  }
};

// Returns the unit of one value of a column, from the column's units: one for all values, one for
// each, or one for the translation and one for the rotation of a pose or twist. "" for a value
// without a unit.
std::string UnitOfValue(const std::string& units, size_t i, size_t count) {
  std::vector<std::string> parts;
  for (size_t from = 0; from <= units.size();) {
    const size_t comma = std::min(units.find(", ", from), units.size());
    parts.push_back(units.substr(from, comma - from));
    from = comma + 2;
  }
  const bool spatial = parts.size() == 2 && (count == 6 || count == 7);
  const size_t part = spatial ? i / 3 : i;
  const std::string& unit = parts.size() == 1 ? parts[0] : parts[std::min(part, parts.size() - 1)];
  return unit == "1" ? "" : unit;
}

// A quaternion and its negative are the same rotation; a pose ends with one.
void AlignQuaternion(std::span<double> pose, std::span<const double> with) {
  const double dot = std::inner_product(pose.begin() + 3, pose.end(), with.begin() + 3, 0.0);
  if (dot >= 0) return;
  for (double& q : pose.subspan(3)) q = -q;
}

Rates ReadRates(const Episode& episode) {
  const auto rates = internal::EpisodeJson::Metadata(episode).Find("rates");
  if (!rates || !rates->Find("control_ms") || !rates->Find("sim_ms")) {
    throw ArgumentError(
        fmt::format("episode '{}' cannot be replayed: its metadata has no rates; episodes that "
                    "robocell generated have them",
                    episode.folder().string()));
  }
  const auto read = [&](const char* key) {
    const internal::EpisodeJson value = rates->At(key);
    if (!value.value().is_number() || !(value.value().get<double>() > 0))
      value.ThrowNot("a number of milliseconds above 0");
    return value.value().get<double>();
  };
  return {.policy_ms = read(rates->Find("policy_ms") ? "policy_ms" : "control_ms"),
          .control_ms = read("control_ms"),
          .sim_ms = read("sim_ms")};
}

std::string VersionsThatChanged(const Episode& episode) {
  const internal::EpisodeJson then = internal::EpisodeJson::Versions(episode);
  const Json now = {{"mujoco", mj_versionString()}, {"robocell", std::string(Version())}};
  std::string text;
  for (const auto& [part, version] : now.items()) {
    const auto recorded = then.Find(part);
    if (!recorded) continue;
    const auto before = recorded->AsText();
    if (before.empty() || before == version) continue;
    text += fmt::format("{}recorded with {} {}, this is {}", text.empty() ? "" : "; ", part, before,
                        version.get<std::string>());
  }
  return text;
}

class Replay {
 public:
  Replay(const Episode& episode, const ReplayOptions& options)
      : episode_(episode),
        scene_(Scene::Build(RecordedScene(episode))),
        rates_(ReadRates(episode)),
        options_(options),
        times_(episode.Read<double>("control/time")),
        first_ticks_(FirstTicks()) {
    VaryObjects();
    if (nu()) ctrl_ = episode.Read<double>("control/ctrl");
    RequireFit();
    for (const Robot& robot : RobotsOf(scene_)) AddRobot(robot, "qpos");
    for (const ObjectRecord& object : scene_.compiled()->objects()) AddObject(object);
    for (const Robot& robot : RobotsOf(scene_)) AddRobot(robot, "qvel");
  }

  ReplayResult Run() {
    report_.episode = episode_.id();
    report_.versions = VersionsThatChanged(episode_);
    scene_.SetState(episode_.Read<double>("initial_state"));
    for (int64_t row = 0; row < episode_.rows(); ++row) {
      if (!CompareRow(row)) break;
      ++report_.rows;
      const int64_t end = first_ticks_[static_cast<size_t>(row) + 1];
      while (report_.ticks < end && !report_.first) RunTick(row);
      if (report_.first) break;
    }
    return report_;
  }

  void Play(const std::function<bool(const Scene&, int64_t)>& at_row) {
    scene_.SetState(episode_.Read<double>("initial_state"));
    for (int64_t row = 0; row < episode_.rows(); ++row) {
      scene_.SyncPoses();
      if (!at_row(scene_, row)) return;
      for (int64_t tick = first_ticks_[static_cast<size_t>(row)];
           tick < first_ticks_[static_cast<size_t>(row) + 1]; ++tick) {
        if (!Apply(static_cast<size_t>(tick)).ok()) return;
      }
    }
  }

 private:
  size_t nu() const { return static_cast<size_t>(scene_.model()->nu); }
  int64_t ticks() const { return static_cast<int64_t>(times_.size()); }

  bool Has(const std::string& column) const {
    const auto& all = episode_.columns();
    return std::any_of(all.begin(), all.end(),
                       [&](const ColumnInfo& info) { return info.spec.name == column; });
  }

  [[noreturn]] void ThrowUnfit(const std::string& what) const {
    throw SpecError(
        fmt::format("episode '{}' cannot be replayed: {}; were its model files changed "
                    "since? dataset.json has their hashes",
                    episode_.folder().string(), what));
  }

  void RequireFit() const {
    const size_t state = scene_.state().size(), then = episode_.ValueCount("initial_state");
    if (state != then)
      ThrowUnfit(fmt::format("its scene has a state of {} numbers, {} were recorded", state, then));
    if (ctrl_.size() != nu() * times_.size())
      ThrowUnfit(fmt::format("its scene has {}, recorded: {}", Counted(nu(), "control"),
                             ctrl_.size() / std::max<size_t>(times_.size(), 1)));
    // A divergence may have ended the last row early.
    const int64_t per_row = rates_.control_ticks(), rows = episode_.rows();
    if (std::ranges::is_sorted(first_ticks_) && first_ticks_.end()[-2] < ticks() &&
        (Has(kTicks) || ticks() <= rows * per_row))
      return;
    if (Has(kTicks)) {
      throw IoError(fmt::format(
          "episode '{}': its number of control ticks, {}, does not fit what column '{}' says",
          episode_.folder().string(), ticks(), kTicks));
    }
    throw IoError(
        fmt::format("episode '{}': its number of control ticks, {}, does not fit {} of {}",
                    episode_.folder().string(), ticks(), Counted(rows, "row"), per_row));
  }

  // Returns the first tick of each row, and the end of the last row. Steps of environments take as
  // long as they need.
  std::vector<int64_t> FirstTicks() const {
    std::vector<int64_t> first;
    if (Has(kTicks)) {
      first = internal::ReadSteps<int64_t>(episode_, kTicks);
    } else {
      internal::RequireRowOfEachStep(episode_, "time");
      for (int64_t row = 0; row < episode_.rows(); ++row)
        first.push_back(row * rates_.control_ticks());
    }
    first.push_back(ticks());
    return first;
  }

  // Applies what was randomised, and the variations that the environment drew for the objects.
  void VaryObjects() {
    if (const RandomizedValues values = internal::RandomizedOf(episode_); !values.empty())
      randomized_.emplace(scene_.inner()).Apply(values, internal::RandomizedModel::Part::kPhysics);
    const auto environment = internal::EpisodeJson::Metadata(episode_).Find("environment");
    const auto variations = environment ? environment->Find("variations") : std::nullopt;
    if (!variations) return;
    const auto config = variations->AsSpec<EnvConfig>();
    const std::vector<double> start = episode_.Read<double>(std::string(kEnvStateColumn));
    internal::ObjectVariations(config, scene_).Apply(EnvState::FromNumbers(start).variations);
  }

  void Add(Quantity quantity) {
    if (!Has(quantity.column)) return;
    quantity.recorded = internal::ReadSteps<double>(episode_, quantity.column);
    const ColumnInfo& info = episode_.column(quantity.column);
    quantity.units = info.spec.units;
    quantity.now.resize(static_cast<size_t>(RowValues(info.spec.shape)));
    quantities_.push_back(std::move(quantity));
  }

  // Adds positions or velocities of a robot's groups, by the joints' names where each joint has one
  // value.
  void AddRobot(const Robot& robot, const std::string& kind) {
    for (const std::string& group : robot.group_names()) {
      const std::string column = fmt::format("robots/{}/{}/{}", robot.name(), group, kind);
      if (!Has(column)) continue;
      const std::vector<std::string> names = episode_.column(column).spec.names;
      const std::string suffix =
          fmt::format(" of {}/{}{}", robot.name(), group, kind == "qvel" ? ", velocity" : "");
      Add({.column = column,
           .recorded = {},
           .read =
               [move = robot.shared_group(group), kind](std::span<double> out) {
                 kind == "qpos" ? move->GetJointPos(out) : move->GetJointVel(out);
               },
           .name =
               [names, suffix](size_t i) {
                 return (i < names.size() ? "joint '" + names[i] + "'"
                                          : fmt::format("joint value {}", i)) +
                        suffix;
               },
           .units = {},
           .now = {}});
    }
  }

  void AddObject(const ObjectRecord& object) {
    const std::string column = "objects/" + object.name + "/pose";
    if (!Has(column)) return;
    const std::vector<std::string> names = episode_.column(column).spec.names;
    Add({.column = column,
         .recorded = {},
         .read =
             [this, body = object.root_body](std::span<double> out) {
               std::array<double, kPoseNumbers> pose;
               PutPose(scene_.body_pose(body), pose);
               std::copy(pose.begin(), pose.end(), out.begin());
             },
         .name =
             [name = object.name, names](size_t i) {
               return fmt::format("object '{}' {}", name, i < names.size() ? names[i] : "pose");
             },
         .units = {},
         .now = {}});
  }

  // Returns false if something differs.
  bool CompareRow(int64_t row) {
    for (Quantity& quantity : quantities_) {
      quantity.read(quantity.now);
      const std::span<const double> then = quantity.Row(row);
      if (quantity.column.starts_with("objects/")) AlignQuaternion(quantity.now, then);
      for (size_t i = 0; i < then.size(); ++i) {
        if (!Differ(then[i], quantity.now[i], options_.tolerance)) continue;
        if (report_.first) {
          ++report_.first->others;
          continue;
        }
        report_.first = {.row = row,
                         .tick = report_.ticks,
                         .time = scene_.time(),
                         .what = quantity.name(i),
                         .column = quantity.column,
                         .recorded = then[i],
                         .replayed = quantity.now[i],
                         .units = UnitOfValue(quantity.units, i, then.size())};
      }
    }
    return !report_.first;
  }

  StepResult Apply(size_t tick) {
    std::copy_n(ctrl_.begin() + static_cast<std::ptrdiff_t>(tick * nu()), nu(),
                scene_.data()->ctrl);
    return scene_.StepN(rates_.sim_steps());
  }

  void RunTick(int64_t row) {
    const size_t tick = static_cast<size_t>(report_.ticks);
    if (Differ(times_[tick], scene_.time(), options_.tolerance)) {
      return Differs(row, "the clock", "control/time", times_[tick], scene_.time());
    }
    const StepResult step = Apply(tick);
    ++report_.ticks;
    // A recorded divergence ends the record with exactly this tick.
    if (!step.ok() && report_.ticks < ticks())
      Differs(row, "the replay " + step.message, "control/time", times_[tick], scene_.time());
  }

  void Differs(int64_t row, const std::string& what, const std::string& column, double recorded,
               double replayed) {
    report_.first = {.row = row,
                     .tick = report_.ticks,
                     .time = recorded,
                     .what = what,
                     .column = column,
                     .recorded = recorded,
                     .replayed = replayed,
                     .units = "s"};
  }

  const Episode& episode_;
  Scene scene_;
  std::optional<internal::RandomizedModel> randomized_;  // of episodes with `randomize`
  Rates rates_;
  ReplayOptions options_;
  std::vector<double> times_, ctrl_;
  std::vector<int64_t> first_ticks_;  // first tick of each row, and the end of the last row
  std::vector<Quantity> quantities_;
  ReplayResult report_;
};

}  // namespace

std::string ReplayResult::Text() const {
  if (ok())
    return fmt::format("{}: {}, {}: identical", episode, Counted(rows, "row"),
                       Counted(ticks, "control tick"));
  const ReplayDifference& d = *first;
  std::string text = fmt::format(
      "{}: differs first in row {} (control tick {}, t = {:.3f} s): {}: {:.12g}{} recorded, "
      "{:.12g} replayed",
      episode, d.row, d.tick, d.time, d.what, d.recorded, d.units.empty() ? "" : " " + d.units,
      d.replayed);
  if (d.others) text += fmt::format("; {} more values of this row differ", d.others);
  return versions.empty() ? text : text + "\n" + versions;
}

ReplayResult VerifyReplay(const Episode& episode, const ReplayOptions& options) {
  if (!(options.tolerance >= 0)) {
    throw ArgumentError(fmt::format(
        "tolerance {} is not at least 0; 0 takes no difference for none", options.tolerance));
  }
  return Replay(episode, options).Run();
}

void PlayControls(const Episode& episode,
                  const std::function<bool(const Scene& scene, int64_t row)>& at_row) {
  Replay(episode, {}).Play(at_row);
}

}  // namespace robocell
