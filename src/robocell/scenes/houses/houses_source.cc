#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/log.h"
#include "robocell/base/real_file.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/built_in_sources.h"
#include "robocell/scenes/houses/built_in_houses.h"
#include "robocell/scenes/houses/house_annotations.h"
#include "robocell/scenes/houses/house_folder.h"
#include "robocell/scenes/houses/houses_config.h"
#include "robocell/scenes/houses/prepared_house.h"

namespace robocell {

namespace internal {
namespace {

constexpr double kAnyTimestep = 0.002;  // irrelevant for annotations

// Each note about a house is logged once in a process. No lock is held while it is logged: a sink may
// wait for one of the caller's.
void NoteOnce(const std::string& place, const std::vector<std::string>& notes) {
  static std::mutex mutex;
  static std::set<std::string> noted;
  for (const std::string& note : notes) {
    const std::string text = fmt::format("{}: {}", place, note);
    const bool is_new = [&] {
      const std::lock_guard lock(mutex);
      return noted.insert(text).second;
    }();
    if (is_new) LogInfo(text);
  }
}

void NoteOnce(const HouseFiles& files, const std::vector<std::string>& notes) {
  NoteOnce(fmt::format("house '{}'", files.model.string()), notes);
}

// Annotations by the files that they were made from: a source is made often, a house is compiled
// once.
class KnownHouses {
 public:
  static std::shared_ptr<const SceneAnnotations> Of(const HouseFiles& files,
                                                    const std::filesystem::path& model) {
    static std::mutex mutex;
    static std::map<std::string, std::shared_ptr<const SceneAnnotations>> known;
    const std::string key =
        FileIdentity(model) + "\n" + FileIdentity(files.map) + "\n" + FileIdentity(files.metadata);
    {
      const std::lock_guard lock(mutex);
      if (const auto it = known.find(key); it != known.end()) return it->second;
    }
    // Compiled without the lock, because it may log.
    SceneSpec spec = SpecOf(model);
    spec.timestep = kAnyTimestep;
    std::vector<std::string> notes;
    auto annotations =
        std::make_shared<const SceneAnnotations>(AnnotateHouse(Scene::Build(spec), files, notes));
    NoteOnce(files, notes);
    const std::lock_guard lock(mutex);
    if (known.size() >= kMost) known.clear();
    return known[key] = std::move(annotations);
  }
  static SceneSpec SpecOf(const std::filesystem::path& model) {
    return {.name = model.stem().string(), .base = model.string()};
  }

 private:
  static constexpr size_t kMost = 256;
};

class HousesSource final : public SceneSource {
 public:
  HousesSource(const HousesScenes& fields, const std::string& directory) {
    if (fields.dataset || fields.root) {
      folder_ = HouseFolder::Find(fields, directory);
      NoteOnce(fmt::format("houses in '{}'", folder_->path().string()), folder_->notes());
    }
    ceiling_ = fields.ceiling;
  }

  std::optional<int> size() const override { return folder_ ? folder_->size() : kBuiltInHouses; }
  std::string WhyNot(int index) override {
    if (!folder_) return "";
    if (folder_->IsBlacklisted(index)) return "blacklisted";
    const auto house = folder_->houses().find(index);
    if (house == folder_->houses().end()) return "no such house";
    return PrepareHouse(house->second, *folder_).why_not;
  }
  bool Has(int index) const override { return !folder_ || folder_->houses().contains(index); }
  std::vector<std::filesystem::path> AnnotationFiles(int index) override {
    const HouseFiles files = Prepared(index).first;
    std::vector<std::filesystem::path> found;
    for (const std::filesystem::path& file : {files.map, files.metadata}) {
      if (!file.empty()) found.push_back(file);
    }
    return found;
  }
  SceneSpec Make(int index) override { return KnownHouses::SpecOf(Prepared(index).second); }

 protected:
  std::optional<SceneAnnotations> KnownAnnotations(int index) override {
    const auto [files, model] = Prepared(index);
    return *KnownHouses::Of(files, model);
  }

 private:
  std::pair<HouseFiles, std::filesystem::path> Prepared(int index) {
    RequireScene(*this, index, "scene source 'houses'");
    if (!folder_) {
      HouseFiles files = BuiltInHouse(index, ceiling_);
      std::filesystem::path model = files.model;
      return {std::move(files), std::move(model)};
    }
    const auto house = folder_->houses().find(index);
    if (house == folder_->houses().end())
      throw NotFoundError(fmt::format("scene source 'houses': no house {} in '{}'", index,
                                      folder_->path().string()));
    const PreparedHouse prepared = PrepareHouse(house->second, *folder_);
    if (!prepared.why_not.empty())
      throw SpecError(fmt::format("scene source 'houses': house {} ('{}') cannot be used: {}",
                                  index, house->second.model.string(), prepared.why_not));
    NoteOnce(house->second, prepared.notes);
    return {house->second, prepared.model};
  }

  std::optional<HouseFolder> folder_;
  bool ceiling_ = true;
};

}  // namespace

std::shared_ptr<const SceneSourceKind> MakeHousesKind() {
  return std::make_shared<SceneSourceKindOf<HousesScenes, HousesSource>>();
}

}  // namespace internal
}  // namespace robocell
