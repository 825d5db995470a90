#include "robocell/rollout/env_of_episode.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <utility>
#include <nlohmann/json.hpp>

#include "robocell/assets/model_files.h"
#include "robocell/assets/resolve.h"
#include "robocell/assets/scene_models.h"
#include "robocell/base/error.h"
#include "robocell/base/hash.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/units.h"
#include "robocell/data/model_store.h"
#include "robocell/features/cell_features.h"
#include "robocell/rollout/episode_reading.h"
#include "robocell/rollout/recorded_scene.h"
#include "robocell/rollout/registered_kinds.h"
#include "robocell/rollout/run_inputs.h"
#include "robocell/rollout/user_code.h"
#include "robocell/spec/pinned_values.h"
#include "robocell/spec/yaml.h"

namespace robocell {
namespace {

using Json = nlohmann::json;

std::string PlaceOfEpisode(const Episode& episode) {
  return fmt::format("episode '{}'", episode.folder().string());
}

internal::EpisodeJson EnvironmentOf(const Episode& episode) {
  if (IsOfEnv(episode)) return internal::EpisodeJson::Metadata(episode).At("environment");
  throw ArgumentError(
      fmt::format("{} was not recorded in an environment; generated ones are replayed by "
                  "VerifyReplay, and robocell.envs.from_dataset makes an environment of their run",
                  PlaceOfEpisode(episode)));
}

// Calls f(name, directory) for each model file of a configuration.
template <class F>
void ForEachModelOfEnv(EnvConfig& config, F&& f) {
  const std::string& directory = config.source_dir;
  const auto of_robot = [&](RobotConfig& robot) {
    const std::string& own = robot.source_dir.empty() ? directory : robot.source_dir;
    f(robot.model, own);
    for (auto& attachment : robot.attachments) f(attachment.mjcf_path, own);
    internal::ForEachCameraModel(robot.cameras, own, f);
  };
  const auto of_objects = [&](Map<EnvObject>& objects) {
    for (const std::string& id : objects.keys()) {
      if (!objects.at(id).shape) f(objects.at(id).mjcf_path, directory);
    }
  };
  f(config.scene, directory);
  for (const std::string& name : config.robots.keys()) of_robot(config.robots.at(name));
  for (const std::string& name : config.grippers.keys()) of_robot(config.grippers.at(name));
  of_objects(config.world_frame_objects);
  of_objects(config.root_frame_objects);
  for (const std::string& robot : config.robot_frame_objects.keys())
    of_objects(config.robot_frame_objects.at(robot));
  for (const std::string& name : config.camera_adds.keys()) {
    std::string& model = config.camera_adds.at(name).xml_path;
    if (!model.empty()) f(model, directory);
  }
  if (!config.alternative_combined_robot_mjcf.empty())
    f(config.alternative_combined_robot_mjcf, directory);
}

// Missing files are not simulated, like those of robots in a combined model.
std::string PortableOrOwnName(const std::string& name, const std::string& directory) {
  try {
    const std::string path = assets::Resolve(name, directory);
    if (const auto portable = assets::PortableName(path)) return *portable;
    return internal::StoredModelPath(internal::ModelFileSet(path));
  } catch (const Error&) {
    if (internal::IsStoredModelPath(name)) return name;  // set by EnvOfEpisode
    return std::filesystem::path(name).filename().string();
  }
}

// Writes the numbers of a pose as the equivalent pose that is nearest to another one.
void AlignPose(const Feature& feature, std::span<const double> with, std::span<double> pose) {
  const std::vector<std::string>& names = feature.column.names;
  if (!names.empty() && names.back() == "qw") {
    double dot = 0;
    for (size_t i = pose.size() - 4; i < pose.size(); ++i) dot += pose[i] * with[i];
    for (double& q : pose.last(4)) q = dot < 0 ? -q : q;
  }
  for (size_t i = 0; i < names.size(); ++i) {
    if (names[i] == "roll" || names[i] == "pitch" || names[i] == "yaw")
      pose[i] += 2 * internal::kPi * std::round((with[i] - pose[i]) / (2 * internal::kPi));
  }
}

// Returns columns of the features, row by row, in the layout of an environment's vectors.
std::vector<double> RowsOf(const Episode& episode, const FeatureSchema& features) {
  const auto rows = static_cast<size_t>(episode.rows()),
             width = static_cast<size_t>(features.size());
  std::vector<double> all;
  size_t begin = 0;
  for (const Feature& feature : features.features()) {
    const std::vector<double> column = internal::ReadSteps<double>(episode, feature.column.name);
    const auto size = static_cast<size_t>(feature.size());
    if (column.size() != rows * size) {
      throw IoError(fmt::format(
          "{}: column '{}' has {} a row, and its feature {}", PlaceOfEpisode(episode),
          feature.column.name, Counted(column.size() / std::max<size_t>(rows, 1), "number"), size));
    }
    all.resize(rows * width);  // after the number of rows was checked
    for (size_t row = 0; row < rows; ++row)
      std::copy_n(column.begin() + static_cast<std::ptrdiff_t>(row * size), size,
                  all.begin() + static_cast<std::ptrdiff_t>(row * width + begin));
    begin += size;
  }
  return all;
}

// Returns the local code files that differ from those of the episode.
std::vector<std::string> CodeDifferences(const EnvConfig& config, const Episode& episode) {
  std::set<std::string> hashes;
  if (const auto code = EnvironmentOf(episode).Find("code")) {
    for (const internal::EpisodeJson& file : code->Items())
      hashes.insert(file.At("sha256").AsText());
  }
  return internal::CodeOf(config).Unknown(hashes);
}

void RequireSameCode(const EnvConfig& config, const Episode& episode) {
  const std::vector<std::string> files = CodeDifferences(config, episode);
  if (files.empty()) return;
  throw SpecError(
      fmt::format("environment '{}': {} was recorded with other code than {}; restore these files, "
                  "or record again",
                  config.name, PlaceOfEpisode(episode), fmt::join(files, ", ")));
}

class ActionReplay {
 public:
  ActionReplay(Env& env, const Episode& episode, const EnvReplayOptions& options)
      : env_(env), episode_(episode), options_(options) {
    EnvironmentOf(episode);
    ChooseActions();
    RequireSameSchema();
    RequireSameCode(env.config(), episode);
    seen_ = RowsOf(episode, env.layout().observed);
    actions_ = RowsOf(episode, commanded_);
    rewards_ = internal::ReadSteps<double>(episode, "reward");
    times_ = internal::ReadSteps<double>(episode, "time");
    ticks_ = internal::ReadSteps<int64_t>(episode, std::string(kControlTickColumn));
    if (ticks_.empty()) {
      throw IoError(
          fmt::format("{} has no row: there is nothing to repeat", PlaceOfEpisode(episode)));
    }
    AddFinalObservation();
  }

