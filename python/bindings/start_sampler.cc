// The sampler of starts of any task, which can be subclassed in Python stage by stage, and the places
// that its stages pass on.
#include "robocell/task/start_sampler.h"

#include <nanobind/nanobind.h>

#include <algorithm>
#include <utility>

#include "bindings.h"
#include "python_owner.h"
#include "rng.h"
#include "sampler.h"
#include "task_trampolines.h"
#include "robocell/base/hook_error.h"
#include "robocell/task/base_placement.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

using Unlocked = nb::call_guard<nb::gil_scoped_release>;

// Returns a list of copies, which Python may keep.
nb::list ToList(const std::vector<SceneObject>& objects) {
  nb::list list;
  for (const SceneObject& object : objects) list.append(nb::cast(object));
  return list;
}

std::vector<SceneObject> FromList(const nb::list& list) {
  std::vector<SceneObject> objects;
  for (const nb::handle item : list) {
    if (!nb::isinstance<SceneObject>(item)) {
      throw nb::type_error(
          ("place_objects(): `objects` must be SceneObjects, got " + ShortRepr(item)).c_str());
    }
    objects.push_back(nb::cast<const SceneObject&>(item));
  }
  return objects;
}

class PyStartSampler : public PySamplerOf<StartSampler> {
 public:
  using PySamplerOf<StartSampler>::PySamplerOf;

  SceneSpec MakeBaseScene(int scene_index) override {
    return CallMethod<SceneSpec>(
        nb_trampoline, "make_base_scene", own(),
        [&](auto* s) { return s->StartSampler::MakeBaseScene(scene_index); }, scene_index);
  }
  bool PlaceObjects(const Support& support, std::vector<SceneObject>& objects, Rng& rng) override {
    const nb::detail::ticket call(nb_trampoline, "place_objects",
                                  nb::detail::str_hash("place_objects"), false);
    if (!call.key.is_valid()) return StartSampler::PlaceObjects(support, objects, rng);
    const RngLoan loan(rng);
    const nb::list list = ToList(objects);
    const nb::handle self = nb_trampoline.base();
    const bool placed =
        Returned<bool>(self, "place_objects", CallPython(self, "place_objects", [&] {
                         return nb::object(self.attr(call.key)(support, list, loan.rng()));
                       }));
    std::vector<SceneObject> moved =
        ConvertReturned(self, "place_objects", [&] { return FromList(list); });
    const auto same_name = [](const SceneObject& a, const SceneObject& b) {
      return a.name == b.name;
    };
    if (!std::equal(moved.begin(), moved.end(), objects.begin(), objects.end(), same_name)) {
      throw HookError(
          "StartSampler: place_objects() must not change which objects there are nor their "
          "order, only their poses",
          PlaceOfMethod(self, "place_objects"));
    }
    objects = std::move(moved);
    return placed;
  }
  BasePlacement ChooseBasePlacement(const SampleRequest& request, Rng& rng) override {
    const RequestLoan lent_request(request);
    return CallWithRng<BasePlacement>(
        nb_trampoline, "choose_base_placement", own(),
        [&](auto* s) { return s->StartSampler::ChooseBasePlacement(request, rng); }, rng,
        lent_request.request());
  }
  std::optional<Pose> ProposeBasePose(const Robot& robot, const Support& support,
                                      const Pose& target, const BasePlacement& placement,
                                      Rng& rng) override {
    return CallWithRng<std::optional<Pose>>(
        nb_trampoline, "propose_base_pose", own(),
        [&](auto* s) {
          return s->StartSampler::ProposeBasePose(robot, support, target, placement, rng);
        },
        rng, robot, support, target, placement);
  }
  std::optional<Refusal> ValidateBasePose(Scene& scene, Robot& robot,
                                          const std::string& target_body) override {
    return CallMethod<std::optional<Refusal>>(
        nb_trampoline, "validate_base_pose", own(),
        [&](auto* s) { return s->StartSampler::ValidateBasePose(scene, robot, target_body); },
        scene, robot, target_body);
  }
  std::optional<Refusal> ValidateCameras(Scene& scene, const std::string& target_body) override {
    return CallMethod<std::optional<Refusal>>(
        nb_trampoline, "validate_cameras", own(),
        [&](auto* s) { return s->StartSampler::ValidateCameras(scene, target_body); }, scene,
        target_body);
  }
  std::shared_ptr<Task> MakeTask() override {
    const nb::detail::ticket call(nb_trampoline, "make_task", nb::detail::str_hash("make_task"),
                                  false);
    if (!call.key.is_valid()) return StartSampler::MakeTask();
    const nb::handle self = nb_trampoline.base();
    nb::object made =
        CallPython(self, "make_task", [&] { return nb::object(self.attr(call.key)()); });
    if (!nb::isinstance<Task>(made)) ThrowReturned(self, "make_task", "a Task", made);
    return ConvertReturned(made, "__init__", [&] { return Shared<Task>(made); });
  }

 private:
  StartSampler* own() { return this; }
};

void BindPlaces(nb::module_& m) {
  nb::class_<Support>(m, "Support", "A level rectangle that objects are put on.")
      .def(
          "__init__",
          [](Support* self, const Pose& frame, double half_x, double half_y, double thickness) {
            new (self) Support{frame, half_x, half_y, thickness};
          },
          "frame_to_world"_a, "half_x"_a, "half_y"_a, "thickness"_a = 0.0)
      .def_ro("frame_to_world", &Support::frame_to_world, "Pose of its middle, z up.")
      .def_ro("half_x", &Support::half_x, "Half extent along its x axis, metres.")
      .def_ro("half_y", &Support::half_y, "Half extent along its y axis, metres.")
      .def_ro("thickness", &Support::thickness, "Depth of its body below the face, metres.");
  nb::class_<BasePlacement>(m, "BasePlacement", "Place of a robot's base relative to the target.")
      .def(
          "__init__",
          [](BasePlacement* self, double distance, double height) {
            const BasePlacement placement{distance, height};
            RequireFinite(placement);
            new (self) BasePlacement(placement);
          },
          "distance"_a, "height"_a)
      .def_ro("distance", &BasePlacement::distance, "Horizontal distance, metres.")
      .def_ro("height", &BasePlacement::height,
              "Height of the base's bottom above the target, metres.");
}

