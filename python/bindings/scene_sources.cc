// Sources of scenes and their descriptions of scenes; subclassing them in Python. C++ threads may
// call them: each call takes the GIL.
#include "robocell/scenes/scene_source.h"

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/pair.h>

#include "bindings.h"
#include "scene_cycles.h"
#include "spec_class.h"
#include "spec_fields.h"
#include "task_trampolines.h"
#include "robocell/base/error.h"
#include "robocell/scenes/houses/houses_config.h"
#include "robocell/scenes/houses/make_houses.h"
#include "robocell/scenes/spatial_relation.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

class PySceneSource : public SceneSource {
 public:
  NB_TRAMPOLINE(SceneSource);
  std::optional<int> size() const override {
    return CallMethod<std::optional<int>>(nb_trampoline, "size",
                                          static_cast<const SceneSource*>(this), nullptr);
  }
  SceneSpec Make(int index) override {
    return CallMethod<SceneSpec>(nb_trampoline, "make", static_cast<SceneSource*>(this), nullptr,
                                 index);
  }
  std::optional<SceneAnnotations> KnownAnnotations(int index) override {
    if (!Defines(nb_trampoline, "annotations")) return std::nullopt;
    const nb::gil_scoped_acquire acquire;
    const nb::handle self = nb_trampoline.base();
    return Returned<std::optional<SceneAnnotations>>(
        self, "annotations", CallPython(self, "annotations", [&] {
          return nb::object(self.attr("annotations")(index));
        }));
  }
};

Vec3 ToArray(const Eigen::Vector3d& vector) { return ToVec3(vector); }

// A field of a struct of plain data.
template <class C, class T>
void DefVector(nb::class_<C>& c, const char* name, T C::*field, const char* doc) {
  c.def_prop_ro(
      name, [field](const C& value) { return nb::cast(ToArray(value.*field)); }, doc,
      nb::sig(("def " + std::string(name) + "(self) -> list[float]").c_str()));
}

void BindSupportFace(nb::module_& m) {
  nb::class_<SupportFace>(m, "SupportFace", "A level face for objects.")
      .def(
          "__init__",
          [](SupportFace* self, const Support& face, const std::string& body, double free_area,
             const std::string& room) {
            new (self) SupportFace{face, body, free_area, room};
          },
          "face"_a, "body"_a = "", "free_area"_a = 0.0, "room"_a = "")
      .def_ro("face", &SupportFace::face, "The rectangle, a Support.")
      .def_ro("body", &SupportFace::body, "The body that the face belongs to.")
      .def_ro("free_area", &SupportFace::free_area, "Area with free space above it, square metres.")
      .def_ro("room", &SupportFace::room, "Name of its room; \"\" outside houses.");
}

void BindContainer(nb::module_& m) {
  nb::class_<Container> c(m, "Container", "A hollow for objects.");
  c.def(
       "__init__",
       [](Container* self, const std::string& body, const Pose& frame, const Vec3& half_extents,
          const Vec3& opening, const std::string& moved_by, const std::string& room) {
         new (self) Container{body, frame, half_extents, ToEigen(opening), moved_by, room};
       },
       "body"_a, "frame_to_world"_a, "half_extents"_a, "opening"_a = Vec3{0, 0, 1},
       "moved_by"_a = "", "room"_a = "")
      .def_ro("body", &Container::body, "The body that has the hollow.")
      .def_ro("frame_to_world", &Container::frame_to_world, "Pose of the middle of the hollow.")
      .def_prop_ro(
          "half_extents", [](const Container& value) { return value.half_extents; },
          "Size of the hollow along the axes of its frame, metres.",
          nb::sig("def half_extents(self) -> list[float]"))
      .def_ro("moved_by", &Container::moved_by, "The joint of a drawer; '' for a fixed hollow.")
      .def_ro("room", &Container::room, "Name of its room; \"\" outside houses.");
  DefVector(c, "opening", &Container::opening, "Direction out of the hollow, in the world.");
}

