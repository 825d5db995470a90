// SceneAnnotations: data about a scene beside its geometry: surfaces and containers for objects,
// parts that open, free floor, names. Sources of scenes fill it in (scene_source.h); missing parts
// are derived from the geometry.
//
//   const SceneAnnotations known = DeriveAnnotations(spec);
//   for (const Articulation& joint : known.articulations) ... joint.handle_geoms ...
//
// Poses are in the world, metres and radians, for the compiled scene. Names are those of the
// compiled scene.
#pragma once

#include <string>
#include <vector>

#include "robocell/math/pose.h"
#include "robocell/scene/scene.h"
#include "robocell/scenes/support.h"
#include "robocell/spec/scene_object.h"
#include "robocell/spec/scene_spec.h"
#include "robocell/spec/types.h"

namespace robocell {

// A level face for objects.
struct SupportFace {
  Support face;
  std::string body;
  double free_area = 0;  // square metres of it with free space above
  std::string room = {};
};

// A hollow for objects: a tray, a drawer, a shelf behind a door.
struct Container {
  std::string body;
  Pose frame_to_world;     // the centre of the hollow
  Vec3 half_extents = {};  // half size of the hollow along its frame's axes
  Eigen::Vector3d opening = Eigen::Vector3d::UnitZ();  // out of it, in the world
  std::string moved_by = {};                           // the joint of a drawer; "" if it stands
  std::string room = {};
};

enum class ArticulationKind { kHinge, kSlide };

// A joint of the surroundings: a door, a drawer, a lid, a knob.
struct Articulation {
  std::string joint;
  std::string body;  // the body that the joint moves
  ArticulationKind kind = ArticulationKind::kHinge;
  Vec2 range = {0, 0};                               // joint range; infinite without limits
  double start = 0;                                  // its value in the scene as compiled
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();   // axis in the world
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  // a point of the axis, in the world
  std::vector<std::string> handle_geoms = {};        // geoms of its handles; empty if unknown
};

struct Room {
  std::string name;
  std::string category = {};       // "kitchen"
  std::vector<Vec2> outline = {};  // corners on the floor, counter-clockwise, in the world
  double floor_height = 0;
};

// A level rectangle of a floor on which nothing stands. A scene may have several levels.
struct FloorArea {
  Pose frame_to_world;  // its middle, z up
  double half_x = 0, half_y = 0;
  std::string room = {};
  std::string floor = {};  // the geom of the floor, or its body when the geom has no name
};

// The words for an object of the scene.
struct ObjectWords {
  std::string object;                   // its name in the scene
  std::string category = {};            // "mug"
  std::vector<std::string> words = {};  // description for instructions: "the blue cup"
  std::string room = {};
};

struct SceneLight {
  std::string name;  // "" for a light without one
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();
  bool directional = false;
};

struct SceneAnnotations {
  std::vector<SupportFace> supports = {};  // the preferred one first
  std::vector<Container> containers = {};
  std::vector<Articulation> articulations = {};
  std::vector<Room> rooms = {};
  std::vector<FloorArea> free_floor = {};
  std::vector<ObjectWords> objects = {};
  std::vector<SceneLight> lights = {};
};

// Derives annotations from the geometry of a scene: level faces of boxes, hollows of bodies, joints
// of the surroundings with the geoms that are named handles or knobs, its objects by their models
// or shapes, its lights, and rectangles of free floor, but no rooms. The scene is compiled; throws
// the errors of Scene::Build.
SceneAnnotations DeriveAnnotations(const SceneSpec& spec);
// Derives them from a built scene in its present state.
SceneAnnotations DeriveAnnotations(const Scene& scene);

// Returns the words for an object of a scene, by its model or shape.
ObjectWords WordsOf(const SceneObject& object);

// Returns the free areas of one floor, by the name of floor or room, largest first. Throws
// NotFoundError with the names.
std::vector<FloorArea> FreeFloorOf(const SceneAnnotations& annotations, const std::string& name);

// Throws ArgumentError, which begins with `place` and names the field, for numbers that are not
// finite (a range may be infinite) and for negative sizes.
void RequireSound(const SceneAnnotations& annotations, const std::string& place);

}  // namespace robocell
