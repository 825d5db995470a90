// Grasps: sets of them, where they come from, and which of them a robot can reach.
#include "grasps.h"

#include <nanobind/nanobind.h>

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>
#include <Eigen/Core>

#include "arrays.h"
#include "bindings.h"
#include "values.h"
#include "robocell/task/grasp.h"
#include "robocell/task/grasp_generator.h"
#include "robocell/task/grasp_library.h"
#include "robocell/task/grasp_proof.h"
#include "robocell/task/reachable_grasps.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

using Unlocked = nb::call_guard<nb::gil_scoped_release>;

nb::object GraspMatrices(const std::vector<Pose>& poses) {
  std::vector<double> numbers;
  for (const Pose& pose : poses) {
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> x = pose.matrix();
    numbers.insert(numbers.end(), x.data(), x.data() + 16);
  }
  return NewArray<double>(numbers, {poses.size(), 4, 4});
}

std::vector<Pose> GraspPoses(const GraspSet& set, const Pose& body = {}) {
  std::vector<Pose> poses;
  for (const Grasp& grasp : set.grasps) poses.push_back(body * grasp.tcp_in_body);
  return poses;
}

template <class Member>
nb::object GraspNumbers(const GraspSet& set, Member member) {
  std::vector<double> numbers;
  for (const Grasp& grasp : set.grasps) numbers.push_back(grasp.*member);
  return NewArray<double>(numbers, {numbers.size()});
}

nb::object JointPathArray(const JointPath& path) {
  std::vector<double> numbers;
  for (const JointVector& q : path) numbers.insert(numbers.end(), q.begin(), q.end());
  const size_t columns = path.empty() ? 0 : static_cast<size_t>(path.front().size());
  return NewArray<double>(numbers, {path.size(), columns});
}

// Converts an index as Python counts.
size_t GraspIndex(const GraspSet& set, Py_ssize_t index) {
  const auto size = static_cast<Py_ssize_t>(set.grasps.size());
  const Py_ssize_t at = index < 0 ? index + size : index;
  if (at < 0 || at >= size)
    throw nb::index_error(fmt::format("grasp {} of {}", index, size).c_str());
  return static_cast<size_t>(at);
}

GraspSet SelectGrasps(const GraspSet& set, nb::handle which) {
  GraspSet chosen{.robot = set.robot, .body = set.body, .grasps = {}};
  for (const nb::object& item : ToItems(which, FieldPath("indices"), "a list of indices")) {
    const auto index = static_cast<Py_ssize_t>(ToInt(item, FieldPath("indices")));
    chosen.grasps.push_back(set.grasps[GraspIndex(set, index)]);
  }
  return chosen;
}

GraspOptions GraspOptionsFrom(nb::handle kinds, nb::handle geoms, int samples, int most,
                              uint64_t seed, double friction, double clearance,
                              double approach_length) {
  GraspOptions options{.geoms = ToTexts(geoms, FieldPath("geoms")),
                       .samples = samples,
                       .most = most,
                       .seed = seed,
                       .friction = friction,
                       .clearance = clearance,
                       .approach_length = approach_length};
  for (const std::string& name : ToTexts(kinds, FieldPath("kinds")))
    options.kinds.push_back(GraspKindOf(name));
  return options;
}

