// Annotations that a user writes beside a scene: lab.annotations.yaml beside lab.xml. What it does
// not list is derived from the geometry.
//
//   supports: [{body: bench, pos: [1, 0, 0.9], size: [1.2, 0.6]}]
//   free_floor: [{pos: [0, 0, 0], size: [3, 2], room: lab}]
//   rooms: [{name: lab, category: workshop, outline: [[-2, -2], [2, -2], [2, 2], [-2, 2]]}]
//   objects: [{object: mug, category: mug, words: [the blue cup], room: lab}]
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robocell/scene/scene.h"
#include "robocell/scenes/scene_annotations.h"
#include "robocell/spec/containers.h"
#include "robocell/spec/fields.h"
#include "robocell/spec/locations.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/types.h"

namespace robocell::internal {

// A level rectangle, in the world.
struct AnnotatedArea {
  Vec3 pos = {0, 0, 0};
  Vec2 size = {0, 0};
  double yaw = 0;  // degrees
  std::string body = {}, room = {};

  static constexpr const char* kTypeName = "AnnotatedArea";
  template <class V>
  static void Fields(V&& v) {
    v("pos", &AnnotatedArea::pos, "The middle of the area, in the world, metres.");
    v("size", &AnnotatedArea::size, "Its length and width, metres.", Bound::kPositive);
    v("yaw", &AnnotatedArea::yaw, "Its rotation about the vertical axis, degrees.");
    v("body", &AnnotatedArea::body, "The body that it belongs to.");
    v("room", &AnnotatedArea::room, "The room that it is in.");
  }
  Pose frame_to_world() const;
};

struct AnnotatedRoom {
  std::string name = {}, category = {};
  std::vector<Vec2> outline = {};
  double floor_height = 0;

  static constexpr const char* kTypeName = "AnnotatedRoom";
  template <class V>
  static void Fields(V&& v) {
    v("name", &AnnotatedRoom::name, "The name of the room.");
    v("category", &AnnotatedRoom::category, "What kind of room it is: kitchen, workshop.");
    v("outline", &AnnotatedRoom::outline,
      "Its corners on the floor, counter-clockwise, in the world, metres.");
    v("floor_height", &AnnotatedRoom::floor_height, "The height of its floor, metres.");
  }
  std::string Label() const { return LabelOf("room", name); }
  void Validate(Problems& problems) const;
};

struct AnnotatedObject {
  std::string object = {}, category = {}, room = {};
  std::vector<std::string> words = {};

  static constexpr const char* kTypeName = "AnnotatedObject";
  template <class V>
  static void Fields(V&& v) {
    v("object", &AnnotatedObject::object, "The body of the object.");
    v("category", &AnnotatedObject::category, "What it is: mug.");
    v("words", &AnnotatedObject::words, "Its descriptions in instructions: the blue cup.");
    v("room", &AnnotatedObject::room, "The room that it is in.");
  }
  std::string Label() const { return LabelOf("object", object); }
};

struct SceneAnnotationFile {
  List<AnnotatedArea> supports = {}, free_floor = {};
  List<AnnotatedRoom> rooms = {};
  List<AnnotatedObject> objects = {};
  Locations locations = {};

  static constexpr const char* kTypeName = "SceneAnnotationFile";
  template <class V>
  static void Fields(V&& v) {
    v("supports", &SceneAnnotationFile::supports,
      "Surfaces for objects, the preferred one first. Unset: level faces of the geometry.");
    v("free_floor", &SceneAnnotationFile::free_floor,
      "Floor on which nothing stands, for bases of robots. Unset: from the geometry.");
    v("rooms", &SceneAnnotationFile::rooms, "The rooms.");
    v("objects", &SceneAnnotationFile::objects, "Words for objects of the scene.");
  }
  // Rooms have different names, and other entries use these names.
  void Validate(Problems& problems) const;
};

// Returns where the annotations of a scene file are: lab.annotations.yaml beside lab.xml.
std::filesystem::path AnnotationFileOf(const std::filesystem::path& scene);

// Returns the derived annotations of a scene, with those of the file in their places. Throws
// SpecError with file:line:column for values that are not valid, and for bodies that the scene does
// not have.
SceneAnnotations AnnotationsFromFile(const std::filesystem::path& file, const Scene& scene);

}  // namespace robocell::internal
