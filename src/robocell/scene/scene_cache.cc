// One file per scene: a line with the fingerprint of the rest, a line of JSON (the decisions made
// while compiling), then the engine's binary. SHA-256 of models and entries would take most of the
// time of a cached scene; the files are the user's own.
#include "robocell/scene/scene_cache.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/assets/model_files.h"
#include "robocell/assets/resolve.h"
#include "robocell/assets/roots.h"
#include "robocell/assets/scene_models.h"
#include "robocell/base/cache_folder.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/base/hash.h"
#include "robocell/base/log.h"
#include "robocell/base/version.h"
#include "robocell/mujoco/compile.h"
#include "robocell/scene/add_robot.h"
#include "robocell/scene/compiled_scene.h"
#include "robocell/spec/spec_bytes.h"

namespace robocell {
namespace {

// The records of a CompiledScene as JSON, without the values in the spec.

using nlohmann::json;

json Or(const std::optional<std::string>& text) { return text ? json(*text) : json(nullptr); }

std::optional<std::string> Optional(const json& value) {
  if (value.is_null()) return std::nullopt;
  return value.get<std::string>();
}

json ToJson(const std::vector<RobotRecord>& robots) {
  json all = json::array();
  for (const RobotRecord& robot : robots) {
    all.push_back({{"name", robot.name},
                   {"base_kind", static_cast<int>(robot.base.kind)},
                   {"top_body", robot.top_body},
                   {"root_body", robot.root_body},
                   {"mocap_body", Or(robot.mocap_body)},
                   {"pedestal_height", robot.pedestal_height},
                   {"attachment_site", Or(robot.attachment_site)},
                   {"tcp_site", Or(robot.tcp_site)},
                   {"base_body", robot.base_body}});
  }
  return all;
}

json ToJson(const std::vector<ObjectRecord>& objects) {
  json all = json::array();
  for (const ObjectRecord& object : objects) {
    all.push_back({{"name", object.name},
                   {"root_body", object.root_body},
                   {"free_joint", Or(object.free_joint)}});
    if (!object.pool) continue;
    all.back()["pool"] = {{"parked", object.pool->parked},
                          {"contype", object.pool->contype},
                          {"conaffinity", object.pool->conaffinity},
                          {"gravcomp", object.pool->gravcomp}};
  }
  return all;
}

std::vector<RobotRecord> RobotsFromJson(const SceneSpec& spec, const json& robots) {
  std::vector<RobotRecord> records;
  for (size_t i = 0; i < robots.size(); ++i) {
    const json& stored = robots[i];
    RobotRecord record = internal::RecordOf(spec.robots[i], stored.at("name"));
    record.base.kind = static_cast<BaseKind>(stored.at("base_kind").get<int>());
    record.top_body = stored.at("top_body");
    record.root_body = stored.at("root_body");
    record.mocap_body = Optional(stored.at("mocap_body"));
    record.pedestal_height = stored.at("pedestal_height");
    record.attachment_site = Optional(stored.at("attachment_site"));
    record.tcp_site = Optional(stored.at("tcp_site"));
    record.base_body = stored.at("base_body");
    records.push_back(std::move(record));
  }
  return records;
}

std::vector<ObjectRecord> ObjectsFromJson(const json& objects) {
  std::vector<ObjectRecord> records;
  for (const json& stored : objects) {
    records.push_back({.name = stored.at("name"),
                       .root_body = stored.at("root_body"),
                       .free_joint = Optional(stored.at("free_joint"))});
    if (!stored.contains("pool")) continue;
    const json& pool = stored.at("pool");
    records.back().pool = PoolRecord{.parked = pool.at("parked"),
                                     .contype = pool.at("contype"),
                                     .conaffinity = pool.at("conaffinity"),
                                     .gravcomp = pool.at("gravcomp")};
  }
  return records;
}

namespace fs = std::filesystem;

constexpr const char* kSuffix = ".scene";
// Changes whenever the same spec compiles to another model than before.
constexpr const char* kLayout = "9";

// Unset if the entry is missing, another process has just pruned it, or it cannot be read. (Copied,
// not mapped: a disk that fails or a machine that prunes a shared folder would end the process.)
std::optional<std::string> ReadEntry(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return std::nullopt;
  internal::MarkUsed(file);
  try {
    return ReadFile(file);
  } catch (const IoError&) {
    return std::nullopt;
  }
}

// Removes the first line from a text and returns it; all of a text with one line.
std::string_view CutLine(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  text.remove_prefix(std::min(line.size() + 1, text.size()));
  return line;
}

// Returns "r.yaml" for "r.yaml:7:73".
fs::path FileAt(const Locations& locations) {
  std::string place = locations.At();
  for (int i = 0; i < 2; ++i) place.resize(std::min(place.size(), place.rfind(':')));
  return place;
}

// Returns the files that warnings may name, with the content of those whose lines they name: with
// other content the warnings would point to wrong lines.
std::string PlacesOf(SceneSpec spec) {
  std::string places;
  internal::ForEachModel(spec, [&](const std::string& name, const std::string& directory) {
    places += assets::Resolve(name, directory) + "\n";
  });
  const auto add = [&](const Locations& locations) {
    const fs::path file = FileAt(locations);
    std::error_code error;
    places += fs::absolute(file, error).string() + "\n";
    if (fs::is_regular_file(file, error)) places += FingerprintFile(file) + "\n";
  };
  add(spec.locations);
  for (const RobotSpec& robot : spec.robots) {
    if (robot.config) add(robot.config->locations);
  }
  return Fingerprint(places);
}

}  // namespace

// Converts a CompiledScene to an entry and back.
class SceneCacheEntry {
  static nlohmann::json OwnersOf(const CompiledScene& scene) {
    nlohmann::json owners = nlohmann::json::array();
    for (const auto& [part, name] : scene.key_owners()) owners.push_back({part, name});
    return owners;
  }