  ReplayResult Run() {
    report_.episode = episode_.id();
    env_.SetState(EnvState::FromNumbers(episode_.Read<double>(std::string(kEnvStateColumn))),
                  options_.frame);
    if (!CompareObservation(0)) return report_;
    for (int64_t row = 0; row < episode_.rows(); ++row) {
      const auto at = static_cast<size_t>(row);
      const EnvStep step = Step(at);
      // An episode that diverged shows nothing after its last action.
      const bool is_shown = (at + 1) * SeenWidth() < seen_.size();
      if (step.reason != EndReason::kDiverged && is_shown && !CompareObservation(row + 1))
        return report_;
      if (!CompareStep(row, step)) return report_;
      report_.rows = row + 1;
      report_.ticks = row + 1 == episode_.rows() ? Ticks() : ticks_[at + 1];
    }
    return report_;
  }

 private:
  // Chooses the environment's own actions, or for an episode without them the absolute targets of
  // all groups.
  void ChooseActions() {
    const FeatureSchema& recorded = episode_.features();
    for (const Feature& feature : recorded.features())
      by_name_ = by_name_ && !feature.column.name.starts_with("action/");
    if (!by_name_) {
      commanded_ = env_.layout().commanded;
      return;
    }
    for (const Feature& feature : env_.features().commanded().features()) {
      if (recorded.Has(feature.column.name + "_relative")) commanded_.Add(feature);
    }
  }

