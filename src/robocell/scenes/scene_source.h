// SceneSource: where the episodes of a run take place: numbered scenes without a task's objects and
// without the run's robot, and what is known of them. tabletop and files are there; one's own are
// registered before the first configuration that names them is read:
//
//   struct LabConfig { ... kKind = "lab", Fields ... };
//   class Lab : public SceneSource { public: explicit Lab(const LabConfig& fields); ... };
//   RegisterSceneSource<LabConfig>(std::make_shared<SceneSourceKindOf<LabConfig, Lab>>());
//
// and then `scenes: {source: lab, ...}`. Includes nothing of a concrete source; what needs scenes
// includes this file.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "robocell/scenes/scene_annotations.h"
#include "robocell/spec/run_config.h"
#include "robocell/spec/scene_source_spec.h"
#include "robocell/spec/scene_spec.h"

namespace robocell {

class SceneSource {
 public:
  virtual ~SceneSource() = default;
  // How many scenes there are, counted from 0; unset for a source that has as many as are asked
  // for.
  virtual std::optional<int> size() const = 0;
  // Scene `index`, the same whenever and by whomever it is asked for. The run sets its name,
  // timestep and solver options.
  virtual SceneSpec Make(int index) = 0;
  // What the source knows of a scene; unset: all follows from its geometry. ArgumentError names
  // scene and field of what cannot be (RequireSound).
  std::optional<SceneAnnotations> CheckedAnnotations(int index);
  // What it knows, checked, else what is derived.
  SceneAnnotations Annotations(int index);
  // All that follows from the geometry of a scene, which is compiled (DeriveAnnotations).
  SceneAnnotations Derive(int index);

 protected:
  // What CheckedAnnotations checks and returns.
  virtual std::optional<SceneAnnotations> KnownAnnotations(int /*index*/) { return std::nullopt; }
};

class SceneSourceKind {
 public:
  virtual ~SceneSourceKind() = default;
  // `directory`: where relative paths of the fields start.
  virtual std::shared_ptr<SceneSource> Make(const SceneSourceSpec& spec,
                                            const std::string& directory) const = 0;
  // Source files that define it, for kinds that users write: a dataset remembers what they held.
  virtual std::vector<std::string> CodeFiles() const { return {}; }
};

// Makes a kind known on all threads, from now on. `fields` are its defaults. ArgumentError for a
// name that is taken, unless `replace` allows it, and without fields or source.
void RegisterSceneSource(const std::string& kind, std::shared_ptr<const KindFields> fields,
                         std::shared_ptr<const SceneSourceKind> source, bool replace = false);

// A kind whose sources are made as T(const Config&, const std::string& directory), where there is
// such a constructor, else as T(const Config&). `directory` is where relative paths start.
template <NamesItsKind Config, class T>
class SceneSourceKindOf : public SceneSourceKind {
 public:
  std::shared_ptr<SceneSource> Make(const SceneSourceSpec& spec,
                                    [[maybe_unused]] const std::string& directory) const override {
    if constexpr (std::is_constructible_v<T, const Config&, const std::string&>)
      return std::make_shared<T>(spec.As<Config>(), directory);
    else
      return std::make_shared<T>(spec.As<Config>());
  }
};
template <NamesItsKind Config>
void RegisterSceneSource(std::shared_ptr<const SceneSourceKind> source) {
  RegisterSceneSource(Config::kKind, std::make_shared<KindFieldsOf<Config>>(), std::move(source));
}

// NotFoundError lists the kinds.
std::shared_ptr<const SceneSourceKind> FindSceneSourceKind(const std::string& kind);

// The source of a run's scenes.
std::shared_ptr<SceneSource> MakeSceneSource(const RunConfig& run);
// NotFoundError, which begins with `place` and says how many there are, unless the source has scene
// `index`.
void RequireScene(const SceneSource& source, int index, const std::string& place);
// Scene `index` of it, with the run's name, timestep and options. NotFoundError for a scene or file
// that is not there.
SceneSpec MakeBaseScene(const RunConfig& run, SceneSource& source, int index);
SceneSpec MakeBaseScene(const RunConfig& run, int index);
// Throws SpecError unless the source, and another one that is made of the same fields, give the same
// scene `index` as `scene`: otherwise neither resuming nor a second worker makes the same episodes.
void RequireSameAgain(const RunConfig& run, SceneSource& source, int index, const SceneSpec& scene);
// The scenes of a run by their numbers in the source, in the order of `scenes.houses`. SpecError
// for a source whose size is none, or more than a run can take.
std::vector<int> SceneIndices(const RunConfig& run);
// Adds a problem for each of `scenes.houses` that the source does not have.
void ValidateHouses(const RunConfig& run, Problems& problems);
// Where objects may be put in a scene: what the source knows, else the support that the geometry
// has (support.h). NotFoundError without one.
std::vector<Support> SupportsOf(SceneSource& source, int index, const SceneSpec& scene);

}  // namespace robocell