 public:
  static std::string Write(const CompiledScene& scene) {
    const nlohmann::json head = {
        {"robots", ToJson(scene.robots())},       {"objects", ToJson(scene.objects())},
        {"warnings", scene.warnings()},           {"notes", scene.notes()},
        {"engine_guards", scene.engine_guards()}, {"home_key", scene.home_key()},
        {"key_owners", OwnersOf(scene)},          {"signature", scene.model()->signature},
        {"places", PlacesOf(scene.spec())}};
    const std::string rest = head.dump() + "\n" + SaveBinaryString(scene.model());
    return Fingerprint(rest) + "\n" + rest;
  }

  // Returns true if the text is complete.
  static bool IsWhole(std::string_view text) {
    const std::string_view fingerprint = CutLine(text);
    return fingerprint == Fingerprint(text);
  }

  // Returns null if there are warnings about other files with the same content.
  static std::shared_ptr<CompiledScene> Read(const SceneSpec& spec, std::string_view text) {
    CutLine(text);
    const auto head = nlohmann::json::parse(CutLine(text));
    const bool has_messages = !head.at("warnings").empty() || !head.at("notes").empty();
    if (has_messages && head.at("places") != PlacesOf(spec)) return nullptr;
    if (!head.contains("key_owners")) return nullptr;  // it is older than these
    std::shared_ptr<CompiledScene> scene(new CompiledScene);
    scene->scene_spec_ = spec;
    scene->robots_ = RobotsFromJson(spec, head.at("robots"));
    scene->objects_ = ObjectsFromJson(head.at("objects"));
    head.at("warnings").get_to(scene->warnings_);
    head.at("notes").get_to(scene->notes_);
    head.at("home_key").get_to(scene->home_key_);
    for (const auto& owner : head.at("key_owners"))
      scene->key_owners_.push_back({owner.at(0), owner.at(1)});
    head.at("engine_guards").get_to(scene->engine_guards_);
    const std::string context = "scene '" + spec.name + "'";
    // The guard was applied, or not, when the scene was compiled.
    scene->model_owner_ = LoadBinaryString(text, context, JacobianGuard::kOff);
    scene->model_ = scene->model_owner_.get();
    scene->jacobian_ = scene->model_->opt.jacobian;
    if (!scene->engine_guards_.empty()) LogJacobianGuard(scene->model_, context);
    // The engine does not save the signature, and compares it where a spec and a model meet.
    head.at("signature").get_to(scene->model_->signature);
    scene->generation_ = CompiledScene::NextGeneration();
    scene->sources_ = SourceFiles(spec);
    return scene;
  }
};

namespace {

void Keep(const CompiledScene& scene, const fs::path& folder, const fs::path& file) {
  try {
    std::error_code error;
    fs::create_directories(folder, error);
    AtomicWrite(file, SceneCacheEntry::Write(scene));
    PruneSceneCache(folder, kSceneCacheBytes);
  } catch (const IoError& error) {
    LogWarn("scene '" + scene.spec().name + "' is not kept for later processes: " + error.what());
  }
}

}  // namespace

fs::path SceneCacheFolder() {
  if (const std::string own = internal::Environment("ROBOCELL_CACHE_DIR"); !own.empty())
    return fs::path(own) / "scenes";
  return internal::UserCacheFolder() / "robocell" / "scenes";
}

std::string SceneKey(const SceneSpec& spec) {
  SceneSpec content = spec;  // spec with hashes instead of file names
  internal::ForEachModel(content, [](std::string& name, const std::string& directory) {
    const FileSet files = internal::ModelFileSet(assets::Resolve(name, directory), kFingerprints);
    name = files.hash + ":" + files.main;
  });
  std::string text = internal::SpecBytes(content);
  for (const std::string& version :
       {std::string(Version()), std::string(mj_versionString()), std::string(kLayout)})
    text += version + "\n";
  return Fingerprint(text);
}

std::shared_ptr<CompiledScene> CompileSceneCached(const SceneSpec& spec, const fs::path& folder) {
  std::optional<fs::path> file;
  try {
    file = folder / (SceneKey(spec) + kSuffix);
  } catch (const Error&) {  // the compiler reports it with all other problems
    return CompileScene(spec);
  }
  if (const auto entry = ReadEntry(*file)) {
    if (!SceneCacheEntry::IsWhole(*entry)) {
      LogWarn("'" + file->string() + "' is damaged; the scene is compiled again");
    } else if (auto scene = SceneCacheEntry::Read(spec, *entry)) {
      return scene;
    }
  }
  auto scene = CompileScene(spec);
  Keep(*scene, folder, *file);
  return scene;
}

void PruneSceneCache(const fs::path& folder, uint64_t most_bytes) {
  internal::PruneFolder(folder, kSuffix, most_bytes);
}

}  // namespace robocell
