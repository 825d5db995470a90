#include "robocell/scenes/scene_annotation_file.h"

#include <fmt/format.h>
#include <mujoco/mjmodel.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/base/units.h"
#include "robocell/mujoco/names.h"
#include "robocell/spec/spec_file.h"
#include "robocell/spec/yaml_reader.h"

namespace robocell::internal {
namespace {

SceneAnnotationFile ReadAnnotationFile(const std::string& path) {
  yaml::Reader reader(path, std::filesystem::path(path).parent_path().string());
  SceneAnnotationFile file;
  reader.ReadDocument(yaml::ParseText(ReadSpecFile(path, SceneAnnotationFile::kTypeName), path),
                      file);
  reader.problems().Throw(path);
  return file;
}

// Adds a problem for each body that the scene does not have.
class BodyCheck {
 public:
  BodyCheck(const Scene& scene, Problems& problems) : scene_(scene), problems_(problems) {}
  template <class T>
  void Check(const char* list, const List<T>& entries, const char* field,
             std::string T::*name) const {
    const Problems::Scope in_list(problems_, list);
    for (size_t i = 0; i < entries.size(); ++i) {
      const Problems::Scope in_entry(problems_, i);
      const std::string& body = entries[i].*name;
      if (body.empty()) continue;
      try {
        RequireId(scene_.model(), mjOBJ_BODY, body, "the scene");
      } catch (const NotFoundError& error) {
        problems_.AddAt(field, error.what());
      }
    }
  }

 private:
  const Scene& scene_;
  Problems& problems_;
};

}  // namespace

Pose AnnotatedArea::frame_to_world() const {
  return Pose::FromRpy(ToEigen(pos), {0, 0, Radians(yaw)});
}

void AnnotatedRoom::Validate(Problems& problems) const {
  if (name.empty()) problems.AddAt("name", "is empty");
  if (!outline.empty() && outline.size() < 3)
    problems.AddAt("outline", fmt::format("has {} corners; give 3 or more", outline.size()));
}

void SceneAnnotationFile::Validate(Problems& problems) const {
  std::set<std::string> names;
  for (size_t i = 0; i < rooms.size(); ++i) {
    if (names.insert(rooms[i].name).second) continue;
    const Problems::Scope in_list(problems, "rooms");
    const Problems::Scope in_entry(problems, i);
    problems.AddAt("name", fmt::format("'{}' is the name of two rooms", rooms[i].name));
  }
  const auto check = [&](const char* list, const auto& entries) {
    const Problems::Scope in_list(problems, list);
    for (size_t i = 0; i < entries.size(); ++i) {
      const std::string& room = entries[i].room;
      if (room.empty() || rooms.empty() || names.contains(room)) continue;
      const Problems::Scope in_entry(problems, i);
      problems.AddAt("room", fmt::format("'{}' is not among `rooms`.{}", room,
                                         DidYouMean(room, {names.begin(), names.end()})));
    }
  };
  check("supports", supports);
  check("free_floor", free_floor);
  check("objects", objects);
  for (size_t i = 0; i < objects.size(); ++i) {
    if (!objects[i].object.empty()) continue;
    const Problems::Scope in_list(problems, "objects");
    const Problems::Scope in_entry(problems, i);
    problems.AddAt("object", "is empty");
  }
}

std::filesystem::path AnnotationFileOf(const std::filesystem::path& scene) {
  return std::filesystem::path(scene).replace_extension(".annotations.yaml");
}

SceneAnnotations AnnotationsFromFile(const std::filesystem::path& file, const Scene& scene) {
  const SceneAnnotationFile given = ReadAnnotationFile(file.string());
  Problems problems(given.locations);
  const BodyCheck bodies(scene, problems);
  bodies.Check("supports", given.supports, "body", &AnnotatedArea::body);
  bodies.Check("free_floor", given.free_floor, "body", &AnnotatedArea::body);
  bodies.Check("objects", given.objects, "object", &AnnotatedObject::object);
  problems.Throw(file.string());
  SceneAnnotations known = DeriveAnnotations(scene);
  if (!given.supports.empty()) known.supports.clear();
  for (const AnnotatedArea& area : given.supports)
    known.supports.push_back({.face = {.frame_to_world = area.frame_to_world(),
                                       .half_x = area.size[0] / 2,
                                       .half_y = area.size[1] / 2},
                              .body = area.body,
                              .free_area = area.size[0] * area.size[1],
                              .room = area.room});
  if (!given.free_floor.empty()) known.free_floor.clear();
  for (const AnnotatedArea& area : given.free_floor)
    known.free_floor.push_back({.frame_to_world = area.frame_to_world(),
                                .half_x = area.size[0] / 2,
                                .half_y = area.size[1] / 2,
                                .room = area.room,
                                .floor = area.body});
  for (const AnnotatedRoom& room : given.rooms)
    known.rooms.push_back({.name = room.name,
                           .category = room.category,
                           .outline = room.outline,
                           .floor_height = room.floor_height});
  for (const AnnotatedObject& object : given.objects) {
    ObjectWords words{.object = object.object,
                      .category = object.category,
                      .words = object.words,
                      .room = object.room};
    const auto derived = std::ranges::find(known.objects, words.object, &ObjectWords::object);
    if (derived == known.objects.end()) {
      known.objects.push_back(std::move(words));
      continue;
    }
    if (words.category.empty()) words.category = derived->category;
    if (words.words.empty()) words.words = derived->words;
    *derived = std::move(words);
  }
  return known;
}

}  // namespace robocell::internal
