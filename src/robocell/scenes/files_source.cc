#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/assets/model_files.h"
#include "robocell/assets/resolve.h"
#include "robocell/base/real_file.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/built_in_sources.h"
#include "robocell/scenes/scene_annotation_file.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;

constexpr double kAnyTimestep = 0.002;  // irrelevant for annotations
constexpr size_t kMostKnown = 256;

class FilesSource final : public SceneSource {
 public:
  FilesSource(FilesScenes fields, const std::string& directory)
      : files_(std::move(fields.files)), root_(fields.root.value_or(directory)) {}

  std::optional<int> size() const override { return static_cast<int>(files_.size()); }
  SceneSpec Make(int index) override { return {.base = PathOf(index)}; }
  std::vector<fs::path> AnnotationFiles(int index) override {
    const fs::path file = AnnotationFileOf(PathOf(index));
    return CanReadFile(file) ? std::vector{file} : std::vector<fs::path>();
  }

 protected:
  std::optional<SceneAnnotations> KnownAnnotations(int index) override {
    const std::vector<fs::path> file = AnnotationFiles(index);
    if (file.empty()) return std::nullopt;
    const std::string model = PathOf(index);
    Kept& kept = kept_[index];
    if (kept.files.empty() || kept.key != KeyOf(file.front(), kept.files)) {
      kept.files = FindModelFiles(model).files;
      kept.key = KeyOf(file.front(), kept.files);
      kept.annotations = Known(kept.key, model, file.front());
    }
    return kept.annotations;
  }

 private:
  std::string PathOf(int index) const {
    RequireScene(*this, index, "scene source 'files'");
    return assets::Resolve(files_.at(static_cast<size_t>(index)), root_);
  }
  static std::string KeyOf(const fs::path& annotations, const std::vector<fs::path>& files) {
    std::string key = FileIdentity(annotations) + "\n";
    for (const fs::path& file : files) key += FileIdentity(file) + "\n";
    return key;
  }
  // A source is made often; a scene is compiled once for its annotations.
  static SceneAnnotations Known(const std::string& key, const std::string& model,
                                const fs::path& annotations) {
    static std::mutex mutex;
    static std::map<std::string, SceneAnnotations> known;
    {
      const std::lock_guard lock(mutex);
      if (const auto it = known.find(key); it != known.end()) return it->second;
    }
    // Without the lock, because compiling may log.
    SceneAnnotations made =
        AnnotationsFromFile(annotations, Scene::Build({.base = model, .timestep = kAnyTimestep}));
    const std::lock_guard lock(mutex);
    if (known.size() >= kMostKnown) known.clear();
    return known[key] = std::move(made);
  }

  // Each start asks for the annotations of its scene: the model's text is read again only after one
  // of its files changed.
  struct Kept {
    std::vector<fs::path> files;  // of the model
    std::string key;
    SceneAnnotations annotations;
  };

  std::vector<std::string> files_;
  std::string root_;
  std::map<int, Kept> kept_;
};

}  // namespace

std::shared_ptr<const SceneSourceKind> MakeFilesKind() {
  return std::make_shared<SceneSourceKindOf<FilesScenes, FilesSource>>();
}

}  // namespace robocell::internal