  EnvStep Step(size_t row) {
    const auto width = static_cast<size_t>(commanded_.size());
    std::span<const double> numbers = std::span(actions_).subspan(row * width, width);
    if (!by_name_) return env_.Step(numbers, options_.poll);
    std::map<std::string, std::vector<double>> commands;
    for (const Feature& feature : commanded_.features()) {
      const auto size = static_cast<size_t>(feature.size());
      commands[feature.column.name].assign(numbers.begin(),
                                           numbers.begin() + static_cast<std::ptrdiff_t>(size));
      numbers = numbers.subspan(size);
    }
    return env_.Act(commands, options_.poll);
  }

  size_t SeenWidth() const { return static_cast<size_t>(env_.layout().observation.size()); }
  int64_t Ticks() const { return static_cast<int64_t>(episode_.ValueCount("control/time")); }

  void RequireSameSchema() const {
    const FeatureSchema& recorded = episode_.features();
    for (const FeatureSchema* own : {&env_.layout().observed, &env_.layout().commanded}) {
      if (by_name_ && own == &env_.layout().commanded) continue;
      FeatureSchema same;
      const std::string kind = own == &env_.layout().observed ? "observation/" : "action/";
      for (const Feature& feature : recorded.features()) {
        if (feature.column.name.starts_with(kind)) same.Add(feature);
      }
      const std::string difference = same.DifferenceFrom(*own, "recorded", "here");
      if (difference.empty()) continue;
      throw ArgumentError(fmt::format("environment '{}': {} is of another configuration: {}",
                                      env_.config().name, PlaceOfEpisode(episode_), difference));
    }
  }

  void AddFinalObservation() {
    const auto final = internal::EpisodeJson::Results(episode_).Find(kFinalObservation);
    if (!final) return;
    for (const Feature& feature : env_.layout().observed.features()) {
      const internal::EpisodeJson part = final->At(feature.column.name);
      const auto numbers = part.AsNumbers();
      if (std::ssize(numbers) != feature.size())
        part.ThrowNot("a list of " + Counted(feature.size(), "number"));
      seen_.insert(seen_.end(), numbers.begin(), numbers.end());
    }
  }

  bool CompareObservation(int64_t row) {
    std::span<const double> now = env_.observation();
    std::span<double> then = std::span(seen_).subspan(static_cast<size_t>(row) * SeenWidth());
    for (size_t part = 0; part < env_.layout().observed.features().size(); ++part) {
      const Feature& feature = env_.layout().observed.features()[part];
      const auto size = static_cast<size_t>(feature.size());
      if (options_.tolerance > 0) AlignPose(feature, now.first(size), then.first(size));
      for (size_t i = 0; i < size; ++i) {
        if (std::abs(now[i] - then[i]) <= options_.tolerance) continue;
        const std::string path =
            fmt::format("{}", fmt::join(env_.layout().observed_paths[part], "."));
        Differs(row, fmt::format("{}[{}]", path, i), feature.column.name, then[i], now[i]);
      }
      now = now.subspan(size);
      then = then.subspan(size);
    }
    return report_.ok();
  }

  bool CompareStep(int64_t row, const EnvStep& step) {
    const double recorded = rewards_[static_cast<size_t>(row)];
    const bool was_last = row + 1 == episode_.rows() && episode_.end_reason() == "diverged";
    if (step.reason == EndReason::kDiverged && !was_last)
      Differs(row, "the replay " + step.message, "reward", recorded, step.reward);
    else if (!(std::abs(step.reward - recorded) <= options_.tolerance))
      Differs(row, "the reward", "reward", recorded, step.reward);
    return report_.ok();
  }

