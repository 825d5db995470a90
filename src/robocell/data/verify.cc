#include "robocell/data/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <system_error>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/io_error.h"
#include "robocell/base/names.h"
#include "robocell/base/paths.h"
#include "robocell/base/real_file.h"
#include "robocell/data/dataset.h"
#include "robocell/data/dataset_lock.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_reader.h"
#include "robocell/data/episode_state.h"
#include "robocell/data/episode_writer.h"
#include "robocell/data/folder_names.h"
#include "robocell/data/json_count.h"
#include "robocell/data/leftovers.h"
#include "robocell/data/model_store.h"
#include "robocell/data/own_folders.h"
#include "robocell/data/quarantine.h"
#include "robocell/data/require_dataset.h"
#include "robocell/data/signed_json.h"
#include "robocell/media/video_info.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Checks one episode from the outside in: episode.json, the list of files, their bytes, then what
// they hold.
class EpisodeCheck {
 public:
  EpisodeCheck(fs::path folder, bool decode) : folder_(std::move(folder)), decode_(decode) {}

  std::vector<VerifyProblem> Run() {
    try {
      if (ReadDescription()) CheckEverything();
    } catch (const std::exception& error) {
      Report("", error.what());
    }
    return problems_;
  }

 private:
  void Report(const std::string& file, const std::string& reason) {
    problems_.push_back({folder_.filename().string(), file, reason});
  }

  // False if nothing else can be asked.
  bool ReadDescription() {
    const std::string file(kEpisodeFile);
    const std::string what = WhatIsAt(folder_ / file);
    if (what == "nothing") {
      Report(file, "it is missing: the episode was never finished, or it was removed");
      return false;
    }
    if (!CanReadFile(folder_ / file)) {
      Report(file, fmt::format("it is {}, not a file", what));
      return false;
    }
    const std::string text = ReadRealFile(folder_ / file);
    if (const auto damage = JsonDamage(text)) {
      Report(file, *damage);
      return false;
    }
    description_ = Json::parse(text);
    if (description_.value("id", "") != folder_.filename().string()) {
      Report(file, fmt::format("it describes episode '{}'", description_.value("id", "")));
    }
    return true;
  }

  void CheckEverything() {
    for (const auto& [name, facts] : description_.at("files").items()) CheckFile(name, facts);
    CheckNothingElse();
    if (problems_.empty()) CheckContents();
  }

  void CheckFile(const std::string& name, const Json& facts) {
    if (!ValidFileName(name))
      return Report(std::string(kEpisodeFile), "it lists a file '" + name + "'");
    const fs::path path = folder_ / name;
    const std::string what = WhatIsAt(path);
    if (what == "nothing") return Report(name, "it is missing");
    if (!CanReadFile(path)) return Report(name, fmt::format("it is {}, not a file", what));
    const auto expected = JsonCount<uint64_t>(facts.at("bytes"));
    const uint64_t size = fs::file_size(path);
    if (size < expected)
      return Report(name, fmt::format("it is cut short: {} of {} bytes are there", size, expected));
    if (size > expected)
      return Report(name, fmt::format("it has {} bytes, {} were written", size, expected));
    if (Sha256RealFile(path) != facts.at("sha256").get<std::string>()) {
      Report(name, "its bytes are not what was written: the hash does not fit");
    }
  }

  void CheckNothingElse() {
    for (const std::string& name : FolderNames(folder_)) {
      if (name == kEpisodeFile || description_.at("files").contains(name)) continue;
      Report(name, "it does not belong to the episode: episode.json does not list it");
    }
  }

  void CheckContents() {
    const Episode episode(folder_);
    for (const ColumnInfo& column : episode.columns()) {
      if (column.table.empty() || column.rows == episode.rows(column.table)) continue;
      Report(std::string(kStepsFile),
             fmt::format("column '{}' has {} rows, table '{}' {}", column.spec.name, column.rows,
                         column.table, episode.rows(column.table)));
    }
    for (const CameraInfo& camera : episode.cameras()) CheckCamera(episode, camera);
  }

