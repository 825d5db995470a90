// Scene, what it is compiled to, and what its calls return.
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
  ImportMujoco();  // before the work is done
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

// What the argument of that name says; None for none.
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

// In parts, so that Ctrl-C is heard in between.
StepResult StepN(Scene& scene, int n) {
  constexpr int kPart = 64;
  SignalPoll poll;
  StepResult result = scene.StepN(std::min(n, kPart));
  while (result.ok() && result.steps < n) {
    poll();
    const int before = result.steps;
    result = scene.StepN(std::min(n - before, kPart));
    result.steps += before;
  }
  return result;
}

// A Pose or a PyKDL.Frame, or a position and a quaternion.
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
  nb::class_<StepResult>(m, "StepResult",
                         "How engine steps went. True when all is well; divergence is a value, no "
                         "exception.")
      .def_prop_ro("ok", &StepResult::ok)
      .def_prop_ro("diverged", [](const StepResult& r) { return !r.ok(); })
      .def_ro("steps", &StepResult::steps, "Engine steps done, a diverged one included.")
      .def_ro("time", &StepResult::time, "Simulated seconds after the last good step.")
      .def_ro("joint", &StepResult::joint, "Id of the first joint that shows it, else -1.")
      .def_ro("joint_name", &StepResult::joint_name, "Its name, '' when it has none.")
      .def_ro("message", &StepResult::message, "What diverged, '' when nothing did.")
      .def("__bool__", &StepResult::ok)
      .def("__repr__", [](const StepResult& r) {
        return r.ok() ? fmt::format("<StepResult ok, t={:g} s>", r.time)
                      : fmt::format("<StepResult {}>", r.message);
      });
}

void BindReset(nb::module_& m) {
  nb::class_<ResetOptions>(m, "ResetOptions", "How a scene is reset.")
      .def(
          "__init__",
          [](ResetOptions* self, std::optional<KeyframeChoice> keyframe, bool use_keyframe,
             std::optional<uint64_t> seed, nb::handle body_poses) {
            new (self)
                ResetOptions{std::move(keyframe), use_keyframe, seed, GivenBodyPoses(body_poses)};
          },
          nb::arg("keyframe") = nb::none(), nb::arg("use_keyframe") = true,
          nb::arg("seed") = nb::none(), nb::arg("body_poses") = nb::none(),
          nb::sig("def __init__(self, keyframe: int | str | collections.abc.Mapping[str, str] | "
                  "None = None, use_keyframe: bool = True, seed: int | None = None, body_poses: "
                  "collections.abc.Mapping[str, Pose] | None "
                  "= None) -> None"))
      .def_rw(
          "keyframe", &ResetOptions::keyframe, nb::arg("value").none(),
          "The keyframe: its number (0 is home) or its full name ('left_retract', with the "
          "prefix of its part), or {robot or object: the keyframe of its own model}; what is not "
          "named there is at home. None: the scene's home.")
      .def_rw("use_keyframe", &ResetOptions::use_keyframe,
              "False: the model's default configuration.")
      .def_rw("seed", &ResetOptions::seed, nb::arg("value").none(),
              "For the robots' home noise; None: no noise.")
      .def_prop_rw(
          "body_poses", [](const ResetOptions& o) { return ToDict(o.body_poses); },
          [](ResetOptions& o, nb::handle value) { o.body_poses = GivenBodyPoses(value); },
          nb::for_setter(nb::arg("value").none()),
          nb::for_getter(nb::sig("def body_poses(self, /) -> dict[str, Pose]")),
          nb::for_setter(nb::sig("def body_poses(self, value: "
                                 "collections.abc.Mapping[str, Pose] | None, /) -> None")),
          "{name: pose in the world} of free and mocap bodies that start elsewhere, at rest, "
          "whatever hooks do to them. A copy.")
      .def("__repr__", [](nb::handle options) {
        const nb::object poses = options.attr("body_poses");
        const nb::str more =
            nb::len(poses) == 0 ? nb::str("") : nb::str(", body_poses={}").format(poses);
        return nb::str("ResetOptions(keyframe={}, use_keyframe={}, seed={}{})")
            .format(options.attr("keyframe"), options.attr("use_keyframe"), options.attr("seed"),
                    more);
      });
  nb::class_<ResetInfo>(m, "ResetInfo", "What a reset started from.")
      .def_ro("used_keyframe", &ResetInfo::used_keyframe, "Whether it was a keyframe.")
      .def_ro("keyframe", &ResetInfo::keyframe,
              "Its number, else -1; home's when parts "
              "were given keyframes of their own.")
      .def("__repr__", [](const ResetInfo& info) {
        return fmt::format("ResetInfo(used_keyframe={}, keyframe={})",
                           info.used_keyframe ? "True" : "False", info.keyframe);
      });
  nb::class_<HookContext>(
      m, "ResetContext", "What a reset hook gets: it may change the scene's state through `scene`.",
      nb::type_slots(kHandleSlots<HookContext, &VisitContext>))
      .def_ro("scene", &HookContext::scene, "The scene that is being reset.", nb::rv_policy::copy)
      .def_ro("options", &HookContext::options, "What was asked for.", nb::rv_policy::copy)
      .def_ro("info", &HookContext::info, "What was restored.", nb::rv_policy::copy);
}

