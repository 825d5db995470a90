#include "robocell/scenes/scene_source.h"

#include <fmt/format.h>

#include <map>
#include <mutex>
#include <numeric>
#include <utility>

#include "robocell/assets/resolve.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell {
namespace {

// The built-in table on a floor, over and over.
class TabletopSource final : public SceneSource {
 public:
  std::optional<int> size() const override { return std::nullopt; }
  SceneSpec Make(int /*index*/) override {
    return {.base = "tabletop", .add_floor = true, .add_skybox = true};
  }
};

// MJCF files.
class FilesSource final : public SceneSource {
 public:
  FilesSource(FilesScenes fields, const std::string& directory)
      : files_(std::move(fields.files)), root_(fields.root.value_or(directory)) {}

  std::optional<int> size() const override { return static_cast<int>(files_.size()); }
  SceneSpec Make(int index) override {
    return {.base = assets::Resolve(files_.at(static_cast<size_t>(index)), root_)};
  }

 private:
  std::vector<std::string> files_;
  std::string root_;
};

class TabletopKind final : public SceneSourceKind {
 public:
  std::shared_ptr<SceneSource> Make(const SceneSourceSpec& /*spec*/,
                                    const std::string& /*directory*/) const override {
    return std::make_shared<TabletopSource>();
  }
};

class FilesKind final : public SceneSourceKind {
 public:
  std::shared_ptr<SceneSource> Make(const SceneSourceSpec& spec,
                                    const std::string& directory) const override {
    return std::make_shared<FilesSource>(spec.As<FilesScenes>(), directory);
  }
};

struct SourceRegistry {
  std::mutex mutex;
  std::map<std::string, std::shared_ptr<const SceneSourceKind>> kinds = {
      {TabletopScenes::kKind, std::make_shared<TabletopKind>()},
      {FilesScenes::kKind, std::make_shared<FilesKind>()}};
};

SourceRegistry& SourceKinds() {
  static SourceRegistry registry;
  return registry;
}

}  // namespace

SceneAnnotations SceneSource::Annotations(int index) {
  if (auto known = KnownAnnotations(index)) return std::move(*known);
  return Derive(index);
}

SceneAnnotations SceneSource::Derive(int index) {
  SceneSpec spec = Make(index);
  if (!spec.timestep) spec.timestep = Rates().timestep().value();  // which says nothing here
  return DeriveAnnotations(spec);
}

void RegisterSceneSource(const std::string& kind, std::shared_ptr<const KindFields> fields,
                         std::shared_ptr<const SceneSourceKind> source, bool replace) {
  if (!source)
    throw ArgumentError("scene source '" + kind + "' needs a SceneSourceKind that makes it");
  SceneSourceRegistry().Register(kind, std::move(fields), replace);
  SourceRegistry& registry = SourceKinds();
  const std::lock_guard lock(registry.mutex);
  registry.kinds[kind] = std::move(source);
}

std::shared_ptr<const SceneSourceKind> FindSceneSourceKind(const std::string& kind) {
  SourceRegistry& registry = SourceKinds();
  const std::lock_guard lock(registry.mutex);
  const auto found = registry.kinds.find(kind);
  if (found != registry.kinds.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [name, source] : registry.kinds) known.push_back(name);
  throw NotFoundError(NoSuchName("", "scene source", kind, known));
}

std::shared_ptr<SceneSource> MakeSceneSource(const RunConfig& run) {
  return FindSceneSourceKind(run.scenes.kind())->Make(run.scenes, run.source_dir);
}

SceneSpec MakeBaseScene(const RunConfig& run, SceneSource& source, int index) {
  const std::optional<int> size = source.size();
  if (index < 0 || (size && index >= *size)) {
    throw ArgumentError(fmt::format("run '{}': scenes: there is no scene {} in source '{}'{}",
                                    run.run, index, run.scenes.kind(),
                                    size ? fmt::format(", which has {}", *size) : ""));
  }
  SceneSpec spec = source.Make(index);
  spec.name = run.run;
  spec.timestep = run.rates.timestep().value();
  spec.options = run.options;
  return spec;
}

SceneSpec MakeBaseScene(const RunConfig& run, int index) {
  return MakeBaseScene(run, *MakeSceneSource(run), index);
}

std::vector<int> SceneIndices(const RunConfig& run) {
  if (!run.scenes.houses.empty()) return run.scenes.houses.values;
  const auto count = MakeSceneSource(run)->size().value_or(1);
  if (count <= 0) {
    throw SpecError(
        fmt::format("run '{}': scenes: source '{}' has no scenes", run.run, run.scenes.kind()));
  }
  std::vector<int> all(static_cast<size_t>(count));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

void ValidateHouses(const RunConfig& run, Problems& problems) {
  const Problems::Scope scope(problems, "scenes");
  const std::optional<int> size = MakeSceneSource(run)->size();
  if (!size) return;
  if (*size <= 0) problems.Add(fmt::format("source '{}' has no scenes", run.scenes.kind()));
  for (const int house : run.scenes.houses.values) {
    if (house < *size) continue;
    problems.AddAt("houses", fmt::format("{} is outside the {} scenes of source '{}' (they count "
                                         "from 0)",
                                         house, *size, run.scenes.kind()));
  }
}

std::vector<Support> SupportsOf(SceneSource& source, int index, const SceneSpec& scene) {
  if (const std::optional<SceneAnnotations> known = source.KnownAnnotations(index)) {
    std::vector<Support> supports;
    for (const SupportFace& support : known->supports) supports.push_back(support.face);
    if (!supports.empty()) return supports;
  }
  return {FindSupport(scene)};
}

}  // namespace robocell