void BindArticulation(nb::module_& m) {
  nb::enum_<ArticulationKind>(m, "ArticulationKind",
                              "Kind of motion of a part of the surroundings.")
      .value("HINGE", ArticulationKind::kHinge, "Rotation about an axis: doors, lids, knobs.")
      .value("SLIDE", ArticulationKind::kSlide, "Translation along an axis: drawers.");
  nb::class_<Articulation> c(m, "Articulation",
                             "A joint of the surroundings: a door, a drawer, a lid, a knob.");
  c.def(
       "__init__",
       [](Articulation* self, const std::string& joint, const std::string& body,
          ArticulationKind kind, const Vec2& range, double start, const Vec3& axis,
          const Vec3& anchor, const std::vector<std::string>& handle_geoms) {
         new (self) Articulation{joint,           body,        kind, range, start, ToEigen(axis),
                                 ToEigen(anchor), handle_geoms};
       },
       "joint"_a, "body"_a, "kind"_a = ArticulationKind::kHinge, "range"_a = Vec2{0, 0},
       "start"_a = 0.0, "axis"_a = Vec3{0, 0, 1}, "anchor"_a = Vec3{0, 0, 0},
       "handle_geoms"_a = std::vector<std::string>())
      .def_ro("joint", &Articulation::joint, "Name of the joint.")
      .def_ro("body", &Articulation::body, "The body that the joint moves.")
      .def_ro("kind", &Articulation::kind, "HINGE or SLIDE.")
      .def_prop_ro(
          "range", [](const Articulation& value) { return value.range; },
          "Limits of its value, rad or m; infinite without limits.",
          nb::sig("def range(self) -> list[float]"))
      .def_ro("start", &Articulation::start, "Its value in the scene as compiled.")
      .def_ro("handle_geoms", &Articulation::handle_geoms, "Geoms that open it; empty if unknown.");
  DefVector(c, "axis", &Articulation::axis, "Axis of the joint, in the world.");
  DefVector(c, "anchor", &Articulation::anchor, "A point of the axis, in the world.");
}

void BindRooms(nb::module_& m) {
  nb::class_<Room>(m, "Room", "A room of a house.")
      .def(
          "__init__",
          [](Room* self, const std::string& name, const std::string& category,
             const std::vector<Vec2>& outline, double floor_height) {
            new (self) Room{name, category, outline, floor_height};
          },
          "name"_a, "category"_a = "", "outline"_a = std::vector<Vec2>(), "floor_height"_a = 0.0)
      .def_ro("name", &Room::name, "Name of the room.")
      .def_ro("category", &Room::category, "Category, such as 'kitchen'.")
      .def_ro("outline", &Room::outline,
              "Corners of the room on the floor, counter-clockwise, in the world.")
      .def_ro("floor_height", &Room::floor_height, "Height of the floor, metres.");
  nb::class_<FloorArea>(m, "FloorArea", "A free level rectangle of the floor.")
      .def(
          "__init__",
          [](FloorArea* self, const Pose& frame, double half_x, double half_y,
             const std::string& room, const std::string& floor) {
            new (self) FloorArea{frame, half_x, half_y, room, floor};
          },
          "frame_to_world"_a, "half_x"_a, "half_y"_a, "room"_a = "", "floor"_a = "")
      .def_ro("frame_to_world", &FloorArea::frame_to_world, "Pose of its middle, z up.")
      .def_ro("half_x", &FloorArea::half_x, "Half extent along its x axis, metres.")
      .def_ro("half_y", &FloorArea::half_y, "Half extent along its y axis, metres.")
      .def_ro("room", &FloorArea::room, "Name of its room; \"\" outside houses.")
      .def_ro("floor", &FloorArea::floor,
              "The geom of the floor, or its body when the geom has no name.");
}

void BindWords(nb::module_& m) {
  nb::class_<ObjectWords>(m, "ObjectWords", "Names of an object of a scene.")
      .def(
          "__init__",
          [](ObjectWords* self, const std::string& object, const std::string& category,
             const std::vector<std::string>& words, const std::string& room) {
            new (self) ObjectWords{object, category, words, room};
          },
          "object"_a, "category"_a = "", "words"_a = std::vector<std::string>(), "room"_a = "")
      .def_ro("object", &ObjectWords::object, "Its name in the scene.")
      .def_ro("category", &ObjectWords::category, "Category, such as 'mug'.")
      .def_ro("words", &ObjectWords::words, "Words for instructions: 'the blue cup'.")
      .def_ro("room", &ObjectWords::room, "Name of its room; \"\" outside houses.");
  nb::class_<SceneLight> light(m, "SceneLight", "A light of a scene.");
  light
      .def(
          "__init__",
          [](SceneLight* self, const std::string& name, const Vec3& position, const Vec3& direction,
             bool directional) {
            new (self) SceneLight{name, ToEigen(position), ToEigen(direction), directional};
          },
          "name"_a = "", "position"_a = Vec3{0, 0, 0}, "direction"_a = Vec3{0, 0, -1},
          "directional"_a = false)
      .def_ro("name", &SceneLight::name, "Name of the light; \"\" without one.")
      .def_ro("directional", &SceneLight::directional, "True for parallel light, as of the sun.");
  DefVector(light, "position", &SceneLight::position, "Position in the world, metres.");
  DefVector(light, "direction", &SceneLight::direction, "Direction of the light, in the world.");
}