void BindContact(nb::module_& m) {
  nb::class_<Contact>(m, "Contact", "Two geoms that touch.")
      .def_ro("geom1", &Contact::geom1, "Full name, or 'body/geom#i' when unnamed.")
      .def_ro("geom2", &Contact::geom2, "Full name, or 'body/geom#i' when unnamed.")
      .def_ro("body1", &Contact::body1, "Body of geom1.")
      .def_ro("body2", &Contact::body2, "Body of geom2.")
      .def_ro("distance", &Contact::distance, "Metres, negative when they penetrate.")
      .def_prop_ro(
          "position",
          [](const Contact& c) {
            return NumberCopy({c.position.data(), 3});
          },
          "(3,) in the world, metres.")
      .def_prop_ro(
          "force",
          [](const Contact& c) {
            return NumberCopy({c.force.data(), 3});
          },
          "(3,) on body2, in the world, N.")
      .def("__repr__", [](const Contact& c) {
        return fmt::format("<Contact '{}' - '{}', {:.3g} m>", c.geom1, c.geom2, c.distance);
      });
}

void BindRecords(nb::module_& m) {
  nb::class_<RobotRecord>(m, "RobotRecord",
                          "What became of a robot of a SceneSpec. Names are full names in the "
                          "model.")
      .def_ro("name", &RobotRecord::name,
              "As resolved: RobotSpec.name, else its prefix, else robot, robot_1, ...")
      .def_ro("prefix", &RobotRecord::prefix, "What its names in the model begin with.")
      .def(
          "copy_config", [](const RobotRecord& r) { return RobotConfig(r.config); },
          "A copy of its configuration, an empty one for a robot without.")
      .def(
          "copy_base", [](const RobotRecord& r) { return BaseConfig(r.base); },
          "A copy of what it stands on: the spec's, else the configuration's.")
      .def_ro("top_body", &RobotRecord::top_body, "Its highest body: its base, or its root.")
      .def_ro("root_body", &RobotRecord::root_body, "Its frame is the robot base frame.")
      .def_ro("base_body", &RobotRecord::base_body,
              "What it stands on, pedestal included: its subtree is the robot.")
      .def_ro("mocap_body", &RobotRecord::mocap_body,
              "At the pedestal's bottom; None without a mocap base.")
      .def_ro("pedestal_height", &RobotRecord::pedestal_height,
              "From the mocap body to the root body's mount, m.")
      .def_ro("attachment_site", &RobotRecord::attachment_site, "Where tools go; None for none.")
      .def_ro("tcp_site", &RobotRecord::tcp_site,
              "The site made for attachment_site * tcp_offset; None unless both are configured.")
      .def("__repr__", [](const RobotRecord& r) { return "<RobotRecord '" + r.name + "'>"; });
  nb::class_<ObjectRecord>(m, "ObjectRecord",
                           "What became of an object of a SceneSpec. Names are full names in the "
                           "model.")
      .def_ro("name", &ObjectRecord::name)
      .def_ro("root_body", &ObjectRecord::root_body)
      .def_ro("free_joint", &ObjectRecord::free_joint, "None when it is fixed.")
      .def_prop_ro(
          "parked",
          [](const ObjectRecord& o) {
            return o.pool ? std::optional(o.pool->parked) : std::nullopt;
          },
          "Whether it is out of the scene after a reset; None for an object that is not of the "
          "pool.")
      .def("__repr__", [](const ObjectRecord& o) { return "<ObjectRecord '" + o.name + "'>"; });
}

