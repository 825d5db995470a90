// SceneSourceSpec: `scenes:` of a run file: the source of its scenes, the selected ones, and the
// fields of that kind of source (kind_fields.h).
//
//   scenes: {source: files, files: [lab.xml, shop.xml], houses: [1]}
//
//   run.scenes = FilesScenes{.files = {"lab.xml"}};
//
// tabletop and files are built in; RegisterSceneSource (scenes/scene_source.h) adds others.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robocell/spec/kind_fields.h"

namespace robocell {

// Whole numbers; in YAML a list or a range `0..3` (both ends included).
struct IndexList {
  std::vector<int> values;

  size_t size() const { return values.size(); }
  bool empty() const { return values.empty(); }
  bool operator==(const IndexList&) const = default;
};

// The built-in table on a floor, as often as requested.
struct TabletopScenes {
  static constexpr const char* kKind = "tabletop";
  static constexpr const char* kTypeName = "TabletopScenes";
  template <class V>
  static void Fields(V&& /*v*/) {}
};

struct FilesScenes {
  std::vector<std::string> files = {};
  std::optional<std::string> root = {};

  static constexpr const char* kKind = "files";
  static constexpr const char* kTypeName = "FilesScenes";
  template <class V>
  static void Fields(V&& v) {
    v("files", &FilesScenes::files, "The MJCF files, one scene each.");
    v("root", &FilesScenes::root, "Folder of the files. Unset: the folder of the run file.");
  }
  void Validate(Problems& problems) const;
};

// The kinds of scene sources. scenes/scene_source.cc defines it, and has the built-in ones.
KindRegistry& SceneSourceRegistry();

class SceneSourceSpec : public KindSpec {
 public:
  static constexpr const char* kHousesDoc =
      "Scenes of the source, by their numbers from 0: a list or 0..3. Unset: all of them, or the "
      "first one of a source without end.";

  // Makes a source of the registry's default kind, the tabletop.
  SceneSourceSpec() : SceneSourceSpec(SceneSourceRegistry().default_kind()) {}
  // Makes a kind with its defaults. Throws NotFoundError that lists the kinds.
  explicit SceneSourceSpec(const std::string& kind) : KindSpec(SceneSourceRegistry(), kind) {}
  template <NamesItsKind T>
  SceneSourceSpec(T fields) : SceneSourceSpec(std::string(T::kKind)) {
    Put(std::move(fields));
  }
  bool operator==(const SceneSourceSpec& other) const {
    return houses == other.houses && KindSpec::operator==(other);
  }

  IndexList houses = {};
};

// Adds the problems of the fields, and of `houses` by itself.
void ValidateScenes(const SceneSourceSpec& scenes, Problems& problems);

}  // namespace robocell