void BindStages(nb::module_& m) {
  nb::class_<StartSampler, TaskSampler, PyStartSampler>(
      m, "StartSampler",
      "Samples starts of a run, whatever its task: the objects that the task adds, settled on a "
      "support, and a robot beside the first of them.\n\nA subclass may replace sample() or any of "
      "the stages, which sample() calls in this order: make_base_scene, make_task, "
      "choose_base_placement, place_objects, place_objects, propose_base_pose, validate_base_pose, "
      "validate_cameras. The stages from the second place_objects on are repeated for each "
      "placement, and the two validations once more after the objects have settled; the task's "
      "check_start comes between them."
      "\n\nExamples:\n"
      "    >>> sampler = rc.tasks.StartSampler(run)\n"
      "    >>> start = sampler.sample(rc.tasks.SampleRequest(), rc.tasks.Rng.stream(0, "
      "\"start\"))\n"
      "    >>> if isinstance(start, rc.tasks.Refusal):\n"
      "    ...     print(start.reason)",
      nb::type_slots(sampler_slots))
      .def(nb::init<RunConfig>(), "run"_a)
      .def_prop_ro(
          "run", [](const StartSampler& s) { return s.run(); }, "A copy of the run.")
      .def(
          "sample",
          [](StartSampler& s, const SampleRequest& request, PythonRng& rng) {
            return SampleForPython(request, rng,
                                   [&](const SampleRequest& lent_request, Rng& stream) {
                                     return s.StartSampler::Sample(lent_request, stream);
                                   });
          },
          "request"_a, "rng"_a,
          nb::sig("def sample(self, request: SampleRequest, rng: Rng) -> EpisodeStart | Refusal"),
          "Returns a start, or a Refusal with its stage and reason.")
      .def(
          "make_base_scene",
          [](StartSampler& s, int scene) { return s.StartSampler::MakeBaseScene(scene); },
          "scene_index"_a, Unlocked(), "Returns the scene without objects and robot.")
      .def(
          "annotations", [](StartSampler& s, int scene) { return *s.AnnotationsOf(scene); },
          "scene_index"_a, Unlocked(),
          "Returns the SceneAnnotations of such a scene: those of its source (checked), else "
          "derived from the geometry.")
      .def(
          "choose_base_placement",
          [](StartSampler& s, const SampleRequest& request, PythonRng& rng) {
            return s.StartSampler::ChooseBasePlacement(request, rng.get());
          },
          "request"_a, "rng"_a, "Returns a place of the base relative to the target.")
      .def(
          "place_objects",
          [](StartSampler& s, const Support& support, const nb::list& list, PythonRng& rng) {
            std::vector<SceneObject> objects = FromList(list);
            Rng& stream = rng.get();
            bool placed = false;
            {
              const nb::gil_scoped_release unlocked;
              placed = s.StartSampler::PlaceObjects(support, objects, stream);
            }
            for (size_t i = 0; i < objects.size(); ++i)
              nb::cast<SceneObject&>(list[i]) = objects[i];
            return placed;
          },
          "support"_a, "objects"_a, "rng"_a,
          nb::sig("def place_objects(self, support: Support, objects: list[SceneObject], rng: Rng) "
                  "-> bool"),
          "Sets the objects' poses on the support. Returns False if there is no room.")
      .def(
          "propose_base_pose",
          [](StartSampler& s, const Robot& robot, const Support& support, const Pose& target,
             const BasePlacement& placement, PythonRng& rng) {
            Rng& stream = rng.get();
            const nb::gil_scoped_release unlocked;
            return s.StartSampler::ProposeBasePose(robot, support, target, placement, stream);
          },
          "robot"_a, "support"_a, "target_in_world"_a, "placement"_a, "rng"_a,
          "Returns a pose in the world for the bottom of the robot's base. Returns None if the "
          "robot, in its posture, is free nowhere around the target: of the scene, whose objects "
          "are "
          "in their places, and of the swing of doors. Then the objects are placed again.")
      .def(
          "validate_base_pose",
          [](StartSampler& s, Scene scene, Robot robot, const std::string& target_body) {
            const nb::gil_scoped_release release;
            return s.StartSampler::ValidateBasePose(scene, robot, target_body);
          },
          "scene"_a, "robot"_a, "target_body"_a,
          "Returns None if the robot is collision-free at its base pose and the target within its "
          "reach.")
      .def(
          "validate_cameras",
          [](StartSampler& s, Scene scene, const std::string& target_body) {
            const nb::gil_scoped_release release;
            return s.StartSampler::ValidateCameras(scene, target_body);
          },
          "scene"_a, "target_body"_a,
          "Returns None if the cameras of start.visible_from see enough of the target.")
      .def(
          "make_task", [](StartSampler& s) { return s.StartSampler::MakeTask(); },
          "Returns the task of the episode, one of the run's kind. It prepares the scene next.");
}

}  // namespace

void BindStartSampler(nb::module_& m) {
  BindPlaces(m);
  BindStages(m);
}

}  // namespace robocell::python