void BindCompiled(nb::module_& m) {
  nb::class_<CompiledScene>(
      m, "CompiledScene",
      "The model made from a SceneSpec, with its names. freeze() makes it shareable: "
      "Scene.from_compiled gives scenes that step independently on one model.")
      .def("freeze", &Freeze,
           "Share the model between scenes and refuse writes to it from now on: its arrays become "
           "read-only. What a scene before left in its pool and control modes is undone; Error "
           "while "
           "a scene lives that changed these.\n\nmujoco's single numbers (model.opt.timestep) and "
           "access by name "
           "(model.geom('g').rgba) cannot be locked; do not write to them.")
      .def_prop_ro("frozen", &CompiledScene::frozen)
      .def_prop_ro("model", &ModelOf, nb::sig("def model(self, /) -> mujoco.MjModel"),
                   "The mujoco.MjModel, shared without a copy.")
      .def_prop_ro("warnings", &CompiledScene::warnings,
                   "What the parts asked for and did not get, and the engine's own warnings.")
      .def_prop_ro("engine_guards", &CompiledScene::engine_guards,
                   "Names of the known_engine_defects() that the model was guarded against.")
      .def_prop_ro("notes", &CompiledScene::notes,
                   "What is good to know and needs no change, such as lights that a part leaves "
                   "behind.")
      .def(
          "copy_spec", [](const CompiledScene& c) { return SceneSpec(c.spec()); },
          "A copy of the spec it was compiled from. Changing it changes nothing here; "
          "compile_scene makes another of it.")
      .def_prop_ro(
          "robots", [](const CompiledScene& c) { return c.robots(); },
          "What became of the robots, in the spec's order; copies.")
      .def_prop_ro(
          "objects", [](const CompiledScene& c) { return c.objects(); },
          "What became of the objects, in the spec's order; copies.")
      .def(
          "robot", [](const CompiledScene& c, const std::string& name) { return c.robot(name); },
          nb::arg("name"), "The record of one robot; NotFoundError tells the nearest names.")
      .def(
          "object", [](const CompiledScene& c, const std::string& name) { return c.object(name); },
          nb::arg("name"), "The record of one object; NotFoundError tells the nearest names.")
      .def("copy", &CompiledScene::Copy, Unlocked(),
           "The same with a model of its own, copied and not compiled, and not frozen: for a scene "
           "that writes to its model.")
      .def_prop_ro("generation", &CompiledScene::generation,
                   "A number that no other compiled scene of the process has.")
      .def_prop_ro("home_key", &CompiledScene::home_key, "Number of the home keyframe.");
  m.def("compile_scene", &Compile, nb::arg("spec"), nb::kw_only(), nb::arg("cache") = false,
        "Compile a scene once, for several Scene.from_compiled. SpecError, NotFoundError and "
        "EngineError as Scene.build.\n\ncache: keep the compiled scene on the disk, so that the "
        "next process with the same spec, files and versions reads it in milliseconds. A folder, "
        "or True for ROBOCELL_CACHE_DIR/scenes, else ~/.cache/robocell/scenes.");
}