void BindRelations(nb::module_& m) {
  nb::class_<SpatialRelation>(
      m, "SpatialRelation",
      "A relation between two objects, evaluated in the scene's present state: "
      "SpatialRelation(scene, object, relation, reference).\n\n"
      "on_top_of: it touches the reference from above. inside: its middle is over a hollow of the "
      "reference and it reaches below the rim. next_to: at most most_gap metres are free between "
      "them, and it is neither on nor in it. Names are those of objects and bodies. Raises "
      "NotFoundError for unknown names, ArgumentError for a reference without a hollow or a shape "
      "that collides.\n\nExamples:\n"
      "    >>> near = rc.scenes.SpatialRelation(scene, \"cube\", \"next_to\", \"base_link\")\n"
      "    >>> near.holds()\n"
      "    False",
      nb::type_slots(kHandleSlots<SpatialRelation>))
      .def(
          "__init__",
          [](SpatialRelation* self, const Scene& scene, const std::string& object,
             nb::handle relation, const std::string& reference, double most_gap) {
            Relation kind = Relation::kOnTopOf;
            Convert<Relation>::Set(kind, relation, FieldPath("relation"));
            new (self) SpatialRelation(scene, object, kind, reference, most_gap);
          },
          "scene"_a, "object"_a, "relation"_a, "reference"_a, nb::kw_only(),
          "most_gap"_a = kMostGap,
          nb::sig("def __init__(self, scene: Scene, object: str, relation: Relation | str, "
                  "reference: str, *, most_gap: float = 0.1) -> None"))
      .def("holds", &SpatialRelation::Holds,
           "Returns True if the relation holds in the scene's present state.");
}

void BindAnnotations(nb::module_& m) {
  BindSupportFace(m);
  BindContainer(m);
  BindArticulation(m);
  BindRooms(m);
  BindWords(m);
  using A = SceneAnnotations;
  nb::class_<A>(m, "SceneAnnotations",
                "Annotations of a scene beside its geometry. Poses are in the world, names those "
                "of the compiled scene.")
      .def(
          "__init__",
          [](A* self, const std::vector<SupportFace>& supports,
             const std::vector<Container>& containers,
             const std::vector<Articulation>& articulations, const std::vector<Room>& rooms,
             const std::vector<FloorArea>& free_floor, const std::vector<ObjectWords>& objects,
             const std::vector<SceneLight>& lights) {
            new (self) A{supports, containers, articulations, rooms, free_floor, objects, lights};
          },
          nb::kw_only(), "supports"_a = std::vector<SupportFace>(),
          "containers"_a = std::vector<Container>(),
          "articulations"_a = std::vector<Articulation>(), "rooms"_a = std::vector<Room>(),
          "free_floor"_a = std::vector<FloorArea>(), "objects"_a = std::vector<ObjectWords>(),
          "lights"_a = std::vector<SceneLight>(),
          nb::sig("def __init__(self, *, supports: collections.abc.Sequence[SupportFace] = (), "
                  "containers: collections.abc.Sequence[Container] = (), articulations: "
                  "collections.abc.Sequence[Articulation] = (), rooms: "
                  "collections.abc.Sequence[Room] = (), free_floor: "
                  "collections.abc.Sequence[FloorArea] = (), objects: "
                  "collections.abc.Sequence[ObjectWords] = (), lights: "
                  "collections.abc.Sequence[SceneLight] = ()) -> None"))
      .def_ro("supports", &A::supports, "Faces to put objects on.")
      .def_ro("containers", &A::containers, "Hollows to put objects into.")
      .def_ro("articulations", &A::articulations, "Doors, drawers, lids, knobs.")
      .def_ro("rooms", &A::rooms, "Rooms of a house; empty for other scenes.")
      .def_ro("free_floor", &A::free_floor, "Free floor of all levels.")
      .def("free_floor_of", &FreeFloorOf, "name"_a,
           "Returns the free areas of one floor, by the name of the floor or of a room, largest "
           "first. Raises NotFoundError with the names.")
      .def_ro("objects", &A::objects, "Names of the objects.")
      .def_ro("lights", &A::lights, "Lights of the scene.");
  m.def("derive_annotations", nb::overload_cast<const SceneSpec&>(&DeriveAnnotations), "spec"_a,
        nb::call_guard<nb::gil_scoped_release>(),
        "Derives annotations from the geometry of a SceneSpec, which is compiled: level faces, "
        "hollows, joints with the geoms that are named handles or knobs, objects and lights.");
}