  void Differs(int64_t row, const std::string& what, const std::string& column, double recorded,
               double replayed) {
    if (report_.first) {
      ++report_.first->others;
      return;
    }
    const auto at = static_cast<size_t>(row);
    const bool is_last = at == times_.size();
    const double end = times_.back();
    report_.first = {.row = row,
                     .tick = is_last ? Ticks() : ticks_[at],
                     .time = is_last ? end : times_[at],
                     .what = what,
                     .column = column,
                     .recorded = recorded,
                     .replayed = replayed,
                     .units = {}};
  }

  Env& env_;
  const Episode& episode_;
  const EnvReplayOptions& options_;
  bool by_name_ = true;  // the actions are commands by name
  FeatureSchema commanded_;
  std::vector<double> seen_, actions_, rewards_, times_;
  std::vector<int64_t> ticks_;
  ReplayResult report_;
};

}  // namespace

bool IsOfEnv(const Episode& episode) {
  const auto environment = internal::EpisodeJson::Metadata(episode).Find("environment");
  return environment && environment->Find("config");
}

std::string PortableConfig(const EnvConfig& config) {
  EnvConfig portable = config;
  ForEachModelOfEnv(portable, [](std::string& name, const std::string& directory) {
    name = PortableOrOwnName(name, directory);
  });
  return ToYaml(portable);
}

Json CodeRecord(const EnvConfig& config) {
  Json record = Json::array();
  const internal::UserCode code = internal::CodeOf(config);
  for (const std::filesystem::path& file : code.files())
    record.push_back({{"file", file.filename().string()}, {"sha256", Sha256File(file)}});
  return record;
}

std::vector<std::string> DifferencesFromEpisode(const EnvConfig& config, const Episode& episode) {
  const auto identity = [](const std::string& portable) {
    auto same = FromYamlUnchecked<EnvConfig>(portable);
    same.sim.realtime = same.headless = false;
    return RunInputs{.identity = ToYaml(same), .versions = {}, .files = {}};
  };
  std::vector<std::string> lines = LinesOf(Differences(
      identity(EnvironmentOf(episode).At("config").AsText()), identity(PortableConfig(config))));
  for (const std::string& file : CodeDifferences(config, episode))
    lines.push_back(fmt::format("code file {}: not the recorded one", file));
  return lines;
}

std::unique_ptr<Env> EnvOfEpisode(const Episode& episode, bool images, const DataFactory& factory) {
  const internal::EpisodeJson recorded = EnvironmentOf(episode).At("config");
  const std::vector<std::string> unknown = internal::UnregisteredKinds(recorded.AsText());
  if (!unknown.empty()) {
    throw NotFoundError(fmt::format("the environment that recorded '{}': {}",
                                    episode.folder().string(), fmt::join(unknown, "; ")));
  }
  auto config = recorded.AsSpec<EnvConfig>();
  config.sim.realtime = false;
  config.headless = true;
  if (!images && !config.cameras.streams.empty()) config.cameras.draw = false;
  // Looks are drawn from streams of their own, so that nothing else changes without them, and files
  // of textures need not be here.
  if (!images && config.randomize) {
    config.randomize->appearance.clear();
    std::erase_if(config.randomize->pinned.entries(),
                  [](const auto& entry) { return internal::IsLookName(entry.first); });
  }
  RequireSameCode(config, episode);  // before any of it runs
  return std::make_unique<Env>(std::move(config), Scene::Build(RecordedScene(episode), factory));
}

ReplayResult ReplayActions(Env& env, const Episode& episode, const EnvReplayOptions& options) {
  if (!(options.tolerance >= 0)) {
    throw ArgumentError(fmt::format(
        "tolerance {} is not at least 0; 0 takes no difference for none", options.tolerance));
  }
  return ActionReplay(env, episode, options).Run();
}

}  // namespace robocell