void DefStepping(nb::class_<Scene>& c) {
  c.def("time", &Scene::time, "Simulated seconds.")
      .def("timestep", &Scene::timestep, "Seconds per engine step.")
      .def("keyframes", &Scene::keyframes,
           "Names of the scene's keyframes by their numbers: 'home', then those of the parts' own "
           "models, each with its part's prefix.")
      .def("step", &Scene::Step, Unlocked(), "One engine step.")
      .def("step_n", &StepN, nb::arg("n"), Unlocked(),
           "n engine steps; ends early when the state diverges, and at Ctrl-C. ArgumentError for "
           "a negative n.")
      .def("forward", &Scene::Forward, Unlocked(),
           "Recompute what follows from qpos, qvel and ctrl. Call it after writing to `data`, and "
           "after writing to `model` for poses and `robot.chain` to have it.")
      .def("reset", &Reset, nb::arg("options") = nb::none(), nb::kw_only(),
           nb::arg("keyframe") = nb::none(), nb::arg("use_keyframe") = true,
           nb::arg("seed") = nb::none(), nb::arg("body_poses") = nb::none(),
           nb::sig("def reset(self, options: ResetOptions | None = None, *, keyframe: int | str | "
                   "collections.abc.Mapping[str, str] | None = None, use_keyframe: bool = True, "
                   "seed: int | None = None, body_poses: "
                   "collections.abc.Mapping[str, Pose] | None = None) -> ResetInfo"),
           "Restore the keyframe (home unless given) or the default configuration, add the robots' "
           "home noise (with a seed), put free and mocap bodies at their `body_poses`, call the "
           "hooks, clear stale forces.\n\n"
           "keyframe: a number, a full name, or {robot or object: keyframe of its own model} (see "
           "`keyframes()`). "
           "The trajectory after a reset does not depend on what was before. What a hook raises is "
           "raised after the reset was ended as if there were no hooks; reset() in a hook is an "
           "Error.")
      .def(
          "on_reset",
          [](Scene& s, nb::callable hook) {
            TrackScene(s);
            return s.AddResetHook(PythonHook{Callback(std::move(hook))});
          },
          nb::arg("hook"),
          nb::sig("def on_reset(self, hook: collections.abc.Callable[[ResetContext], typing.Any]) "
                  "-> int"),
          "Call hook(ResetContext) in every reset, after the keyframe and before the robots take "
          "their targets from what it leaves. Returns an id for remove_reset_hook.")
      .def("remove_reset_hook", &Scene::RemoveResetHook, nb::arg("id"),
           "Call the hook of this id no more; NotFoundError for an id that there is not.")
      .def("clear_reset_hooks", &Scene::ClearResetHooks, "Call none of the hooks any more.");
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
  c.def("add_object", &AddObject, nb::arg("object"), nb::arg("pos") = nb::none(),
        nb::arg("quat") = nb::none(),
        nb::sig("def add_object(self, object: SceneObject | str, pos: Pose | "
                "numpy.typing.ArrayLike | None = None, quat: numpy.typing.ArrayLike | None = None) "
                "-> None"),
        "Add an object to the running scene, by compiling the spec with it.\n\n"
        "Everything else goes on as it was, to the bit: state, time, controls, applied forces, "
        "what was written to `model`. Robots, groups, controllers, cameras, recorders and hooks "
        "follow by name. `model` and `data` are new objects; ones that you kept stay valid and are "
        "the old ones. The object stands where a reset would put it, and later resets, `spec` and "
        "saved files have it. An error (SpecError, ArgumentError for a name that is taken, Error "
        "when the compiled scene is frozen) leaves the scene as it was.\n\n"
        "Objects of the pool (`parked` is set in the spec) are added and removed within "
        "microseconds, nothing is compiled and `model` and `data` stay: by name, with the pose of "
        "the root body in the world (a Pose, or position and quaternion xyzw) unless it is the "
        "spec's, or as SceneObject. A reset puts the pool back as the spec says.")
      .def("remove_object", &Scene::RemoveObject, nb::arg("name"), Unlocked(),
           "Take an object away, as add_object adds one. NotFoundError lists the objects; "
           "ArgumentError tells what is attached to it.")
      .def_prop_ro("object_names", &Scene::object_names, "Of the objects that are there now.")
      .def_prop_ro("parked_objects", &Scene::parked_objects,
                   "Of the objects of the pool that are not there now.");
}

