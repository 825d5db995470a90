// Scene, its compiled form, and the results of its calls.
#include "robocell/scene/scene.h"

#include <algorithm>
#include <filesystem>
#include <variant>

#include <fmt/format.h>
#include <nanobind/operators.h>

#include "bindings.h"
#include "body_poses.h"
#include "handles.h"
#include "kinematics.h"
#include "python_owner.h"
#include "scene_cycles.h"
#include "scene_sharing.h"
#include "signals.h"
#include "values.h"
#include "robocell/base/error.h"
#include "robocell/robot/robot.h"
#include "robocell/scene/scene_cache.h"

namespace robocell::python {
namespace {

using Path = std::filesystem::path;
using Unlocked = nb::call_guard<nb::gil_scoped_release>;

int VisitContext(const HookContext& context, visitproc visit, void* arg) {
  return VisitScene(context.scene, visit, arg);
}

// --- Calls ---------------------------------------------------------------------------------------

Scene Build(const SceneSpec& spec) {
  ImportMujoco();  // before the work starts
  // Another thread may change the spec while the lock is released.
  const SceneSpec copy = spec;  // NOLINT(performance-unnecessary-copy-initialization)
  const nb::gil_scoped_release release;
  return Scene::Build(copy, PythonData());
}

std::shared_ptr<CompiledScene> Compile(const SceneSpec& spec,
                                       const std::variant<bool, std::filesystem::path>& cache) {
  // Another thread may change the spec while the lock is released.
  const SceneSpec copy = spec;  // NOLINT(performance-unnecessary-copy-initialization)
  const nb::gil_scoped_release release;
  if (const auto* folder = std::get_if<std::filesystem::path>(&cache))
    return CompileSceneCached(copy, *folder);
  return std::get<bool>(cache) ? CompileSceneCached(copy) : CompileScene(copy);
}

Scene FromCompiled(std::shared_ptr<CompiledScene> compiled) {
  ImportMujoco();
  const nb::gil_scoped_release release;
  return Scene::FromCompiled(std::move(compiled), PythonData());
}

// Converts the argument of that name; empty for None.
BodyPoses GivenBodyPoses(nb::handle given) {
  return given.is_none() ? BodyPoses() : ToBodyPoses(given, FieldPath("body_poses"));
}

ResetInfo Reset(Scene& scene, const ResetOptions* options, std::optional<KeyframeChoice> keyframe,
                bool use_keyframe, std::optional<uint64_t> seed, nb::handle body_poses) {
  if (options && (keyframe || seed || !use_keyframe || !body_poses.is_none())) {
    throw ArgumentError(
        "reset: give either options or keyframe, use_keyframe, seed and body_poses");
  }
  const ResetOptions given =
      options ? *options
              : ResetOptions{std::move(keyframe), use_keyframe, seed, GivenBodyPoses(body_poses)};
  const nb::gil_scoped_release release;
  return scene.Reset(given);
}

// Steps in parts, so that Ctrl-C is handled in between.
StepResult StepN(Scene& scene, int n) {
  constexpr int kPart = 64;
  SignalPoll poll;
  StepResult result = scene.StepN(std::min(n, kPart));
  while (result.ok() && result.steps < n && result.steps > 0) {
    poll();
    const int before = result.steps;
    result = scene.StepN(std::min(n - before, kPart));
    const bool held = result.steps == 0;  // by a viewer that is paused
    result.steps += before;
    if (held) break;
  }
  return result;
}

// Accepts a Pose or a PyKDL.Frame, or a position and a quaternion.
Pose ToPose(nb::handle pose_or_pos, nb::handle quat) {
  const Pose* pose = nullptr;
  const bool is_pose = nb::try_cast(pose_or_pos, pose) && pose;
  if (is_pose || (nb::hasattr(pose_or_pos, "M") && nb::hasattr(pose_or_pos, "p"))) {
    if (!quat.is_none()) throw ArgumentError("quat: the pose has its rotation; leave quat out");
    return is_pose ? *pose : nb::cast<Pose>(nb::type<Pose>()(pose_or_pos));
  }
  const Numbers xyz(pose_or_pos, FieldPath("pos"), 3);
  if (quat.is_none()) return Pose(Eigen::Vector3d(xyz[0], xyz[1], xyz[2]));
  const Numbers q(quat, FieldPath("quat"), 4);
  return Pose({xyz[0], xyz[1], xyz[2]}, Quaternion{q[0], q[1], q[2], q[3]});
}

void SetBodyWrench(Scene& scene, const std::string& body, nb::handle force, nb::handle torque) {
  if (const auto wrench = torque.is_none() ? FromPyKdlWrench(force) : std::nullopt)
    return scene.SetBodyWrench(body, wrench->force, wrench->torque);
  const Numbers f(force, FieldPath("force"), 3);
  if (torque.is_none()) return scene.SetBodyWrench(body, {f[0], f[1], f[2]});
  const Numbers t(torque, FieldPath("torque"), 3);
  scene.SetBodyWrench(body, {f[0], f[1], f[2]}, {t[0], t[1], t[2]});
}

// --- Classes -------------------------------------------------------------------------------------

void BindStepResult(nb::module_& m) {
  nb::class_<StepResult>(
      m, "StepResult",
      "Result of engine steps. True if they did not diverge and no viewer's window was closed; "
      "neither raises an exception.")
      .def_prop_ro("ok", &StepResult::ok,
                   "True if no step diverged and the user closed no viewer of the scene.")
      .def_prop_ro(
          "diverged", [](const StepResult& r) { return r.status == StepResult::kDiverged; },
          "True if a step diverged; `message` describes how.")
      .def_prop_ro(
          "stopped", [](const StepResult& r) { return r.status == StepResult::kStopped; },
          "True if no step was made because the user closed the window of the scene's viewer.")
      .def_ro("steps", &StepResult::steps, "Number of engine steps made, including a diverged one.")
      .def_ro("time", &StepResult::time, "Simulated seconds after the last good step.")
      .def_ro("joint", &StepResult::joint, "Id of the first joint that diverged, else -1.")
      .def_ro("joint_name", &StepResult::joint_name, "Name of that joint, '' without a name.")
      .def_ro("message", &StepResult::message, "Description of the divergence, '' without one.")
      .def("__bool__", &StepResult::ok)
      .def("__repr__", [](const StepResult& r) {
        return r.ok() ? fmt::format("<StepResult ok, t={:g} s>", r.time)
                      : fmt::format("<StepResult {}>", r.message);
      });
}

void BindReset(nb::module_& m) {
  nb::class_<ResetOptions>(m, "ResetOptions", "Options of a reset.")
      .def(
          "__init__",
          [](ResetOptions* self, std::optional<KeyframeChoice> keyframe, bool use_keyframe,
             std::optional<uint64_t> seed, nb::handle body_poses) {
            new (self)
                ResetOptions{std::move(keyframe), use_keyframe, seed, GivenBodyPoses(body_poses)};
          },
          nb::arg("keyframe") = nb::none(), nb::arg("use_keyframe") = true,
          nb::arg("seed") = nb::none(), nb::arg("body_poses") = nb::none(),
          nb::sig(
              "def __init__(self, keyframe: int | str | collections.abc.Mapping[str, int | str] | "
              "None = None, use_keyframe: bool = True, seed: int | None = None, body_poses: "
              "collections.abc.Mapping[str, Pose] | None "
              "= None) -> None"))
      .def_rw("keyframe", &ResetOptions::keyframe, nb::arg("value").none(),
              "The keyframe: its number (0 is home) or its full name with the prefix of its part "
              "('left_retract'). Alternatively {robot or object: keyframe of its own model}, by "
              "name or by number (0 is home); all others start at home. 'left: retract' is the "
              "text for one of them. None: the scene's home.")
      .def_rw("use_keyframe", &ResetOptions::use_keyframe,
              "False: the model's default configuration.")
      .def_rw("seed", &ResetOptions::seed, nb::arg("value").none(),
              "Seed of the robots' home noise; None: no noise.")
      .def_prop_rw(
          "body_poses", [](const ResetOptions& o) { return ToDict(o.body_poses); },
          [](ResetOptions& o, nb::handle value) { o.body_poses = GivenBodyPoses(value); },
          nb::for_setter(nb::arg("value").none()),
          nb::for_getter(nb::sig("def body_poses(self, /) -> dict[str, Pose]")),
          nb::for_setter(nb::sig("def body_poses(self, value: "
                                 "collections.abc.Mapping[str, Pose] | None, /) -> None")),
          "{name: pose in the world} of free and mocap bodies that start elsewhere, at rest. They "
          "override hooks. Returns a copy.")
      .def("__repr__", [](nb::handle options) {
        const nb::object poses = options.attr("body_poses");
        const nb::str more =
            nb::len(poses) == 0 ? nb::str("") : nb::str(", body_poses={}").format(poses);
        return nb::str("ResetOptions(keyframe={}, use_keyframe={}, seed={}{})")
            .format(options.attr("keyframe"), options.attr("use_keyframe"), options.attr("seed"),
                    more);
      });
  nb::class_<ResetInfo>(m, "ResetInfo", "The start of a reset.")
      .def_ro("used_keyframe", &ResetInfo::used_keyframe, "True if the start was a keyframe.")
      .def_ro("keyframe", &ResetInfo::keyframe,
              "Number of the keyframe, else -1; home's if parts had their own keyframes.")
      .def("__repr__", [](const ResetInfo& info) {
        return fmt::format("ResetInfo(used_keyframe={}, keyframe={})",
                           info.used_keyframe ? "True" : "False", info.keyframe);
      });
  nb::class_<HookContext>(
      m, "ResetContext",
      "The argument of a reset hook, which may change the scene's state through `scene`.",
      nb::type_slots(kHandleSlots<HookContext, &VisitContext>))
      .def_ro("scene", &HookContext::scene, "The scene that is being reset.", nb::rv_policy::copy)
      .def_ro("options", &HookContext::options, "The options of the reset.", nb::rv_policy::copy)
      .def_ro("info", &HookContext::info, "The restored start.", nb::rv_policy::copy);
}

void BindContact(nb::module_& m) {
  nb::class_<Contact>(m, "Contact", "Two geoms that touch.")
      .def_ro("geom1", &Contact::geom1, "Full name of the geom, or 'body/geom#i' without a name.")
      .def_ro("geom2", &Contact::geom2, "Full name of the geom, or 'body/geom#i' without a name.")
      .def_ro("body1", &Contact::body1, "Body of geom1.")
      .def_ro("body2", &Contact::body2, "Body of geom2.")
      .def_ro("distance", &Contact::distance, "Distance in metres, negative for penetration.")
      .def_prop_ro(
          "position",
          [](const Contact& c) {
            return NumberCopy({c.position.data(), 3});
          },
          "Position (3,) in the world, metres.")
      .def_prop_ro(
          "force",
          [](const Contact& c) {
            return NumberCopy({c.force.data(), 3});
          },
          "Force (3,) on body2, in the world, N.")
      .def("__repr__", [](const Contact& c) {
        return fmt::format("<Contact '{}' - '{}', {:.3g} m>", c.geom1, c.geom2, c.distance);
      });
}

void BindRecords(nb::module_& m) {
  nb::class_<RobotRecord>(
      m, "RobotRecord",
      "A robot of a SceneSpec in the compiled model. Names are full names in the model.")
      .def_ro("name", &RobotRecord::name,
              "The resolved name: RobotSpec.name, else its prefix, else robot, robot_1, ...")
      .def_ro("prefix", &RobotRecord::prefix, "Prefix of its names in the model.")
      .def(
          "copy_config", [](const RobotRecord& r) { return RobotConfig(r.config); },
          "A copy of its configuration; an empty one without a configuration.")
      .def(
          "copy_base", [](const RobotRecord& r) { return BaseConfig(r.base); },
          "A copy of its base: the spec's, else the configuration's.")
      .def_ro("top_body", &RobotRecord::top_body, "Its highest body: its base, or its root.")
      .def_ro("root_body", &RobotRecord::root_body,
              "The root body, whose frame is the robot base frame.")
      .def_ro("base_body", &RobotRecord::base_body,
              "The base body, including the pedestal; its subtree is the robot.")
      .def_ro("mocap_body", &RobotRecord::mocap_body,
              "The mocap body at the pedestal's bottom; None without a mocap base.")
      .def_ro("pedestal_height", &RobotRecord::pedestal_height,
              "Height from the mocap body to the root body's mount, m.")
      .def_ro("attachment_site", &RobotRecord::attachment_site,
              "Site where tools go; None without one.")
      .def_ro("tcp_site", &RobotRecord::tcp_site,
              "The site made for attachment_site * tcp_offset; None unless both are configured.")
      .def("__repr__", [](const RobotRecord& r) { return "<RobotRecord '" + r.name + "'>"; });
  nb::class_<ObjectRecord>(
      m, "ObjectRecord",
      "An object of a SceneSpec in the compiled model. Names are full names in the model.")
      .def_ro("name", &ObjectRecord::name, "Name of the object, as in SceneSpec.objects.")
      .def_ro("root_body", &ObjectRecord::root_body, "The root body of the object.")
      .def_ro("free_joint", &ObjectRecord::free_joint, "The free joint; None for a fixed object.")
      .def_prop_ro(
          "parked",
          [](const ObjectRecord& o) {
            return o.pool ? std::optional(o.pool->parked) : std::nullopt;
          },
          "True if a reset leaves the object outside the scene; None for an object that is not in "
          "the pool.")
      .def("__repr__", [](const ObjectRecord& o) { return "<ObjectRecord '" + o.name + "'>"; });
}

void BindCompiled(nb::module_& m) {
  nb::class_<CompiledScene>(
      m, "CompiledScene",
      "The model made from a SceneSpec, with its names. freeze() makes it shareable: "
      "Scene.from_compiled then makes scenes that step independently on one model.")
      .def(
          "freeze", &Freeze,
          "Shares the model between scenes and rejects writes to it from now on: its arrays become "
          "read-only. Changes of an earlier scene to its pool and control modes are undone; raises "
          "Error while a scene lives that changed these.\n\nmujoco's scalars (model.opt.timestep) "
          "and access by name (model.geom('g').rgba) cannot be locked; do not write to them.")
      .def_prop_ro("frozen", &CompiledScene::frozen, "True after freeze().")
      .def_prop_ro("model", &ModelOf, nb::sig("def model(self, /) -> mujoco.MjModel"),
                   "The mujoco.MjModel, shared without a copy.")
      .def_prop_ro("warnings", &CompiledScene::warnings,
                   "Settings of parts that were ignored, and the engine's warnings.")
      .def_prop_ro("engine_guards", &CompiledScene::engine_guards,
                   "Names of the known_engine_defects() that the model is guarded against.")
      .def_prop_ro("notes", &CompiledScene::notes,
                   "Information that needs no change, such as lights of a part that are left out.")
      .def(
          "copy_spec", [](const CompiledScene& c) { return SceneSpec(c.spec()); },
          "Returns a copy of the spec. Changing the copy does not change this scene; compile it "
          "with compile_scene.")
      .def_prop_ro(
          "robots", [](const CompiledScene& c) { return c.robots(); },
          "Records of the robots, in the spec's order; copies.")
      .def_prop_ro(
          "objects", [](const CompiledScene& c) { return c.objects(); },
          "Records of the objects, in the spec's order; copies.")
      .def(
          "robot", [](const CompiledScene& c, const std::string& name) { return c.robot(name); },
          nb::arg("name"),
          "Returns the record of one robot. Raises NotFoundError with the nearest names.")
      .def(
          "object", [](const CompiledScene& c, const std::string& name) { return c.object(name); },
          nb::arg("name"),
          "Returns the record of one object. Raises NotFoundError with the nearest names.")
      .def("copy", &CompiledScene::Copy, Unlocked(),
           "Returns a copy with its own model, which is not frozen: for a scene that writes to its "
           "model. Nothing is compiled.")
      .def_prop_ro("generation", &CompiledScene::generation,
                   "A number that no other compiled scene of the process has.")
      .def_prop_ro("home_key", &CompiledScene::home_key, "Number of the home keyframe.");
  m.def("compile_scene", &Compile, nb::arg("spec"), nb::kw_only(), nb::arg("cache") = false,
        "Compiles a scene once, for several Scene.from_compiled. Raises SpecError, NotFoundError "
        "and EngineError as Scene.build.\n\ncache: keeps the compiled scene on disk, so that the "
        "next process with the same spec, files and versions reads it in milliseconds. A folder, "
        "or True for ROBOCELL_CACHE_DIR/scenes, else ~/.cache/robocell/scenes."
        "\n\nExamples:\n"
        "    >>> compiled = rc.scene.compile_scene(spec)\n"
        "    >>> compiled.freeze()\n"
        "    >>> scenes = [rc.Scene.from_compiled(compiled) for _ in range(4)]");
}

void DefStepping(nb::class_<Scene>& c) {
  c.def("time", &Scene::time,
        "Returns the simulated time, seconds."
        "\n\nExamples:\n"
        "    >>> scene.time()\n"
        "    0.0")
      .def("timestep", &Scene::timestep,
           "Returns the timestep of the engine, seconds."
           "\n\nExamples:\n"
           "    >>> scene.timestep()\n"
           "    0.002")
      .def("keyframes", &Scene::keyframes,
           "Returns the names of the scene's keyframes by their numbers: 'home', then those of the "
           "parts' models, each with its part's prefix.")
      .def("step", &Scene::Step, Unlocked(),
           "Makes one engine step."
           "\n\nExamples:\n"
           "    >>> scene.step().ok\n"
           "    True")
      .def("step_n", &StepN, nb::arg("n"), Unlocked(),
           "Makes n engine steps. Ends early if the state diverges, and at Ctrl-C. Raises "
           "ArgumentError for a negative n."
           "\n\nExamples:\n"
           "    >>> scene.step_n(500).diverged\n"
           "    False")
      .def("forward", &Scene::Forward, Unlocked(),
           "Recomputes everything that follows from qpos, qvel and ctrl. Call it after writing to "
           "`data`, and after writing to `model` to update poses and `robot.chain`.")
      .def("reset", &Reset, nb::arg("options") = nb::none(), nb::kw_only(),
           nb::arg("keyframe") = nb::none(), nb::arg("use_keyframe") = true,
           nb::arg("seed") = nb::none(), nb::arg("body_poses") = nb::none(),
           nb::sig(
               "def reset(self, options: ResetOptions | None = None, *, keyframe: int | str | "
               "collections.abc.Mapping[str, int | str] | None = None, use_keyframe: bool = True, "
               "seed: int | None = None, body_poses: "
               "collections.abc.Mapping[str, Pose] | None = None) -> ResetInfo"),
           "Restores the keyframe (default: home) or the default configuration, adds the robots' "
           "home noise (with a seed), puts free and mocap bodies at their `body_poses`, calls the "
           "hooks, clears stale forces.\n\nkeyframe: a number, a full name, or {robot or object: "
           "keyframe of its own model} (see `keyframes()`). The trajectory after a reset does not "
           "depend on anything before. An exception of a hook is raised after the reset ended as "
           "if there were no hooks; reset() in a hook is an Error."
           "\n\nExamples:\n"
           "    >>> info = scene.reset()\n"
           "    >>> scene.time()\n"
           "    0.0")
      .def(
          "on_reset",
          [](Scene& s, nb::callable hook) {
            TrackScene(s);
            return s.AddResetHook(PythonHook{Callback(std::move(hook))});
          },
          nb::arg("hook"),
          nb::sig("def on_reset(self, hook: collections.abc.Callable[[ResetContext], typing.Any]) "
                  "-> int"),
          "Calls hook(ResetContext) in every reset, after the keyframe and before the robots take "
          "their targets from the result. Returns an id for remove_reset_hook."
          "\n\nExamples:\n"
          "    >>> resets = []\n"
          "    >>> hook = scene.on_reset(lambda context: resets.append(context.info))\n"
          "    >>> info = scene.reset()\n"
          "    >>> len(resets)\n"
          "    1")
      .def("remove_reset_hook", &Scene::RemoveResetHook, nb::arg("id"),
           "Removes the hook of this id. Raises NotFoundError for an unknown id.")
      .def("clear_reset_hooks", &Scene::ClearResetHooks, "Removes all hooks.");
}

using ObjectOrName = std::variant<std::string, const SceneObject*>;

void AddObject(Scene& scene, const ObjectOrName& what, nb::handle pos, nb::handle quat) {
  if (const auto* name = std::get_if<std::string>(&what)) {
    std::optional<Pose> pose;
    if (!pos.is_none()) pose = ToPose(pos, quat);
    if (pos.is_none() && !quat.is_none()) throw ArgumentError("add_object: give pos with quat");
    const nb::gil_scoped_release release;
    return scene.AddObject(*name, pose);
  }
  if (!pos.is_none() || !quat.is_none()) {
    throw ArgumentError(
        "add_object: a SceneObject has its own pose; pos and quat are for objects of the pool that "
        "are added by name");
  }
  const SceneObject* object = std::get<const SceneObject*>(what);
  if (!object) {
    throw nb::type_error(
        "Scene.add_object(): `object` must be a SceneObject or the name of one of the pool, got "
        "None");
  }
  ImportMujoco();
  // Another thread may change the spec while the lock is released.
  const SceneObject copy = *object;
  const nb::gil_scoped_release release;
  scene.AddObject(copy);
}

void DefObjects(nb::class_<Scene>& c) {
  c.def(
       "add_object", &AddObject, nb::arg("object"), nb::arg("pos") = nb::none(),
       nb::arg("quat") = nb::none(),
       nb::sig("def add_object(self, object: SceneObject | str, pos: Pose | "
               "numpy.typing.ArrayLike | None = None, quat: numpy.typing.ArrayLike | None = None) "
               "-> None"),
       "Adds an object to the running scene, by compiling the spec with it.\n\nEverything else "
       "continues as before, to the bit: state, time, controls, applied forces, changes to "
       "`model`. Robots, groups, controllers, cameras, recorders and hooks follow by name. `model` "
       "and `data` are new objects; old ones that you kept stay valid. The object stands where a "
       "reset would put it, and later resets, `spec` and saved files include it. An error "
       "(SpecError, ArgumentError for a name that is taken, Error if the compiled scene is frozen) "
       "leaves the scene as it was.\n\nObjects of the pool (`parked` is set in the spec) are added "
       "and removed within microseconds; nothing is compiled, and `model` and `data` stay. Give a "
       "name, with the pose of the root body in the world (a Pose, or position and quaternion "
       "xyzw) unless it is the spec's, or a SceneObject. A reset restores the pool of the spec."
       "\n\nExamples:\n"
       "    >>> scene.add_object(rc.SceneObject(name=\"nut\", mjcf_path=\"nut\", pos=[0.4, 0.2, "
       "0.05]))\n"
       "    >>> scene.object_names\n"
       "    ['cube', 'nut']")
      .def("remove_object", &Scene::RemoveObject, nb::arg("name"), Unlocked(),
           "Removes an object, as add_object adds one. Raises NotFoundError with the objects, "
           "ArgumentError with the parts attached to it.\n\nExamples:\n"
           "    >>> scene.remove_object(\"cube\")\n"
           "    >>> scene.object_names\n"
           "    []")
      .def_prop_ro("object_names", &Scene::object_names,
                   "Names of the objects in the scene."
                   "\n\nExamples:\n"
                   "    >>> scene.object_names\n"
                   "    ['cube']")
      .def_prop_ro("parked_objects", &Scene::parked_objects,
                   "Names of the objects of the pool that are not in the scene.");
}

void DefFrames(nb::class_<Scene>& c) {
  c.def("body_pose", &Scene::body_pose, nb::arg("name"),
        "Returns the pose of a body in the world."
        "\n\nExamples:\n"
        "    >>> scene.body_pose(\"cube\").translation\n"
        "    array([0.5 , 0.  , 0.02])")
      .def("site_pose", &Scene::site_pose, nb::arg("name"),
           "Returns the pose of a site in the world."
           "\n\nExamples:\n"
           "    >>> scene.site_pose(\"tcp\").translation.shape\n"
           "    (3,)")
      .def("camera_pose", &Scene::camera_pose, nb::arg("name"),
           "Returns the pose of a camera in the world, in MuJoCo's axes: x right, y up, looking "
           "along -z.")
      .def(
          "body_frame", [](const Scene& s, const std::string& n) { return ToKdl(s.body_pose(n)); },
          nb::arg("name"), nb::sig("def body_frame(self, name: str) -> typing.Any"),
          "Returns body_pose as a PyKDL.Frame.")
      .def(
          "site_frame", [](const Scene& s, const std::string& n) { return ToKdl(s.site_pose(n)); },
          nb::arg("name"), nb::sig("def site_frame(self, name: str) -> typing.Any"),
          "Returns site_pose as a PyKDL.Frame.")
      .def(
          "set_body_pose",
          [](Scene& s, const std::string& name, nb::handle pos, nb::handle quat) {
            s.SetBodyPose(name, ToPose(pos, quat));
          },
          nb::arg("name"), nb::arg("pos"), nb::arg("quat") = nb::none(),
          nb::sig("def set_body_pose(self, name: str, pos: Pose | numpy.typing.ArrayLike, quat: "
                  "numpy.typing.ArrayLike | None = None) -> None"),
          "Moves a free or mocap body (a Pose or PyKDL.Frame, or position and quaternion xyzw) and "
          "stops it."
          "\n\nExamples:\n"
          "    >>> scene.set_body_pose(\"cube\", rc.Pose(translation=[0.4, 0.1, 0.02]))")
      .def_prop_ro("root_frame_to_world", &Scene::root_frame_to_world,
                   "Pose of the root frame, that of the rig, in the world.")
      .def_prop_ro("shared_base_frame_to_world", &Scene::shared_base_frame_to_world,
                   "Pose of the shared base frame in the world.")
      .def("body_names", &Scene::body_names,
           "Returns the names of all bodies."
           "\n\nExamples:\n"
           "    >>> \"cube\" in scene.body_names()\n"
           "    True")
      .def("joint_names", &Scene::joint_names,
           "Returns the names of all joints."
           "\n\nExamples:\n"
           "    >>> scene.joint_names()[:2]\n"
           "    ['cube_joint', 'joint1']")
      .def("camera_names", &Scene::camera_names,
           "Returns the names of all cameras."
           "\n\nExamples:\n"
           "    >>> scene.camera_names()\n"
           "    ['exo_camera', 'wrist_camera']")
      .def("joint_pos", &Scene::joint_pos, nb::arg("name"),
           "Returns the position of any hinge (rad) or slide (m) in the scene. Raises "
           "ArgumentError for free and ball joints."
           "\n\nExamples:\n"
           "    >>> scene.joint_pos(\"joint1\")\n"
           "    0.0");
}

void DefActuation(nb::class_<Scene>& c) {
  c.def("has_actuator", &Scene::has_actuator, nb::arg("name"),
        "Returns True if there is an actuator of this name.")
      .def("actuator_ctrl", &Scene::actuator_ctrl, nb::arg("name"),
           "Returns the raw control value. ArgumentError for an actuator of several inputs says "
           "where its controls are in `data.ctrl`.")
      .def("set_actuator_ctrl", &Scene::SetActuatorCtrl, nb::arg("name"), nb::arg("value"),
           "Sets a raw control value. NaN and actuators of several inputs are rejected.")
      .def("set_body_wrench", &SetBodyWrench, nb::arg("body"), nb::arg("force"),
           nb::arg("torque") = nb::none(),
           nb::sig("def set_body_wrench(self, body: str, force: numpy.typing.ArrayLike | "
                   "typing.Any, torque: numpy.typing.ArrayLike | None = None) -> None"),
           "Applies a force (3,) N and a torque (3,) N m (default 0) in the world at the body's "
           "centre of mass, or a PyKDL.Wrench alone, until changed or reset. Raises ArgumentError "
           "for the world and for parked objects.")
      .def("contacts", &Scene::contacts, nb::arg("of") = "",
           "Returns active contacts, or those of one body's subtree, of the last step or "
           "forward(). The poses that other functions return are one step newer."
           "\n\nExamples:\n"
           "    >>> [scene.step_n(10) for _ in range(10)][-1].ok\n"
           "    True\n"
           "    >>> scene.contacts(\"cube\")[0].distance < 0.001\n"
           "    True")
      .def(
          "state", [](const Scene& s) { return NumberCopy(s.state()); },
          nb::sig("def state(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Returns a copy (n,) of everything that the engine needs to continue to the bit."
          "\n\nExamples:\n"
          "    >>> saved = scene.state()\n"
          "    >>> scene.step_n(100).ok\n"
          "    True\n"
          "    >>> scene.set_state(saved)\n"
          "    >>> scene.time()\n"
          "    0.0")
      .def(
          "set_state",
          [](Scene& s, nb::handle state) { s.SetState(Numbers(state, FieldPath("state"))); },
          nb::arg("state"), nb::sig("def set_state(self, state: numpy.typing.ArrayLike) -> None"),
          "Continues from a state that state() returned. It excludes the robots' commands (ports, "
          "controllers' targets), so the next update drives the robots to those.");
}

void DefSharing(nb::class_<Scene>& c) {
  c.def_prop_ro(
       "model", [](const Scene& s) { return ModelOf(*s.compiled()); },
       nb::sig("def model(self, /) -> mujoco.MjModel"),
       "The simulated mujoco.MjModel, not a copy. Call forward() after writing to it."
       "\n\nExamples:\n"
       "    >>> scene.model.nq\n"
       "    16")
      .def_prop_ro("data", &DataOf, nb::sig("def data(self, /) -> mujoco.MjData"),
                   "The simulated mujoco.MjData, not a copy. If you keep it after the scene was "
                   "rebuilt or closed, it is the old data. Call forward() after writing to it."
                   "\n\nExamples:\n"
                   "    >>> scene.data.qpos.shape\n"
                   "    (16,)")
      .def_prop_ro(
          "compiled", [](const Scene& s) { return s.compiled(); },
          "The CompiledScene that the scene runs at present.")
      .def_prop_ro(
          "spec",
          [](const Scene&) -> nb::object {
            throw nb::attribute_error(
                "a Scene has no `spec` that could be changed. copy_spec() gives a copy of what it "
                "was built from: change that and build a scene of it with Scene.build; "
                "add_object, remove_object and model change the scene that runs");
          },
          nb::sig("def spec(self, /) -> typing.NoReturn"),
          "Raises AttributeError: a scene has no spec to write to, see copy_spec().")
      .def(
          "copy_spec", [](const Scene& s) { return SceneSpec(s.spec()); },
          "Returns a copy of the scene's spec, with the objects added and removed since. Changing "
          "the copy changes no scene; build a new one with Scene.build."
          "\n\nExamples:\n"
          "    >>> other = rc.Scene.build(scene.copy_spec())")
      .def_prop_ro(
          "name", [](const Scene& s) { return s.name(); }, "Name of the scene in messages.")
      .def_prop_ro(
          "warnings", [](const Scene& s) { return s.compiled()->warnings(); },
          "Settings of parts that were ignored, and the engine's warnings.")
      .def_prop_ro(
          "engine_guards", [](const Scene& s) { return s.compiled()->engine_guards(); },
          "Names of the known_engine_defects() that the model is guarded against.")
      .def_prop_ro(
          "notes", [](const Scene& s) { return s.compiled()->notes(); },
          "Information that needs no change, such as lights of a part that are left out.")
      .def_prop_ro("generation", &Scene::generation, "A number that increases with every rebuild.")
      .def(
          "save_xml", [](const Scene& s, const Path& path) { s.SaveXml(path.string()); },
          nb::arg("path"), Unlocked(),
          "Writes an MJCF file that stock MuJoCo loads; assets have absolute paths.")
      .def(
          "save_binary", [](const Scene& s, const Path& path) { s.SaveBinary(path.string()); },
          nb::arg("path"), Unlocked(), "Writes an exact .mjb file that stock MuJoCo loads.")
      .def("to_xml", &Scene::ToXml, Unlocked(), "Returns the MJCF text.");
}

void DefRobots(nb::class_<Scene>& c) {
  c.def(
       "robot", [](const Scene& s, const std::string& name) { return Robot::Of(s, name); },
       nb::arg("name"), Unlocked(), nb::sig("def robot(self, name: str) -> Robot"),
       "Returns a configured robot by its name. Raises NotFoundError with the "
       "robots.\n\nExamples:\n"
       "    >>> scene.robot(\"arm\").arm.nq\n"
       "    7")
      .def_prop_ro(
          "robots", [](const Scene& s) { return RobotsOf(s); }, Unlocked(),
          nb::sig("def robots(self, /) -> list[Robot]"),
          "All robots that have a configuration, in order.");
}

}  // namespace

void BindScene(nb::module_& m) {
  BindStepResult(m);
  BindReset(m);
  BindContact(m);
  BindRecords(m);
  BindCompiled(m);
  m.def("import_mujoco", &ImportMujoco, nb::sig("def import_mujoco() -> types.ModuleType"),
        "Imports the package mujoco; Error has the reason if that is impossible.");
  nb::class_<Scene> c(
      m, "Scene",
      "A live simulation. A Scene is a handle: copies share the simulation, which lives as long as "
      "any of them.\n\nPoses are world poses; metres, seconds, radians, quaternions xyzw. One "
      "thread at a time uses a scene with its robots, renderers and everything else that belongs "
      "to it; a second thread gets an Error during a call. Raises NotFoundError for unknown names "
      "and ClosedError after close()."
      "\n\nExamples:\n"
      "    >>> scene = rc.Scene.build(spec)\n"
      "    >>> scene.step_n(500)\n"
      "    <StepResult ok, t=1 s>\n"
      "    >>> round(scene.time(), 3)\n"
      "    1.0",
      nb::type_slots(kHandleSlots<Scene, &VisitScene>), nb::is_weak_referenceable());
  // The guard of calls that need an open scene.
  GuardHandle<Scene>(
      c, [](const Scene& s, SceneClaims& claims) { claims.Add(s); },
      [](const Scene& s) { s.time(); },
      {.always = {"name", "__eq__", "__hash__", "__enter__"},
       .closed = {"close", "closed", "__exit__"}});
  c.def_static("build", &Build, nb::arg("spec"),
               "Compiles a SceneSpec and resets the scene. Raises SpecError with all problems of "
               "the spec, EngineError with the engine's message.\n\nExamples:\n"
               "    >>> with rc.Scene.build(spec) as scene:\n"
               "    ...     print(scene.object_names)\n"
               "    ['cube']");
  c.def_static("from_compiled", &FromCompiled, nb::arg("compiled"),
               "Makes a simulation on a compiled model. Raises Error if another scene uses the "
               "model and it is not frozen.");
  DefStepping(c);
  DefObjects(c);
  DefFrames(c);
  DefActuation(c);
  DefSharing(c);
  DefRobots(c);
  c.def("close", &Scene::Close, "Frees model and data now. Calling it is optional.")
      .def_prop_ro("closed", &Scene::closed, "True after close().")
      .def(nb::self == nb::self, "Handles to the same simulation are equal.")
      .def("__hash__", [](const Scene& s) { return s.id(); })
      .def("__enter__", [](nb::handle_t<Scene> self) { return nb::borrow(self); })
      .def("__exit__", [](Scene& s, nb::args) { s.Close(); })
      .def("__repr__", [](const Scene& s) {
        if (s.use().by_another_thread())
          return fmt::format("<Scene '{}', in use by another thread>", s.name());
        return s.closed() ? fmt::format("<Scene '{}', closed>", s.name())
                          : fmt::format("<Scene '{}', t={:g} s>", s.name(), s.time());
      });
}

}  // namespace robocell::python
