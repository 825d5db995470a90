#include "robocell/scene/source_files.h"

#include <set>
#include <system_error>

#include "robocell/assets/model_files.h"
#include "robocell/assets/resolve.h"
#include "robocell/assets/scene_models.h"
#include "robocell/base/error.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;

// Returns the files of the models that can be found.
std::set<fs::path> FilesOf(SceneSpec spec) {
  std::set<std::string> models;
  internal::ForEachModel(spec, [&](const std::string& name, const std::string& directory) {
    try {
      models.insert(assets::Resolve(name, directory));
    } catch (const Error&) {
    }
  });
  std::set<fs::path> files;
  for (const std::string& model : models) {
    try {
      const internal::ModelFiles found = internal::FindModelFiles(model);
      files.insert(found.files.begin(), found.files.end());
    } catch (const Error&) {
    }
  }
  return files;
}

}  // namespace

SourceFiles::SourceFiles(const SceneSpec& spec) {
  for (const fs::path& path : FilesOf(spec)) {
    std::error_code error;
    stamps_[path] = {fs::last_write_time(path, error), fs::file_size(path, error)};
  }
}

std::string SourceFiles::Difference(const SourceFiles& other) const {
  for (const auto& [path, stamp] : stamps_) {
    const auto theirs = other.stamps_.find(path);
    if (theirs != other.stamps_.end() && !(theirs->second == stamp)) return path.string();
  }
  return "";
}

}  // namespace robocell
