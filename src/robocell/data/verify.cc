#include "robocell/data/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <system_error>
#include <nlohmann/json.hpp>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/io_error.h"
#include "robocell/base/packed_index.h"
#include "robocell/base/real_file.h"
#include "robocell/base/suggestions.h"
#include "robocell/data/dataset.h"
#include "robocell/data/dataset_folder.h"
#include "robocell/data/dataset_lock.h"
#include "robocell/data/dataset_reports.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_reader.h"
#include "robocell/data/episode_state.h"
#include "robocell/data/episode_verifier.h"
#include "robocell/data/episode_writer.h"
#include "robocell/data/leftovers.h"
#include "robocell/data/model_store.h"
#include "robocell/data/packed_verifier.h"
#include "robocell/media/ffmpeg.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
std::string CountOfEpisodes(size_t count) {
  return fmt::format("{} episode{}", count, count == 1 ? "" : "s");
}

// Returns how advice to write into the dataset begins: nothing is written into a packed one.
std::string_view UnpackFirst(const fs::path& dataset) {
  return internal::IsPacked(dataset) ? "After `robocell unpack`, " : "";
}

// Adds a problem of the dataset itself; damaged parts can be set aside.
void AddPart(const std::string& name, const std::string& reason, ProblemKind kind,
             VerifyResult& result) {
  result.problems.push_back({"", name, reason, kind});
  if (kind == ProblemKind::kDamage) result.bad_parts.push_back(name);
}

void VerifyManifest(const fs::path& dataset, VerifyResult& result) {
  try {
    ReadManifest(dataset);
  } catch (const Error& error) {
    AddPart(std::string(kManifestFile), error.what(), KindOf(error), result);
  }
}

void VerifyReportFile(const fs::path& dataset, const std::string& name, VerifyResult& result) {
  try {
    const std::string text = internal::ReadRealFile(dataset / name);
    if (const auto damage = JsonDamage(text))
      return AddPart(name, *damage, ProblemKind::kDamage, result);
    const auto other = OtherRunOf(text, dataset);
    if (!other) return;
    AddPart(name, fmt::format("it belongs to another run ('{}') and does not count", *other),
            ProblemKind::kForeign, result);
    result.foreign.push_back(name);
  } catch (const Error& error) {
    AddPart(name, error.what(), KindOf(error), result);
  }
}

void AddEpisode(const std::string& id, const std::vector<VerifyProblem>& problems,
                VerifyResult& result) {
  const auto has = [&](ProblemKind kind) {
    return std::any_of(problems.begin(), problems.end(),
                       [&](const VerifyProblem& problem) { return problem.kind == kind; });
  };
  if (has(ProblemKind::kDamage))
    result.bad.push_back(id);
  else if (has(ProblemKind::kUnreadable))
    result.unjudged.push_back(id);
  else
    result.good.push_back(id);
  for (const VerifyProblem& problem : problems) {
    if (problem.kind == ProblemKind::kForeign && !has(ProblemKind::kDamage))
      result.foreign.push_back(id + "/" + problem.file);
    result.problems.push_back(problem);
  }
}

// A user's own sampler brings models that the run does not list.
bool HasOwnSampler(const Episode& episode) {
  const auto metadata = nlohmann::json::parse(episode.metadata_json());
  return metadata.is_object() && metadata.contains("task") && metadata.at("task") == "custom";
}

// An intact episode that was made after a model file was changed, here or elsewhere.
void VerifyModelsOf(const fs::path& folder, const std::map<std::string, std::string>& changed,
                    std::vector<VerifyProblem>& problems) {
  if (changed.empty() || !problems.empty()) return;
  const Episode episode(folder);
  if (HasOwnSampler(episode)) return;
  for (const auto& [name, path] : episode.models()) {
    const auto it = changed.find(internal::StoredModelFolder(path));
    if (it == changed.end()) continue;
    problems.push_back(
        {episode.id(), "",
         fmt::format("it was made with another '{}' ({}) than the one that dataset.json lists: the "
                     "file was changed while the run went on, or the episode was copied from "
                     "another dataset. {}`robocell verify --repair` sets it aside, `robocell "
                     "generate` makes it again",
                     it->second, it->first, UnpackFirst(folder.parent_path()))});
    return;
  }
}

void VerifyOwnFolders(const fs::path& dataset, VerifyResult& result) {
  for (const ForeignEntry& entry : NotOwn(dataset)) {
    result.problems.push_back(
        {"", entry.name,
         fmt::format("it is {} that leads out of the dataset: remove it, repair leaves it alone",
                     entry.what)});
  }
}