  // `open` gives the reader of this video, which must hold one frame per row.
  template <class Open>
  void CheckVideo(const Episode& episode, const CameraInfo& camera, const std::string& file,
                  VideoKind kind, Open&& open) {
    try {
      const VideoInfo info = ReadVideoInfo(folder_ / file);
      const int64_t rows = episode.rows(camera.table);
      if (info.kind != kind) return Report(file, "it is a video of another kind");
      if (info.frames != rows)
        Report(file, fmt::format("it has {} frames for {} rows", info.frames, rows));
      if (decode_) Decode(open());
    } catch (const IoError& error) {
      Report(file, error.what());
    }
  }

  void CheckCamera(const Episode& episode, const CameraInfo& camera) {
    CheckVideo(episode, camera, camera.file, VideoKind::kColour,
               [&] { return episode.Video(camera.name); });
    if (camera.depth_file.empty()) return;
    CheckVideo(episode, camera, camera.depth_file, VideoKind::kDepth,
               [&] { return episode.DepthVideo(camera.name); });
  }

  static void Decode(VideoReader video) {
    if (video.info().kind == VideoKind::kDepth)
      DecodeAs<uint16_t>(video);
    else
      DecodeAs<uint8_t>(video);
  }

  template <class Pixel>
  static void DecodeAs(VideoReader& video) {
    std::vector<Pixel> frame(video.frame_bytes() / sizeof(Pixel));
    while (video.Next(frame)) {
    }
  }

  fs::path folder_;
  bool decode_;
  Json description_;
  std::vector<VerifyProblem> problems_;
};

std::string CountOfEpisodes(size_t count) {
  return fmt::format("{} episode{}", count, count == 1 ? "" : "s");
}

void CheckManifest(const fs::path& dataset, VerifyReport& report) {
  try {
    ReadManifest(dataset);
  } catch (const Error& error) {
    report.problems.push_back({"", std::string(kManifestFile), error.what()});
    report.bad_parts.emplace_back(kManifestFile);
  }
}

void CheckReport(const fs::path& dataset, const std::string& name, VerifyReport& report) {
  std::string reason;
  try {
    const auto damage = JsonDamage(ReadRealFile(dataset / name));
    if (!damage) return;
    reason = *damage;
  } catch (const Error& error) {
    reason = error.what();
  }
  report.problems.push_back({"", name, reason});
  report.bad_parts.push_back(name);
}

void CheckOwnFolders(const fs::path& dataset, VerifyReport& report) {
  for (const ForeignThing& thing : NotOwn(dataset)) {
    report.problems.push_back(
        {"", thing.name,
         fmt::format("it is {} that leads out of the dataset: remove it, repair leaves it alone",
                     thing.what)});
  }
}

// File -> reason; "" is the model as a whole.
std::map<std::string, std::string> DamageOfModel(const fs::path& dataset,
                                                 const std::string& model) {
  try {
    return DamageOfStoredModel(dataset, model);
  } catch (const Error& error) {
    return {{"", error.what()}};
  }
}

void CheckStoredModels(const fs::path& dataset, VerifyReport& report) {
  for (const std::string& model : StoredModels(dataset)) {
    const auto damage = DamageOfModel(dataset, model);
    for (const auto& [file, reason] : damage) {
      const fs::path place = file.empty() ? fs::path(model) : fs::path(model) / file;
      report.problems.push_back({"", place.string(), reason});
    }
    if (!damage.empty()) {
      report.bad_parts.push_back(model);
    } else if (!HasModelList(dataset, model)) {
      report.problems.push_back({"", model + "/" + std::string(kModelListFile),
                                 "it is missing; the model's files are what was stored, and "
                                 "`robocell verify --repair` lists them again"});
      report.unlisted.push_back(model);
    }
  }
}

