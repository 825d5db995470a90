#include "robocell/scenes/scene_source.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstddef>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/scenes/built_in_sources.h"
#include "robocell/scenes/houses/houses_config.h"
#include "robocell/scenes/randomized_model.h"
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

// The scenes that a run leaves out, by their reasons.
class LeftOut {
 public:
  void Add(int index, const std::string& why_not) {
    ++count_;
    std::vector<int>& of_reason = indices_[why_not];
    if (of_reason.size() < kShown) of_reason.push_back(index);
  }
  size_t count() const { return count_; }
  std::string Text(size_t of) const {
    std::string text =
        fmt::format("{} of {} scenes {} left out", count_, of, count_ == 1 ? "is" : "are");
    size_t shown = 0;
    for (const auto& [reason, indices] : indices_) {
      if (++shown > kShown)
        return text + fmt::format("; and {} more reasons", indices_.size() - kShown);
      text += fmt::format("{} {} ({})", shown == 1 ? ":" : ";", fmt::join(indices, ", "), reason);
    }
    return text;
  }

 private:
  static constexpr size_t kShown = 8;
  size_t count_ = 0;
  std::map<std::string, std::vector<int>> indices_;
};

// A run asks for its scenes several times.
void WarnOnce(const std::string& text) {
  static std::mutex mutex;
  static std::set<std::string> warned;
  const bool is_new = [&] {
    const std::lock_guard lock(mutex);
    return warned.insert(text).second;
  }();
  if (is_new) LogWarn(text);  // without the lock: a sink may wait for one of the caller's
}

}  // namespace

KindRegistry& SceneSourceRegistry() {
  static KindRegistry registry(
      "scene source", "source", TabletopScenes::kKind,
      {{TabletopScenes::kKind,
        {std::make_shared<KindFieldsOf<TabletopScenes>>(), internal::MakeTabletopKind()}},
       {FilesScenes::kKind,
        {std::make_shared<KindFieldsOf<FilesScenes>>(), internal::MakeFilesKind()}},
       {HousesScenes::kKind,
        {std::make_shared<KindFieldsOf<HousesScenes>>(), internal::MakeHousesKind()}}});
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
  if (run.randomize && run.randomize->needs_studio()) internal::AddStudio(spec);
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
  const std::shared_ptr<SceneSource> source = MakeSceneSource(run);
  std::vector<int> chosen = run.scenes.houses.values;
  const std::optional<int> size = source->size();
  if (chosen.empty()) {
    const int count = size.value_or(1);
    if (const std::string problem = ProblemOfSize(run, count); !problem.empty())
      throw SpecError(fmt::format("run '{}': scenes: {}", run.run, problem));
    for (int index = 0; index < count; ++index) {
      if (source->Has(index)) chosen.push_back(index);
    }
  }
  std::vector<int> usable;
  LeftOut left_out;
  for (const int index : chosen) {
    // Numbers outside of the source are reported where they are validated.
    const bool exists = index >= 0 && (!size || index < *size);
    const std::string why_not = exists ? source->WhyNot(index) : "";
    if (why_not.empty())
      usable.push_back(index);
    else
      left_out.Add(index, why_not);
  }
  if (left_out.count() == 0) return usable;
  const std::string text = fmt::format("run '{}': scenes: source '{}': {}", run.run,
                                       run.scenes.kind(), left_out.Text(chosen.size()));
  if (usable.empty()) throw SpecError(text);
  WarnOnce(text);
  return usable;
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