void VerifyStoredModel(const fs::path& dataset, const std::string& model, VerifyResult& result) {
  const auto damage = internal::DamageOfStoredModel(dataset, model);
  for (const auto& [file, reason] : damage) {
    const fs::path place = file.empty() ? fs::path(model) : fs::path(model) / file;
    result.problems.push_back({"", place.string(), reason});
  }
  if (!damage.empty()) return result.bad_parts.push_back(model);
  // That of a packed dataset is one of its files, which are compared later.
  if (internal::HasModelList(dataset, model) || internal::IsPacked(dataset)) return;
  result.problems.push_back({"", model + "/" + std::string(internal::kModelListFile),
                             "it is missing or damaged; the model's files are intact, and "
                             "`robocell verify --repair` lists them again"});
  result.unlisted.push_back(model);
}

// Returns false if the folder of models is closed to this user, or cannot be read: then the models
// are unknown.
bool CanLookAtModels(const fs::path& dataset, VerifyResult& result) {
  try {
    internal::StoredModels(dataset);
    return true;
  } catch (const Error& error) {
    AddPart(std::string(kModelsFolder), error.what(), KindOf(error), result);
    return false;
  }
}

void VerifyStoredModels(const fs::path& dataset, VerifyResult& result) {
  for (const std::string& model : internal::StoredModels(dataset)) {
    try {
      VerifyStoredModel(dataset, model, result);
    } catch (const Error& error) {
      AddPart(model, error.what(), KindOf(error), result);
    }
  }
  const internal::StrayModels stray = internal::StrayModelsIn(dataset);
  for (const std::string& name : stray.blocking) {
    AddPart(name,
            fmt::format("it has the name of a model and is {}", internal::WhatIsAt(dataset / name)),
            ProblemKind::kForeign, result);
    result.foreign.push_back(name);
  }
  result.others.insert(result.others.end(), stray.others.begin(), stray.others.end());
}

void VerifyLostEpisodes(const fs::path& dataset, VerifyResult& result) {
  std::vector<std::string> lost;
  try {
    lost = LostEpisodes(dataset);
  } catch (const Error& error) {  // the quarantine cannot be read
    AddPart(std::string(kQuarantineFolder), error.what(), KindOf(error), result);
  }
  for (const std::string& id : lost)
    result.problems.push_back(
        {id, "",
         fmt::format("a report says that it was made, and it is gone. {}`robocell generate` with "
                     "the run's file makes it again",
                     UnpackFirst(dataset))});
}

bool IsOfPack(const std::string& name, const internal::PackedIndex& packed) {
  return name == internal::kPackedFile || packed.files.contains(name) ||
         std::ranges::any_of(packed.shards, [&](const auto& shard) { return shard.file == name; });
}

void VerifyPackedFiles(const fs::path& dataset, const internal::PackedIndex& packed,
                       VerifyResult& result) {
  internal::VerifyPack(
      dataset, packed,
      [&](const std::string& file, const std::string& reason, const std::exception* error) {
        const bool known = std::ranges::any_of(result.problems, [&](const VerifyProblem& problem) {
          return problem.episode.empty() && problem.file == file;
        });
        if (!known)
          result.problems.push_back(
              {"", file, reason, error ? KindOf(*error) : ProblemKind::kDamage});
      });
}

// Finds models that good episodes were made in and that are not in the dataset.
void VerifyMissingModels(const fs::path& dataset, VerifyResult& result) {
  std::map<std::string, size_t> missing;
  for (const std::string& id : result.good) {
    std::set<std::string> folders;
    for (const auto& [name, path] : Episode(dataset / id).models())
      folders.insert(internal::StoredModelFolder(path));
    for (const std::string& folder : folders) {
      if (!internal::IsStored(dataset, folder)) ++missing[folder];
    }
  }
  for (const auto& [folder, episodes] : missing) {
    result.problems.push_back(
        {"", folder,
         fmt::format("it is missing; {} can be read, not replayed. {}`robocell generate` "
                     "with the run's file stores it again",
                     CountOfEpisodes(episodes), UnpackFirst(dataset))});
  }
}

}  // namespace

std::string VerifyResult::Text() const {
  std::string text;
  for (const VerifyProblem& problem : problems) text += problem.Text() + "\n";
  for (const std::string& name : leftovers)
    text += fmt::format("{}: unfinished, left behind by a crash\n", name);
  for (const std::string& name : being_written)
    text += fmt::format("{}: unfinished, a running process is writing it\n", name);
  if (lost_manifest)
    text +=
        "dataset.json: there is none; `robocell generate` with the run's file writes it again\n";
  text += fmt::format("{} intact, {} damaged", CountOfEpisodes(good.size()), bad.size());
  if (!unjudged.empty())
    text += fmt::format(", {} not judged: they may be intact, and repair leaves them alone",
                        unjudged.size());
  return text + "\n";
}