void BindHouses(nb::module_& m) {
  BindSpecClass<HousesScenes>(m, "The fields of a scene source of kind `houses`.");
  nb::class_<HouseSummary>(m, "HouseSummary", "What a generated house has.")
      .def_ro("name", &HouseSummary::name, "Name of its files, without the ending.")
      .def_ro("rooms", &HouseSummary::rooms, "Number of rooms.")
      .def_ro("pieces", &HouseSummary::pieces, "Number of pieces of furniture.")
      .def_ro("objects", &HouseSummary::objects, "Number of objects that can be moved.")
      .def_ro("slots", &HouseSummary::slots, "Surfaces and containers that hold objects.")
      .def_ro("joints", &HouseSummary::joints, "Number of doors and drawers.")
      .def_ro("removed", &HouseSummary::removed, "Objects left out, since they did not rest.");
  nb::class_<HouseOptions>(m, "HouseOptions",
                           "Options of generated houses: the seed, the smallest and largest number "
                           "of rooms, and the largest number of objects.")
      .def(
          "__init__",
          [](HouseOptions* self, uint64_t seed, const std::pair<int, int>& rooms,
             int most_objects) {
            new (self) HouseOptions{.seed = seed,
                                    .least_rooms = rooms.first,
                                    .most_rooms = rooms.second,
                                    .most_objects = most_objects};
            self->Validate();
          },
          nb::kw_only(), "seed"_a = 0, "rooms"_a = std::pair{3, 6}, "most_objects"_a = 40);
  m.def("prepare_house_folder", &PrepareHouseFolder, "folder"_a, "options"_a,
        "Makes the folder, with the textures that its houses share. Raises ArgumentError if it has "
        "houses of other options.");
  m.def("has_house", &HasHouse, "folder"_a, "options"_a, "index"_a,
        "Returns True if the folder has the complete house.");
  m.def("make_house", &MakeHouseFiles, "folder"_a, "options"_a, "index"_a,
        nb::call_guard<nb::gil_scoped_release>(),
        "Makes the files of one house in a prepared folder: the model with and without a ceiling, "
        "the map, the metadata. The same options and index give the same bytes.");
}

}  // namespace

void BindSceneSources(nb::module_& m) {
  BindRelations(m);
  BindAnnotations(m);
  BindHouses(m);
  nb::class_<SceneSource, PySceneSource> source(
      m, "SceneSource",
      "Numbered scenes for episodes. Subclasses define size() -> int | None and\nmake(index) -> "
      "SceneSpec, and annotations(index) -> SceneAnnotations | None if the source\nknows more than "
      "the geometry. The same index must always give the same "
      "scene.\n`@register_scene_source('lab')` registers a subclass by name.");
  source.def(nb::init<>())
      .def("size", &SceneSource::size,
           "Returns the number of scenes, counted from 0; None for an unlimited number.")
      .def(
          "make",
          [](SceneSource& source, int index) {
            RequireScene(source, index, "scene source");
            return source.Make(index);
          },
          "index"_a,
          "Returns the SceneSpec, without a task's objects and the run's robot. The run sets its "
          "name, timestep and options. Raises NotFoundError for a scene that the source does not "
          "have.")
      .def(
          "annotations",
          [](SceneSource& source, int index) -> std::optional<SceneAnnotations> {
            // For a Python subclass this is the base's method: describing the scene would call the
            // method of the subclass, which may be calling this one.
            RequireScene(source, index, "scene source");
            if (dynamic_cast<PySceneSource*>(&source) != nullptr) return source.Derive(index);
            return source.Annotations(index);
          },
          "index"_a, nb::call_guard<nb::gil_scoped_release>(),
          "Returns the annotations of a scene: derived from its geometry, unless the source knows "
          "more.");
  source.def("why_not", &SceneSource::WhyNot, "index"_a, nb::call_guard<nb::gil_scoped_release>(),
             "Returns why runs leave a scene out, such as a blacklisted house; \"\" for one that "
             "can be used.");
  m.def("make_scene_source", &MakeSceneSource, "run"_a, "Returns the SceneSource of a run.");
  m.def(
      "base_scene", [](const RunConfig& run, int index) { return MakeBaseScene(run, index); },
      "run"_a, "index"_a = 0,
      "Returns a scene of a run's source, with the run's name, timestep and options.");
}

}  // namespace robocell::python
