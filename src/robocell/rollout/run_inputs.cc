#include "robocell/rollout/run_inputs.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robocell/assets/model_files.h"
#include "robocell/assets/resolve.h"
#include "robocell/assets/scene_models.h"
#include "robocell/base/error.h"
#include "robocell/base/file_set.h"
#include "robocell/base/hash.h"
#include "robocell/base/rng.h"
#include "robocell/base/stored_file.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/version.h"
#include "robocell/expert/expert_kind.h"
#include "robocell/features/own_features.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/source_demos.h"
#include "robocell/rollout/user_code.h"
#include "robocell/scenes/catalogue.h"
#include "robocell/scenes/randomization.h"
#include "robocell/scenes/scene_source.h"
#include "robocell/task/sampler_kind.h"
#include "robocell/task/task_kind.h"

namespace robocell {
namespace {

using Texts = std::map<std::string, std::string>;

namespace fs = std::filesystem;

const std::string kSources = "source/";    // names of the files of source episodes begin so
const std::string kTextures = "texture/";  // and those of images that looks are drawn from

// Returns the user's code that defines the run's task, expert, scenes, sampler and features.
internal::UserCode CodeOf(const RunConfig& run, bool with_expert) {
  internal::UserCode code;
  const std::shared_ptr<const TaskKind> task = FindTaskKind(run.task.kind());
  code.AddKind(*task);
  const std::string expert = NameOfExpert(run);
  if (with_expert && !expert.empty()) code.AddKind(*FindExpertKind(expert));
  code.Add(CodeOfFeatures(run.features.names));
  code.AddKind(*FindSceneSourceKind(run.scenes.kind()));
  if (!run.sampler.empty()) code.AddKind(*FindSamplerKind(run.sampler));
  return code;
}

// Returns the paths of the images that looks are drawn from.
std::vector<fs::path> TexturesOf(const RunConfig& run) {
  std::vector<fs::path> files;
  if (!run.randomize) return files;
  for (const std::string& file :
       internal::TextureFiles(*run.randomize, run.source_dir, "run '" + run.run + "'"))
    files.push_back(fs::absolute(file).lexically_normal());
  return files;
}

// The source episodes of `augment` may be in a packed dataset.
std::string HashOf(const fs::path& path) {
  return PartAt(path) ? internal::Sha256StoredFile(path) : HashOfFile(path);
}

// Names begin with the model's folder, so they are the same on every machine. Files with equal
// names are numbered in the order in which the run uses them.
std::map<std::string, fs::path> FilesOf(const RunConfig& run) {
  std::map<std::string, fs::path> named;
  const auto add = [&](const std::string& name, const fs::path& file) {
    std::string own = name;
    for (int i = 2; !named.try_emplace(own, file).second && named.at(own) != file; ++i)
      own = fmt::format("{} ({})", name, i);
  };
  for (const std::string& model : ModelsOf(run)) {
    const fs::path folder = fs::absolute(model).lexically_normal().parent_path();
    for (const fs::path& file : internal::FindModelFiles(model).files) {
      const fs::path inside = folder.filename() / file.lexically_relative(folder);
      add(inside.lexically_normal().generic_string(), file);
    }
  }
  const std::shared_ptr<SceneSource> source = MakeSceneSource(run);
  for (const int scene : SceneIndices(run)) {
    for (const fs::path& file : source->AnnotationFiles(scene)) {
      const fs::path whole = fs::absolute(file).lexically_normal();
      add((whole.parent_path().filename() / whole.filename()).generic_string(), whole);
    }
  }
  for (const fs::path& file : TexturesOf(run))
    add(kTextures + (file.parent_path().filename() / file.filename()).generic_string(), file);
  const internal::UserCode code = CodeOf(run, true);
  for (const fs::path& file : code.files()) add("code/" + file.filename().string(), file);
  if (run.augment) {
    const fs::path sources = fs::absolute(run.augment->dataset).lexically_normal();
    // Each has the hashes of the episode's other files.
    for (const std::string& id : internal::SourceIds(*run.augment))
      add(kSources + id + "/episode.json", sources / id / "episode.json");
  }
  return named;
}

// Returns "assets/hand.stl" for "rc7/assets/hand.stl".
std::string WithinItsFolder(const std::string& name) { return name.substr(name.find('/') + 1); }

// A model in a renamed folder is still the same: drops each pair of files that differ only by that.
void DropMoved(Texts& then, Texts& now) {
  std::map<std::pair<std::string, std::string>, std::vector<std::string>> gone;
  for (const auto& [name, hash] : then) {
    if (!now.contains(name)) gone[{WithinItsFolder(name), hash}].push_back(name);
  }
  const Texts all = now;
  for (const auto& [name, hash] : all) {
    const auto it = gone.find({WithinItsFolder(name), hash});
    if (then.contains(name) || it == gone.end() || it->second.empty()) continue;
    then.erase(it->second.back());
    it->second.pop_back();
    now.erase(name);
  }
}

// Collects the leaves of a tree by their dotted paths; a list of plain values is one leaf.
void Flatten(const YAML::Node& node, const std::string& path, Texts& out) {
  if (node.IsMap()) {
    for (const auto& entry : node) {
      const std::string& key = entry.first.Scalar();
      Flatten(entry.second, path.empty() ? key : fmt::format("{}.{}", path, key), out);
    }
    return;
  }
  bool plain = true;
  for (const auto& item : node) plain &= !node.IsSequence() || item.IsScalar();
  if (node.IsSequence() && !plain) {
    for (size_t i = 0; i < node.size(); ++i) Flatten(node[i], fmt::format("{}[{}]", path, i), out);
    return;
  }
  YAML::Emitter text;
  text << YAML::Flow << node;
  out[path] = text.c_str();
}

Texts Leaves(const std::string& identity) {
  Texts leaves;
  try {
    Flatten(YAML::Load(identity), "", leaves);
  } catch (const YAML::Exception&) {
    leaves["identity"] = identity;  // another format: all of it differs
  }
  return leaves;
}

// Calls f(key, old, new) where they differ, in the order of the keys; null for a missing value.
template <class F>
void ForEachDifference(const Texts& then, const Texts& now, F&& f) {
  Texts keys = then;
  keys.insert(now.begin(), now.end());
  for (const auto& [key, text] : keys) {
    const auto a = then.find(key), b = now.find(key);
    if (a != then.end() && b != now.end() && a->second == b->second) continue;
    f(key, a == then.end() ? nullptr : &a->second, b == now.end() ? nullptr : &b->second);
  }
}

constexpr size_t kShownFiles = 3;

// Returns "model file rc7/rc7.xml" for the name of a file.
std::string WordsFor(const std::string& name) {
  if (name.starts_with("code/")) return "code file " + name.substr(5);
  if (name.starts_with(kSources)) return "source episode " + name.substr(kSources.size());
  if (name.starts_with(kTextures)) return "texture file " + name.substr(kTextures.size());
  return "model file " + name;
}

bool IsUnchanged(const std::filesystem::path& path, const std::string& hash) {
  try {
    return HashOf(path) == hash;
  } catch (const IoError&) {  // the file is gone
    return false;
  }
}

}  // namespace

std::vector<std::string> ModelsOf(const RunConfig& run) {
  std::vector<std::string> paths;
  const auto add = [&](const SceneSpec& scene) {
    internal::ForEachModel(scene, [&](const std::string& name, const std::string& directory) {
      paths.push_back(assets::Resolve(name, directory));
    });
  };
  SceneSpec contents;
  contents.robots.push_back({.config = run.robot.config});
  for (const SceneObject& object : FindTaskKind(run.task.kind())->Contents(run))
    contents.objects.push_back(object);
  for (const std::string& kind :
       run.randomize ? internal::ClutterKinds(*run.randomize) : std::vector<std::string>()) {
    Rng any = Rng::Stream(0, "clutter");
    contents.objects.push_back(MakeCatalogueObject(kind, kind, any));
  }
  add(contents);
  const std::shared_ptr<SceneSource> source = MakeSceneSource(run);
  for (const int scene : SceneIndices(run)) add(MakeBaseScene(run, *source, scene));
  return paths;
}

std::map<std::string, std::string> VersionsNow() {
  return {{"robocell", std::string(Version())}, {"mujoco", mj_versionString()}};
}

RunInputs InputsOf(const RunConfig& run) {
  RunInputs inputs{.identity = RunIdentity(run), .versions = VersionsNow(), .files = {}};
  inputs.paths = FilesOf(run);
  for (const auto& [name, path] : inputs.paths) inputs.files[name] = HashOf(path);
  return inputs;
}

std::vector<std::string> CodeChanges(const RunInputs& then, const RunConfig& run) {
  std::set<std::string> known;
  for (const auto& [name, hash] : then.files) {
    if (name.starts_with("code/")) known.insert(hash);
  }
  return CodeOf(run, false).Unknown(known);
}

std::vector<std::string> LinesOf(const std::vector<InputDifference>& differences) {
  std::vector<std::string> lines;
  for (const InputDifference& difference : differences) lines.push_back(difference.text);
  return lines;
}

std::vector<InputDifference> Differences(const RunInputs& then, const RunInputs& now) {
  std::vector<InputDifference> found;
  const auto both = [&](const std::string& key, const std::string* a, const std::string* b) {
    found.push_back(
        {fmt::format("{}: {} then, {} now", key, a ? *a : "not set", b ? *b : "not set"), key});
  };
  if (then.identity != now.identity)  // parsing takes milliseconds, for every episode
    ForEachDifference(Leaves(then.identity), Leaves(now.identity), both);
  ForEachDifference(then.versions, now.versions, both);
  Texts files_then = then.files, files_now = now.files;
  DropMoved(files_then, files_now);
  ForEachDifference(files_then, files_now,
                    [&](const std::string& key, const std::string* a, const std::string* b) {
                      const char* how = !a   ? "new since then"
                                        : !b ? "no longer used or gone"
                                             : "changed since then";
                      found.push_back({fmt::format("{}: {}", WordsFor(key), how)});
                    });
  return found;
}

void RunFilesWatch::RequireUnchanged(const RunConfig& run) const {
  std::vector<std::string> changed;
  for (const auto& [name, path] : inputs_.paths) {
    if (!IsUnchanged(path, inputs_.files.at(name))) changed.push_back("'" + path.string() + "'");
  }
  if (changed.empty() && !inputs_.paths.empty()) {
    // A new file in a folder of textures is another choice.
    for (const fs::path& file : TexturesOf(run)) {
      const bool is_known =
          std::ranges::any_of(inputs_.paths, [&](const auto& each) { return each.second == file; });
      if (!is_known) changed.push_back("'" + file.string() + "'");
    }
  }
  if (changed.empty()) return;
  throw IoError(fmt::format(
      "run '{}': {} changed during the run into the dataset '{}': episodes made with it are "
      "discarded. Restore it and repeat the command, or give another `output` to start a new "
      "dataset",
      run.run, ListNames(changed, kShownFiles), run.output));
}

}  // namespace robocell
