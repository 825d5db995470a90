// SceneSource: provides the scenes of a run's episodes: numbered scenes without a task's objects
// and without the run's robot, and their annotations. tabletop and files are built in; custom ones
// are registered before the first configuration that names them is read:
//
//   struct LabConfig { ... kKind = "lab", Fields ... };
//   class Lab : public SceneSource { public: explicit Lab(const LabConfig& fields); ... };
//   RegisterSceneSource<LabConfig>(std::make_shared<SceneSourceKindOf<LabConfig, Lab>>());
//
// and then `scenes: {source: lab, ...}`. This file includes no concrete source; code that needs
// scenes includes it.
#pragma once

#include <filesystem>
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
  // Returns the number of scenes, counted from 0; unset for a source that has as many as requested.
  virtual std::optional<int> size() const = 0;
  // Returns scene `index`, always the same one. The run sets its name, timestep and solver options.
  virtual SceneSpec Make(int index) = 0;
  // Returns the source's annotations of a scene; unset if all are derived from the geometry. Throws
  // ArgumentError with scene and field for invalid values (RequireSound).
  std::optional<SceneAnnotations> CheckedAnnotations(int index);
  // Returns its own annotations, checked, else the derived ones.
  SceneAnnotations Annotations(int index);
  // Returns why a scene of the source cannot be used, such as a blacklisted house or one without its
  // files; "" if it can. Runs leave these scenes out and log the reasons.
  virtual std::string WhyNot(int /*index*/) { return ""; }
  // Returns false for a number below size() without a scene. Runs that name no scenes pass over it.
  virtual bool Has(int /*index*/) const { return true; }
  // Returns the files from which the annotations of a scene are read. They identify a run, like the
  // files of its models.
  virtual std::vector<std::filesystem::path> AnnotationFiles(int /*index*/) { return {}; }
  // Derives all annotations from the geometry of a scene, which is compiled (DeriveAnnotations).
  SceneAnnotations Derive(int index);

 protected:
  // Returns the source's annotations, unchecked.
  virtual std::optional<SceneAnnotations> KnownAnnotations(int /*index*/) { return std::nullopt; }
};

class SceneSourceKind : public KindRules {
 public:
  // `directory`: the start of relative paths in the fields.
  virtual std::shared_ptr<SceneSource> Make(const SceneSourceSpec& spec,
                                            const std::string& directory) const = 0;
  // Returns the source files that define a custom kind; a dataset stores their contents.
  virtual std::vector<std::string> CodeFiles() const { return {}; }
};

// Registers a kind for all threads. `fields` are its defaults. Throws ArgumentError for a name that
// is taken, unless `replace` allows it, and without fields or source.
void RegisterSceneSource(const std::string& kind, std::shared_ptr<const KindFields> fields,
                         std::shared_ptr<const SceneSourceKind> source, bool replace = false);

// A kind that makes its sources as T(const Config&, const std::string& directory), if there is such
// a constructor, else as T(const Config&). `directory` is the start of relative paths.
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

// Throws NotFoundError that lists the kinds.
std::shared_ptr<const SceneSourceKind> FindSceneSourceKind(const std::string& kind);

// Returns the source of a run's scenes.
std::shared_ptr<SceneSource> MakeSceneSource(const RunConfig& run);
// Throws NotFoundError, which begins with `place` and gives the number of scenes, unless the source
// has scene `index`.
void RequireScene(const SceneSource& source, int index, const std::string& place);
// Returns scene `index`, with the run's name, timestep and options. Throws NotFoundError for an
// unknown scene or file.
SceneSpec MakeBaseScene(const RunConfig& run, SceneSource& source, int index);
SceneSpec MakeBaseScene(const RunConfig& run, int index);
// Throws SpecError unless the source, and another one that is made of the same fields, give the
// same scene `index` as `scene`: otherwise neither resuming nor a second worker makes the same
// episodes.
void RequireSameAgain(const RunConfig& run, SceneSource& source, int index, const SceneSpec& scene);
// Returns the scenes of a run by their numbers in the source, in the order of `scenes.houses`,
// without those that the source cannot use (SceneSource::WhyNot), which are logged once. Throws
// SpecError for a source with an invalid size, or with more scenes than a run can take, and if none
// is left.
std::vector<int> SceneIndices(const RunConfig& run);
// Adds a problem for each of `scenes.houses` that the source does not have.
void ValidateHouses(const RunConfig& run, Problems& problems);
// Returns the supports for objects in a scene: those of the source, else the one derived from the
// geometry (support.h). Throws NotFoundError without one.
std::vector<Support> SupportsOf(SceneSource& source, int index, const SceneSpec& scene);

}  // namespace robocell