void BindGrasp(nb::module_& m) {
  nb::class_<Grasp>(m, "Grasp",
                    "How a hand takes hold of an object, in the frame of the object's body.")
      .def_ro("tcp_in_body", &Grasp::tcp_in_body, "The TCP in the frame of the body at contact.")
      .def_prop_ro("before", &Grasp::before,
                   "The TCP in the frame of the body where the straight approach begins.")
      .def_prop_ro(
          "kind", [](const Grasp& g) { return ToString(g.kind); },
          "\"top\", \"side\", \"antipodal\", \"rim\", \"handle\", \"enclosing\", \"suction\", "
          "\"push\" or \"hook\".")
      .def_ro("opening", &Grasp::opening, "Distance between the fingers during the approach, m.")
      .def_ro("width", &Grasp::width, "Distance between the fingers at contact, m.")
      .def_prop_ro(
          "approach",
          [](const Grasp& g) {
            return NewArray<double>(std::span(g.approach.data(), 3), {size_t{3}});
          },
          nb::for_getter(nb::sig("def approach(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Direction in which the hand comes: a unit vector (3,) in the frame of the body.")
      .def_ro("approach_length", &Grasp::approach_length, "Length of the approach, m.")
      .def_ro("score", &Grasp::score, "0 to 1; higher is better.")
      .def("__repr__", [](const Grasp& g) {
        return fmt::format("<Grasp: {}, {:.3f} m wide, score {:.2f}>", ToString(g.kind), g.width,
                           g.score);
      });
  nb::class_<GraspProof>(m, "GraspProof", "What shaking an object in the hand showed.")
      .def_ro("held", &GraspProof::held, "True if the object stayed in the hand.")
      .def_ro("failure", &GraspProof::failure, "Why it did not; \"\" otherwise.")
      .def_ro("slip", &GraspProof::slip, "How far the object moved in the hand, m.")
      .def_ro("turn", &GraspProof::turn, "How far it turned, rad.")
      .def("__bool__", [](const GraspProof& p) { return p.held; });
  nb::class_<ReachableGrasp>(m, "ReachableGrasp", "A grasp with the motion of the arm to it.")
      .def_ro("grasp", &ReachableGrasp::grasp, "The grasp.")
      .def_ro("index", &ReachableGrasp::index, "Its index in the set.")
      .def_ro("tcp_in_world", &ReachableGrasp::tcp_in_world, "The TCP at contact.")
      .def_ro("cost", &ReachableGrasp::cost, "Lower is better.")
      .def_prop_ro(
          "way", [](const ReachableGrasp& g) { return JointPathArray(g.way); },
          nb::for_getter(nb::sig("def way(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Joint positions of the arm (k, n) from the begin of the approach to the contact.")
      .def_prop_ro(
          "up", [](const ReachableGrasp& g) { return JointPathArray(g.up); },
          nb::for_getter(nb::sig("def up(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Joint positions from the contact up; no rows without `lift`.")
      .def("__repr__", [](const ReachableGrasp& g) {
        return fmt::format("<ReachableGrasp: {}, cost {:.2f}>", ToString(g.grasp.kind), g.cost);
      });
}

void BindSetNumbers(nb::class_<GraspSet>& set) {
  set.def("__len__", [](const GraspSet& s) { return s.grasps.size(); })
      .def(
          "__getitem__",
          [](const GraspSet& s, Py_ssize_t index) { return s.grasps[GraspIndex(s, index)]; },
          "index"_a)
      .def(
          "__iter__",
          [](nb::handle self) {
            const GraspSet& s = nb::cast<const GraspSet&>(self);
            nb::list items;
            for (const Grasp& grasp : s.grasps) items.append(grasp);
            return nb::iter(items);
          },
          nb::sig("def __iter__(self) -> Iterator[Grasp]"))
      .def(
          "__array__",
          [](const GraspSet& s, nb::args, const nb::kwargs&) {
            return GraspMatrices(GraspPoses(s));
          },
          nb::sig("def __array__(self, dtype: numpy.typing.DTypeLike | None = None, copy: bool | "
                  "None = None) -> numpy.typing.NDArray[numpy.float64]"),
          "Returns `tcp_in_body`.")
      .def_ro("robot", &GraspSet::robot, "Name of the robot whose hand grasps.")
      .def_ro("body", &GraspSet::body, "Full name of the body whose frame the poses are in.")
      .def_prop_ro(
          "tcp_in_body", [](const GraspSet& s) { return GraspMatrices(GraspPoses(s)); },
          nb::for_getter(nb::sig("def tcp_in_body(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Poses of the TCP in the frame of the body (N, 4, 4), the best first.")
      .def_prop_ro(
          "kinds",
          [](const GraspSet& s) {
            std::vector<std::string> kinds;
            for (const Grasp& grasp : s.grasps) kinds.push_back(ToString(grasp.kind));
            return kinds;
          },
          "The kind of each grasp.")
      .def_prop_ro(
          "openings", [](const GraspSet& s) { return GraspNumbers(s, &Grasp::opening); },
          nb::for_getter(nb::sig("def openings(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Distances between the fingers during the approach (N,), m.")
      .def_prop_ro(
          "widths", [](const GraspSet& s) { return GraspNumbers(s, &Grasp::width); },
          nb::for_getter(nb::sig("def widths(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Distances between the fingers at contact (N,), m.")
      .def_prop_ro(
          "scores", [](const GraspSet& s) { return GraspNumbers(s, &Grasp::score); },
          nb::for_getter(nb::sig("def scores(self) -> numpy.typing.NDArray[numpy.float64]")),
          "Scores (N,), 0 to 1.")
      .def("__repr__", [](const GraspSet& s) {
        return fmt::format("<GraspSet: {} of '{}' by '{}'>", s.grasps.size(), s.body, s.robot);
      });
}

void BindSet(nb::module_& m) {
  nb::class_<GraspSet> set(
      m, "GraspSet",
      "Grasps of one body by one hand, the best first. numpy.asarray(grasps) are the poses of the "
      "TCP (N, 4, 4)."
      "\n\nExamples:\n"
      "    >>> cube_grasps = rc.tasks.grasps(robot, \"cube\", samples=300)\n"
      "    >>> cube_grasps.tcp_in_body.shape[1:]\n"
      "    (4, 4)");
  BindSetNumbers(set);
  set.def("select", &SelectGrasps, "indices"_a,
          nb::sig("def select(self, indices: Sequence[int]) -> GraspSet"),
          "Returns the grasps of these indices, in their order.")
      .def(
          "of_kind",
          [](const GraspSet& s, const std::string& kind) {
            GraspSet chosen{.robot = s.robot, .body = s.body, .grasps = {}};
            const GraspKind wanted = GraspKindOf(kind);
            for (const Grasp& grasp : s.grasps)
              if (grasp.kind == wanted) chosen.grasps.push_back(grasp);
            return chosen;
          },
          "kind"_a, "Returns the grasps of one kind.")
      .def(
          "in_world",
          [](const GraspSet& s, const Scene& scene) {
            return GraspMatrices(GraspPoses(s, scene.body_pose(s.body)));
          },
          "scene"_a,
          nb::sig("def in_world(self, scene: Scene) -> numpy.typing.NDArray[numpy.float64]"),
          "Returns the poses of the TCP in the world (N, 4, 4) for the body's present pose.")
      .def(
          "goals",
          [](const GraspSet& s, const Scene& scene, int most) {
            return GoalsBefore(scene, s, most);
          },
          "scene"_a, "most"_a = 32,
          "Returns goals for `robot.plan`: the TCP where the approach of each grasp begins.")
      .def(
          "reachable",
          [](const GraspSet& s, const Robot& robot, int most, int tried, double clearance,
             double lift) {
            const nb::gil_scoped_release release;
            return FindReachableGrasps(
                       robot, s,
                       {.most = most, .tried = tried, .clearance = clearance, .lift = lift})
                .found;
          },
          "robot"_a, nb::kw_only(), "most"_a = 1, "tried"_a = 200, "clearance"_a = 0.0,
          "lift"_a = 0.0,
          "Returns up to `most` grasps that the robot can reach from where it stands, the cheapest "
          "first: nothing else is nearer than `clearance` (m) at the contact and on the straight "
          "way to it, and the arm can move up by `lift` (m). At most `tried` are looked at.")
      .def(
          "prove",
          [](const GraspSet& s, const Robot& robot, double acceleration, double seconds,
             double most_slip, double most_turn) {
            const nb::gil_scoped_release release;
            return ProveGrasps(robot, s,
                               {.acceleration = acceleration,
                                .seconds = seconds,
                                .most_slip = most_slip,
                                .most_turn = most_turn});
          },
          "robot"_a, nb::kw_only(), "acceleration"_a = 10.0, "seconds"_a = 0.2,
          "most_slip"_a = 0.02, "most_turn"_a = 0.5,
          "Simulates the hand alone with the object: it closes without gravity, and shakes to six "
          "sides, each for `seconds` with `acceleration` (m/s^2). Returns a GraspProof for each.")
      .def(
          "save",
          [](const GraspSet& s, const std::filesystem::path& path) { SaveGrasps(path, s.grasps); },
          "path"_a,
          "Writes an .npz file with `transforms` (N, 4, 4), `kinds`, `openings`, `widths`, "
          "`asides`, `approaches`, `approach_lengths` and `scores`.");
}

}  // namespace

void BindGrasps(nb::module_& m) {
  BindGrasp(m);
  BindSet(m);
  m.def(
      "grasps",
      [](const Robot& robot, const std::string& object, nb::handle kinds, nb::handle geoms,
         int samples, int most, uint64_t seed, double friction, double clearance,
         double approach_length, bool stored) {
        const GraspOptions options = GraspOptionsFrom(kinds, geoms, samples, most, seed, friction,
                                                      clearance, approach_length);
        const nb::gil_scoped_release release;
        return GraspsOf(robot, object, options, stored);
      },
      "robot"_a, "object"_a, nb::kw_only(), "kinds"_a = nb::make_tuple(),
      "geoms"_a = nb::make_tuple(), "samples"_a = 3000, "most"_a = 200, "seed"_a = 0,
      "friction"_a = 0.5, "clearance"_a = 0.001, "approach_length"_a = 0.08, "stored"_a = true,
      nb::sig(
          "def grasps(robot: Robot, object: str, *, kinds: str | Sequence[str] = (), geoms: str "
          "| Sequence[str] = (), samples: int = 3000, most: int = 200, seed: int = 0, friction: "
          "float = 0.5, clearance: float = 0.001, approach_length: float = 0.08, stored: bool "
          "= True) -> GraspSet"),
      "Returns grasps of an object by a robot's hand: those of a registered library, else "
      "generated "
      "from the geometry of both, and stored in the cache folder unless `stored` is False."
      "\n\nArgs:\n"
      "    object: An object of the scene, or the full name of a body: a door, a drawer.\n"
      "    kinds: \"top\", \"side\", \"antipodal\", \"rim\", \"handle\", \"enclosing\", "
      "\"suction\", \"push\", \"hook\". Default: all that hold.\n"
      "    geoms: Full names of the geoms to grasp; those named for kind \"handle\" count as "
      "handles. "
      "Default: of handles and hooks those whose names contain handle or knob, of the others all.\n"
      "    samples: Points drawn on the surface, at most 50 000.\n"
      "    most: Grasps returned, the best; at most 2000.\n"
      "    seed: Of the points.\n"
      "    friction: Coefficient between fingers and object.\n"
      "    clearance: Least distance between hand and object before contact, m.\n"
      "    approach_length: Length of the straight approach, m."
      "\n\nExamples:\n"
      "    >>> cube_grasps = rc.tasks.grasps(robot, \"cube\", samples=300)\n"
      "    >>> len(cube_grasps) > 0\n"
      "    True");
  m.def(
      "load_grasps",
      [](const std::filesystem::path& path, const Robot& robot, const std::string& object) {
        return LoadGrasps(path, robot, object);
      },
      "path"_a, "robot"_a, "object"_a,
      "Reads an .npz file with `transforms` (N, 4, 4): grasps of an object, or of a body by its "
      "full "
      "name, by a robot's hand. Arrays of GraspSet.save that the file lacks follow from the hand: "
      "it "
      "opens fully and comes along its own approach direction. Raises IoError for any other file.");
  m.def("register_grasp_library", &RegisterGraspLibrary, "name"_a, "folder"_a,
        "Makes `grasps` take files of a folder: <object>/<robot>/grasps.npz, "
        "<object>/<object>_grasps_filtered.npz, and for bodies with a joint "
        "joint_grasps_<joint>.npz. The latest library comes first; a name again replaces it.");
  m.def("unregister_grasp_library", &UnregisterGraspLibrary, "name"_a,
        "Removes a library. Raises NotFoundError with the names.");
  m.def("grasp_libraries", &GraspLibraryNames, "Returns the names of the registered libraries.");
}

}  // namespace robocell::python
