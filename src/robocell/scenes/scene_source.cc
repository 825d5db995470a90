#include "robocell/scenes/scene_source.h"

#include <fmt/format.h>

#include <numeric>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/scenes/built_in_sources.h"
#include "robocell/spec/spec_bytes.h"

namespace robocell {
namespace {

constexpr int kMostScenes = 1'000'000;  // of a run: each is made once before it begins

// Returns "" if a run can take that many scenes of its source, or takes only some of them.
std::string ProblemOfSize(const RunConfig& run, int size) {
  if (size < 0)
    return fmt::format(
        "source '{}' says that it has {} scenes; give a number from 1 on, or none for "
        "a source without end",
        run.scenes.kind(), size);
  if (size == 0) return fmt::format("source '{}' has no scenes", run.scenes.kind());
  if (size <= kMostScenes || !run.scenes.houses.empty()) return "";
  return fmt::format(
      "source '{}' has {} scenes, and a run takes {} at most; name those that it shall "
      "use: `houses: 0..99`",
      run.scenes.kind(), size, kMostScenes);
}

}  // namespace

KindRegistry& SceneSourceRegistry() {
  static KindRegistry registry(
      "scene source", "source", TabletopScenes::kKind,
      {{TabletopScenes::kKind,
        {std::make_shared<KindFieldsOf<TabletopScenes>>(), internal::MakeTabletopKind()}},
       {FilesScenes::kKind,
        {std::make_shared<KindFieldsOf<FilesScenes>>(), internal::MakeFilesKind()}}});
  return registry;
}

std::optional<SceneAnnotations> SceneSource::CheckedAnnotations(int index) {
  std::optional<SceneAnnotations> known = KnownAnnotations(index);
  if (known) RequireSound(*known, fmt::format("annotations of scene {}", index));
  return known;
}

SceneAnnotations SceneSource::Annotations(int index) {
  if (auto known = CheckedAnnotations(index)) return std::move(*known);
  return Derive(index);
}

SceneAnnotations SceneSource::Derive(int index) {
  SceneSpec spec = Make(index);
  if (!spec.timestep) spec.timestep = Rates().timestep().value();  // irrelevant here
  return DeriveAnnotations(spec);
}

void RegisterSceneSource(const std::string& kind, std::shared_ptr<const KindFields> fields,
                         std::shared_ptr<const SceneSourceKind> source, bool replace) {
  if (!source)
    throw ArgumentError("scene source '" + kind + "' needs a SceneSourceKind that makes it");
  SceneSourceRegistry().Register(kind, {std::move(fields), std::move(source)}, replace);
}

std::shared_ptr<const SceneSourceKind> FindSceneSourceKind(const std::string& kind) {
  const KindRegistry& registry = SceneSourceRegistry();
  if (auto source = std::dynamic_pointer_cast<const SceneSourceKind>(registry.RulesOf(kind)))
    return source;
  throw NotFoundError(
      fmt::format("scene source '{}' is registered with its fields alone; register it with "
                  "RegisterSceneSource",
                  kind));
}

std::shared_ptr<SceneSource> MakeSceneSource(const RunConfig& run) {
  return FindSceneSourceKind(run.scenes.kind())->Make(run.scenes, run.source_dir);
}

void RequireScene(const SceneSource& source, int index, const std::string& place) {
  const std::optional<int> size = source.size();
  if (index >= 0 && (!size || index < *size)) return;
  const std::string which = !size       ? "any from 0 on"
                            : *size < 1 ? "none"
                                        : fmt::format("{} (0 ... {})", *size, *size - 1);
  throw NotFoundError(fmt::format("{}: no scene {}; it has {}", place, index, which));
}

SceneSpec MakeBaseScene(const RunConfig& run, SceneSource& source, int index) {
  RequireScene(source, index,
               fmt::format("run '{}': scenes: source '{}'", run.run, run.scenes.kind()));
  SceneSpec spec = source.Make(index);
  const double timestep = run.rates.timestep().value();
  if (spec.timestep && !run.rates.HasTimestep(*spec.timestep)) {
    throw SpecError(fmt::format(
        "run '{}': scenes: source '{}' made scene {} with a timestep of {} s, and `rates` has one "
        "of {} s; leave SceneSpec.timestep unset there, or set `rates: {{sim_ms: {:g}}}`",
        run.run, run.scenes.kind(), index, *spec.timestep, timestep, *spec.timestep * 1000));
  }
  spec.name = run.run;
  spec.timestep = timestep;
  spec.options = run.options;
  return spec;
}

SceneSpec MakeBaseScene(const RunConfig& run, int index) {
  return MakeBaseScene(run, *MakeSceneSource(run), index);
}

void RequireSameAgain(const RunConfig& run, SceneSource& source, int index,
                      const SceneSpec& scene) {
  const std::string bytes = internal::SpecBytes(scene);
  const auto require = [&](SceneSource& of, const char* when) {
    if (internal::SpecBytes(MakeBaseScene(run, of, index)) == bytes) return;
    throw SpecError(fmt::format(
        "run '{}': scenes: source '{}' gave another scene {} {}; a scene must follow from its "
        "index "
        "and the fields alone, so draw random numbers from a generator seeded with the index",
        run.run, run.scenes.kind(), index, when));
  };
  require(source, "when it was asked again");
  require(*MakeSceneSource(run), "when it was made again");
}

std::vector<int> SceneIndices(const RunConfig& run) {
  if (!run.scenes.houses.empty()) return run.scenes.houses.values;
  const auto count = MakeSceneSource(run)->size().value_or(1);
  if (const std::string problem = ProblemOfSize(run, count); !problem.empty())
    throw SpecError(fmt::format("run '{}': scenes: {}", run.run, problem));
  std::vector<int> all(static_cast<size_t>(count));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

void ValidateHouses(const RunConfig& run, Problems& problems) {
  const Problems::Scope scope(problems, "scenes");
  const std::optional<int> size = MakeSceneSource(run)->size();
  if (!size) return;
  if (const std::string problem = ProblemOfSize(run, *size); !problem.empty())
    return problems.Add(problem);
  for (const int house : run.scenes.houses.values) {
    if (house < *size) continue;
    problems.AddAt("houses", fmt::format("{} is outside the {} scenes of source '{}' (they count "
                                         "from 0)",
                                         house, *size, run.scenes.kind()));
  }
}

std::vector<Support> SupportsOf(SceneSource& source, int index, const SceneSpec& scene) {
  if (const std::optional<SceneAnnotations> known = source.CheckedAnnotations(index)) {
    std::vector<Support> supports;
    for (const SupportFace& support : known->supports) supports.push_back(support.face);
    if (!supports.empty()) return supports;
  }
  return {FindSupport(scene)};
}

}  // namespace robocell