// Models that good episodes were made in and that are not in the dataset.
void CheckMissingModels(const fs::path& dataset, VerifyReport& report) {
  std::map<std::string, size_t> missing;
  for (const std::string& id : report.good) {
    std::set<std::string> folders;
    for (const auto& [name, path] : Episode(dataset / id).models())
      folders.insert(StoredModelFolder(path));
    for (const std::string& folder : folders) {
      if (!fs::exists(dataset / folder)) ++missing[folder];
    }
  }
  for (const auto& [folder, episodes] : missing) {
    report.problems.push_back(
        {"", folder,
         fmt::format("it is missing; {} can be read, not replayed. `robocell generate` "
                     "with the run's file stores it again",
                     CountOfEpisodes(episodes))});
  }
}

}  // namespace

std::string VerifyProblem::Text() const {
  const std::string place = episode + (episode.empty() || file.empty() ? "" : "/") + file;
  return fmt::format("{}: {}", place, reason);
}

std::string VerifyReport::Text() const {
  std::string text;
  for (const VerifyProblem& problem : problems) text += problem.Text() + "\n";
  for (const std::string& name : leftovers)
    text += fmt::format("{}: unfinished, left behind by a crash\n", name);
  for (const std::string& name : being_written)
    text += fmt::format("{}: unfinished, a running process is writing it\n", name);
  if (!has_manifest && !good.empty())
    text +=
        "dataset.json: there is none; `robocell generate` with the run's file writes it again\n";
  return text + fmt::format("{} good, {} bad\n", CountOfEpisodes(good.size()), bad.size());
}

std::vector<VerifyProblem> VerifyEpisode(const fs::path& folder, bool decode_videos) {
  return EpisodeCheck(folder, decode_videos).Run();
}

VerifyReport Verify(const fs::path& dataset, const VerifyOptions& options) {
  RequireDataset(dataset);
  VerifyReport report;
  std::vector<std::string> episodes;
  for (const std::string& name : FolderNames(dataset)) {
    if (IsTemporaryName(name) || name == kManifestFile || name == kQuarantineFolder ||
        name == kModelsFolder || IsReportFile(name)) {
      continue;
    }
    if (IsEpisodeId(name) && fs::is_directory(dataset / name) && LooksLikeEpisode(dataset / name)) {
      episodes.push_back(name);
    } else {
      report.others.push_back(name);
    }
  }
  for (const std::string& name : UnfinishedIn(dataset))
    (IsBeingWritten(dataset / name) ? report.being_written : report.leftovers).push_back(name);
  report.has_manifest = fs::exists(dataset / kManifestFile);
  for (size_t i = 0; i < episodes.size(); ++i) {
    const auto problems = VerifyEpisode(dataset / episodes[i], options.decode_videos);
    (problems.empty() ? report.good : report.bad).push_back(episodes[i]);
    report.problems.insert(report.problems.end(), problems.begin(), problems.end());
    if (options.progress) options.progress(i + 1, episodes.size());
  }
  CheckManifest(dataset, report);
  for (const std::string& name : FolderNames(dataset)) {
    if (IsReportFile(name)) CheckReport(dataset, name, report);
  }
  CheckOwnFolders(dataset, report);
  CheckStoredModels(dataset, report);
  CheckMissingModels(dataset, report);
  return report;
}

RepairResult Repair(const fs::path& dataset, const VerifyOptions& options) {
  RequireDataset(dataset);  // before the lock's file is written
  const DatasetLock lock = DatasetLock::Alone(dataset);
  RepairResult result{.found = Verify(dataset, options), .remaining = {}, .moved = {}};
  const VerifyReport& found = result.found;
  for (const auto* names : {&found.bad, &found.bad_parts, &found.leftovers}) {
    for (const std::string& name : *names) {
      result.moved.push_back(Quarantine(dataset, name));
    }
  }
  for (const std::string& model : found.unlisted) WriteModelList(dataset, model);
  FsyncDirectory(dataset);
  VerifyReport after{.good = found.good};
  CheckManifest(dataset, after);
  CheckMissingModels(dataset, after);
  result.remaining = after.problems;
  return result;
}

}  // namespace robocell