void DefFrames(nb::class_<Scene>& c) {
  c.def("body_pose", &Scene::body_pose, nb::arg("name"), "Pose of a body in the world.")
      .def("site_pose", &Scene::site_pose, nb::arg("name"), "Pose of a site in the world.")
      .def("camera_pose", &Scene::camera_pose, nb::arg("name"),
           "Pose of a camera in the world, MuJoCo's axes: x right, y up, looking along -z.")
      .def(
          "body_frame", [](const Scene& s, const std::string& n) { return ToKdl(s.body_pose(n)); },
          nb::arg("name"), nb::sig("def body_frame(self, name: str) -> typing.Any"),
          "body_pose as a PyKDL.Frame.")
      .def(
          "site_frame", [](const Scene& s, const std::string& n) { return ToKdl(s.site_pose(n)); },
          nb::arg("name"), nb::sig("def site_frame(self, name: str) -> typing.Any"),
          "site_pose as a PyKDL.Frame.")
      .def(
          "set_body_pose",
          [](Scene& s, const std::string& name, nb::handle pos, nb::handle quat) {
            s.SetBodyPose(name, ToPose(pos, quat));
          },
          nb::arg("name"), nb::arg("pos"), nb::arg("quat") = nb::none(),
          nb::sig("def set_body_pose(self, name: str, pos: Pose | numpy.typing.ArrayLike, quat: "
                  "numpy.typing.ArrayLike | None = None) -> None"),
          "Move a free or mocap body (a Pose or PyKDL.Frame, or position and quaternion xyzw) and "
          "stop it.")
      .def_prop_ro("root_frame_to_world", &Scene::root_frame_to_world)
      .def_prop_ro("shared_base_frame_to_world", &Scene::shared_base_frame_to_world)
      .def("body_names", &Scene::body_names)
      .def("joint_names", &Scene::joint_names)
      .def("camera_names", &Scene::camera_names)
      .def("joint_pos", &Scene::joint_pos, nb::arg("name"),
           "Position of a hinge (rad) or slide (m) of whatever is in the scene; ArgumentError for "
           "free and ball joints.");
}

void DefActuation(nb::class_<Scene>& c) {
  c.def("has_actuator", &Scene::has_actuator, nb::arg("name"))
      .def("actuator_ctrl", &Scene::actuator_ctrl, nb::arg("name"),
           "Raw control value; an ArgumentError for an actuator of several inputs, which says "
           "where its "
           "controls stand in `data.ctrl`.")
      .def("set_actuator_ctrl", &Scene::SetActuatorCtrl, nb::arg("name"), nb::arg("value"),
           "Set a raw control value; NaN is refused, and so is an actuator of several inputs.")
      .def("set_body_wrench", &SetBodyWrench, nb::arg("body"), nb::arg("force"),
           nb::arg("torque") = nb::none(),
           nb::sig("def set_body_wrench(self, body: str, force: numpy.typing.ArrayLike | "
                   "typing.Any, torque: numpy.typing.ArrayLike | None = None) -> None"),
           "Force (3,) N and torque (3,) N m (0 unless given) in the world at the body's centre of "
           "mass, or a PyKDL.Wrench alone; kept until changed or reset. An ArgumentError for the "
           "world and for parked objects.")
      .def("contacts", &Scene::contacts, nb::arg("of") = "",
           "Active contacts, or those of one body's subtree, as the last step or forward() found "
           "them: the poses that other functions return are one step newer.")
      .def(
          "state", [](const Scene& s) { return NumberCopy(s.state()); },
          nb::sig("def state(self) -> numpy.typing.NDArray[numpy.float64]"),
          "Everything the engine needs to go on bit-equally, a copy.")
      .def(
          "set_state",
          [](Scene& s, nb::handle state) { s.SetState(Numbers(state, FieldPath("state"))); },
          nb::arg("state"), nb::sig("def set_state(self, state: numpy.typing.ArrayLike) -> None"),
          "Go on from what state() returned. What robots were told (their ports, their "
          "controllers' "
          "targets) is no part of it: the next update drives them there.");
}

