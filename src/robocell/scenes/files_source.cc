#include "robocell/scenes/built_in_sources.h"

#include <utility>

#include "robocell/assets/resolve.h"

namespace robocell::internal {
namespace {

class FilesSource final : public SceneSource {
 public:
  FilesSource(FilesScenes fields, const std::string& directory)
      : files_(std::move(fields.files)), root_(fields.root.value_or(directory)) {}

  std::optional<int> size() const override { return static_cast<int>(files_.size()); }
  SceneSpec Make(int index) override {
    RequireScene(*this, index, "scene source 'files'");
    return {.base = assets::Resolve(files_.at(static_cast<size_t>(index)), root_)};
  }

 private:
  std::vector<std::string> files_;
  std::string root_;
};

}  // namespace

std::shared_ptr<const SceneSourceKind> MakeFilesKind() {
  return std::make_shared<SceneSourceKindOf<FilesScenes, FilesSource>>();
}

}  // namespace robocell::internal