bool VerifyResult::only_unreadable() const {
  return !ok() && std::all_of(problems.begin(), problems.end(), [](const VerifyProblem& problem) {
    return problem.kind == ProblemKind::kUnreadable;
  });
}

namespace {

// Returns true if the episode names its run; recordings of environments and of other programs do
// not.
bool IsOfARun(const fs::path& episode) {
  const auto metadata = nlohmann::json::parse(Episode(episode).metadata_json(), nullptr, false);
  return metadata.is_object() && metadata.contains("identity");
}

}  // namespace

VerifyResult Verify(const fs::path& dataset, const VerifyOptions& options) {
  RequireDataset(dataset);
  const auto packed = internal::PackedIndexOf(dataset);
  if (options.decode_videos) FindFfmpeg();  // once, and not as a problem of every episode
  VerifyResult result;
  std::vector<std::string> episodes = packed ? packed->episodes : std::vector<std::string>();
  for (const std::string& name : FolderNames(dataset)) {
    if (packed && IsOfPack(name, *packed)) continue;
    if (IsTemporaryName(name) || name == kManifestFile || name == kQuarantineFolder ||
        name == kModelsFolder || IsReportFile(name)) {
      continue;
    }
    if (!packed && internal::IsEpisodeFolder(dataset / name)) {
      episodes.push_back(name);
    } else {
      result.others.push_back(name);
    }
  }
  for (const std::string& name : UnfinishedIn(dataset))
    (IsBeingWritten(dataset / name) ? result.being_written : result.leftovers).push_back(name);
  const std::map<std::string, std::string> changed = internal::ChangedModels(dataset);
  internal::EpisodeVerifier verifier(options.decode_videos);
  for (size_t i = 0; i < episodes.size(); ++i) {
    const fs::path folder = dataset / episodes[i];
    std::vector<VerifyProblem> problems = verifier.Verify(folder);
    VerifyModelsOf(folder, changed, problems);
    AddEpisode(episodes[i], problems, result);
    if (options.progress) options.progress(i + 1, episodes.size());
  }
  result.lost_manifest =
      !fs::exists(dataset / kManifestFile) &&
      std::ranges::any_of(result.good, [&](const auto& id) { return IsOfARun(dataset / id); });
  VerifyManifest(dataset, result);
  for (const std::string& name : FolderNames(dataset)) {
    if (IsReportFile(name)) VerifyReportFile(dataset, name, result);
  }
  VerifyOwnFolders(dataset, result);
  if (CanLookAtModels(dataset, result)) {
    VerifyStoredModels(dataset, result);
    VerifyMissingModels(dataset, result);
  }
  VerifyLostEpisodes(dataset, result);
  if (packed) VerifyPackedFiles(dataset, *packed, result);
  return result;
}

RepairResult Repair(const fs::path& dataset, const VerifyOptions& options) {
  RequireDataset(dataset);  // before the lock's file is written
  internal::RequireNotPacked(dataset, "set damaged parts aside");
  const DatasetLock lock = DatasetLock::Alone(dataset);
  RepairResult result{.found = Verify(dataset, options), .remaining = {}, .moved = {}};
  const VerifyResult& found = result.found;
  for (const auto* names : {&found.bad, &found.foreign, &found.bad_parts, &found.leftovers}) {
    for (const std::string& name : *names) {
      result.moved.push_back(Quarantine(dataset, name));
    }
  }
  for (const std::string& model : found.unlisted) {
    const std::string list = model + "/" + std::string(internal::kModelListFile);
    if (internal::WhatIsAt(dataset / list) != "nothing")
      result.moved.push_back(Quarantine(dataset, list));
    internal::WriteModelList(dataset, model);
  }
  FsyncDirectory(dataset);
  VerifyResult after{.good = found.good};
  VerifyManifest(dataset, after);
  if (CanLookAtModels(dataset, after)) VerifyMissingModels(dataset, after);
  VerifyLostEpisodes(dataset, after);
  std::erase_if(after.problems, [](const VerifyProblem& problem) {  // already found
    return problem.kind == ProblemKind::kUnreadable;
  });
  result.remaining = after.problems;
  for (const VerifyProblem& problem : found.problems) {
    if (problem.kind == ProblemKind::kUnreadable) result.remaining.push_back(problem);
  }
  return result;
}

std::string VerifyProblem::Text() const {
  const std::string place = episode + (episode.empty() || file.empty() ? "" : "/") + file;
  return fmt::format("{}: {}", place, reason);
}

ProblemKind KindOf(const std::exception& error) {
  const auto* io = dynamic_cast<const IoError*>(&error);
  return io != nullptr && io->system_error() != 0 ? ProblemKind::kUnreadable : ProblemKind::kDamage;
}

}  // namespace robocell