void DefSharing(nb::class_<Scene>& c) {
  c.def_prop_ro(
       "model", [](const Scene& s) { return ModelOf(*s.compiled()); },
       nb::sig("def model(self, /) -> mujoco.MjModel"),
       "The mujoco.MjModel that is simulated, no copy. After writing to it call forward().")
      .def_prop_ro(
          "data", &DataOf, nb::sig("def data(self, /) -> mujoco.MjData"),
          "The mujoco.MjData that is simulated, no copy. One that you keep after the scene "
          "was rebuilt or closed is the old data. After writing to it call forward().")
      .def_prop_ro("compiled", [](const Scene& s) { return s.compiled(); })
      .def_prop_ro(
          "spec",
          [](const Scene&) -> nb::object {
            throw nb::attribute_error(
                "a Scene has no `spec` that could be changed. copy_spec() gives a copy of what it "
                "was built from: change that and build a scene of it with Scene.build; "
                "add_object, remove_object and model change the scene that runs");
          },
          nb::sig("def spec(self, /) -> typing.NoReturn"),
          "There is none to write to: AttributeError, see copy_spec().")
      .def(
          "copy_spec", [](const Scene& s) { return SceneSpec(s.spec()); },
          "A copy of the spec the scene was built from, with the objects that came and went since. "
          "Changing it changes no scene; Scene.build makes one of it.")
      .def_prop_ro("name", [](const Scene& s) { return s.name(); })
      .def_prop_ro(
          "warnings", [](const Scene& s) { return s.compiled()->warnings(); },
          "What the parts asked for and did not get, and the engine's own warnings.")
      .def_prop_ro(
          "engine_guards", [](const Scene& s) { return s.compiled()->engine_guards(); },
          "Names of the known_engine_defects() that the model was guarded against.")
      .def_prop_ro(
          "notes", [](const Scene& s) { return s.compiled()->notes(); },
          "What is good to know and needs no change, such as lights that a part leaves behind.")
      .def_prop_ro("generation", &Scene::generation, "Grows with every rebuild.")
      .def(
          "save_xml", [](const Scene& s, const Path& path) { s.SaveXml(path.string()); },
          nb::arg("path"), Unlocked(),
          "An MJCF file that stock MuJoCo loads; assets by absolute path.")
      .def(
          "save_binary", [](const Scene& s, const Path& path) { s.SaveBinary(path.string()); },
          nb::arg("path"), Unlocked(), "An .mjb file that stock MuJoCo loads, exact.")
      .def("to_xml", &Scene::ToXml, Unlocked(), "The MJCF text.");
}

void DefRobots(nb::class_<Scene>& c) {
  c.def(
       "robot", [](const Scene& s, const std::string& name) { return Robot::Of(s, name); },
       nb::arg("name"), Unlocked(), nb::sig("def robot(self, name: str) -> Robot"),
       "A configured robot by its name; NotFoundError lists the robots.")
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
        "The package mujoco; an Error says what keeps it from being imported.");
  nb::class_<Scene> c(
      m, "Scene",
      "A simulation that is alive. A handle: copies share the simulation, which lives as long as "
      "any of them.\n\nPoses are world poses; metres, seconds, radians, quaternions xyzw. One "
      "scene, with its robots, renderers and all else that belongs to it, is used by one thread at "
      "a time: what a second thread asks of it during a call is an Error. Raises NotFoundError for "
      "unknown names and ClosedError after close().",
      nb::type_slots(kHandleSlots<Scene, &VisitScene>), nb::is_weak_referenceable());
  // By a call that every scene that is open answers.
  GuardHandle<Scene>(
      c, [](const Scene& s, SceneClaims& claims) { claims.Add(s); },
      [](const Scene& s) { s.time(); },
      {.always = {"name", "__eq__", "__hash__", "__enter__"},
       .closed = {"close", "closed", "__exit__"}});
  c.def_static("build", &Build, nb::arg("spec"),
               "Compile a SceneSpec and reset it. SpecError lists all that is wrong with the spec; "
               "EngineError has the engine's text.");
  c.def_static(
      "from_compiled", &FromCompiled, nb::arg("compiled"),
      "A simulation of its own on a compiled model; an Error when another scene uses it and "
      "it is not frozen.");
  DefStepping(c);
  DefObjects(c);
  DefFrames(c);
  DefActuation(c);
  DefSharing(c);
  DefRobots(c);
  c.def("close", &Scene::Close, "Let go of model and data now. Nothing must be closed.")
      .def_prop_ro("closed", &Scene::closed)
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
