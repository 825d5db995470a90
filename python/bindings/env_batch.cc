// Copies of one environment as flat arrays. robocell.gym turns them into a vector environment.
#include "robocell/env/env_batch.h"

#include <fmt/format.h>

#include "arrays.h"
#include "bindings.h"
#include "cameras.h"
#include "env.h"
#include "features.h"
#include "handles.h"
#include "in_use.h"
#include "python_hooks.h"
#include "signals.h"
#include "values.h"
#include "robocell/env/env.h"
#include "robocell/features/cell_features.h"

namespace robocell::python {

using namespace nb::literals;

std::string Place(const EnvBatch& batch) {
  return "batch of environment '" + batch.config().name + "'";
}

namespace {

using Seeds = std::vector<std::optional<uint64_t>>;

size_t CopyCount(const EnvBatch& batch) { return static_cast<size_t>(batch.size()); }

nb::tuple FlatRange(const VectorRange& range) {
  return nb::make_tuple(NumberCopy(range.lower), NumberCopy(range.upper));
}

nb::object Observations(const EnvBatch& batch) {
  return NumberCopy(batch.observations(),
                    {CopyCount(batch), batch.observations().size() / CopyCount(batch)});
}

// Joins one image of each copy, one after another.
template <class T>
std::vector<T> Joined(EnvBatch& batch, size_t stream, std::vector<T> CellImage::*image) {
  std::vector<T> all;
  for (int i = 0; i < batch.size(); ++i) {
    const std::vector<T>& one = batch.env(i).frames()[stream].*image;
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

// Returns the frame of a stream of all copies: like that of one, with the copies as the first axis.
nb::dict BatchFrame(EnvBatch& batch, size_t stream) {
  std::vector<double> intrinsics, extrinsics, time;
  for (int i = 0; i < batch.size(); ++i) {
    const CellImage& frame = batch.env(i).frames()[stream];
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> in = frame.camera.intrinsics();
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> ex = frame.camera.extrinsics();
    intrinsics.insert(intrinsics.end(), in.data(), in.data() + in.size());
    extrinsics.insert(extrinsics.end(), ex.data(), ex.data() + ex.size());
    time.push_back(frame.time);
  }
  const CellImage& first = batch.env(0).frames()[stream];
  const auto n = CopyCount(batch), h = static_cast<size_t>(first.height),
             w = static_cast<size_t>(first.width);
  nb::dict out;
  const auto add = [&](const char* kind, const nb::object& data) {
    nb::dict image;
    image["data"] = data;
    image["intrinsics"] = NumberCopy(intrinsics, {n, 3, 3});
    image["extrinsics"] = NumberCopy(extrinsics, {n, 4, 4});
    out[kind] = image;
  };
  if (!first.rgb.empty())
    add("rgb", NewArray<uint8_t>(Joined(batch, stream, &CellImage::rgb), {n, h, w, 3}));
  if (!first.depth_mm.empty())
    add("depth", NewArray<uint16_t>(Joined(batch, stream, &CellImage::depth_mm), {n, h, w, 1}));
  if (!first.bodies.empty())
    add("segmentation",
        NewArray<int32_t>(BodyIds(Joined(batch, stream, &CellImage::bodies)), {n, h, w, 1}));
  out["time"] = NumberCopy(time, {n, 1});
  return out;
}

// Adds images of one kind, with the copies as the first axis.
template <class T>
void PutImages(EnvBatch& batch, size_t stream, std::vector<T> CellImage::*image,
               const std::string& name, std::vector<size_t> shape, nb::dict& out) {
  if ((batch.env(0).frames()[stream].*image).empty()) return;
  shape.insert(shape.begin(), CopyCount(batch));
  out[name.c_str()] = NewArray<T>(Joined(batch, stream, image), shape);
}

// Returns {name: (count, ...) numbers or images} in the order of the features.
nb::object BatchRow(EnvBatch& batch) {
  const InUse use(batch, &Place, "read");
  EnvBatch::RowsByName rows;
  {
    const nb::gil_scoped_release release;
    rows = batch.Row();
  }
  nb::dict out;
  for (const Feature& feature : batch.env(0).features().observed().features()) {
    const std::string& name = feature.column.name;
    std::vector<size_t> shape = {CopyCount(batch)};
    shape.insert(shape.end(), feature.column.shape.begin(), feature.column.shape.end());
    out[name.c_str()] = NewArray<double>(std::move(rows.at(name)), shape);
  }
  const std::vector<CellImage>& frames = batch.env(0).frames();
  for (size_t i = 0; i < frames.size(); ++i) {
    const auto h = static_cast<size_t>(frames[i].height), w = static_cast<size_t>(frames[i].width);
    PutImages(batch, i, &CellImage::rgb, frames[i].name, {h, w, 3}, out);
    PutImages(batch, i, &CellImage::depth_mm, frames[i].name + ".depth", {h, w}, out);
    PutImages(batch, i, &CellImage::bodies, frames[i].name + ".segmentation", {h, w}, out);
  }
  return NamedRow(out);
}

nb::dict BatchFrames(EnvBatch& batch) {
  nb::dict out;
  const std::vector<CellImage>& frames = batch.env(0).frames();
  for (size_t i = 0; i < frames.size(); ++i) out[frames[i].name.c_str()] = BatchFrame(batch, i);
  return out;
}

// Returns a picture of each copy: (count, H, W, 3).
nb::object Pictures(EnvBatch& batch, nb::handle camera, int width, int height) {
  const CameraView view = ViewOf(batch.env(0).scene().model(), camera, Place(batch));
  const InUse use(batch, &Place, "drawn");
  std::vector<uint8_t> rgb;
  {
    const nb::gil_scoped_release release;
    rgb = batch.Draw(view, width, height);
  }
  return NewArray<uint8_t>(
      rgb, {CopyCount(batch), static_cast<size_t>(height), static_cast<size_t>(width), 3});
}

// Converts {name: (count, n) numbers}, with commands of one number also as (count,).
EnvBatch::RowsByName ToCommands(EnvBatch& batch, const nb::dict& values) {
  const FeatureSchema commanded = batch.env(0).features().commanded();
  const FieldPath path("actions");
  EnvBatch::RowsByName commands;
  for (const auto& [key, value] : values) {
    const std::string name = ToText(key, path);
    const auto width = static_cast<size_t>(commanded.Find(name).size());
    const FieldPath of_name(path, name);
    nb::object rows = nb::borrow(value);
    if (width == 1 && nb::cast<int>(nb::module_::import_("numpy").attr("ndim")(rows)) == 1)
      rows = nb::module_::import_("numpy").attr("reshape")(rows, nb::make_tuple(-1, 1));
    commands[name] = ToMatrix(rows, of_name, CopyCount(batch), width);
  }
  return commands;
}

// Throws ArgumentError for {"left": {"joints": ...}}, the actions of an environment.
void RequireNoRobots(EnvBatch& batch, const nb::dict& actions) {
  for (const RobotLayout& robot : batch.layout().robots) {
    if (!actions.contains(robot.robot.c_str())) continue;
    throw ArgumentError(fmt::format(
        "{}: actions are (count, n) numbers, or have the names of columns, such as '{}'; "
        "robocell.gym.VectorGymEnv takes '{}' and other robots",
        Place(batch), batch.env(0).features().commanded().features().front().column.name,
        robot.robot));
  }
}

const BatchStep& MakeStep(EnvBatch& batch, nb::handle actions,
                          const std::vector<bool>& reset_instead) {
  if (nb::hasattr(actions, "keys")) {
    nb::dict by_name;
    by_name.update(actions);
    if (!IsByName(by_name)) RequireNoRobots(batch, by_name);
    const EnvBatch::RowsByName commands = ToCommands(batch, by_name);
    const nb::gil_scoped_release release;
    return batch.Act(commands, reset_instead, SparsePoll());
  }
  const std::vector<double> numbers = ToMatrix(actions, FieldPath("actions"), CopyCount(batch),
                                               static_cast<size_t>(batch.layout().action.size()));
  const nb::gil_scoped_release release;
  return batch.Step(numbers, reset_instead, SparsePoll());
}

nb::tuple StepBatch(EnvBatch& batch, nb::handle actions, const std::vector<bool>& reset_instead) {
  const InUse use(batch, &Place, "stepped");
  const BatchStep* step = &MakeStep(batch, actions, reset_instead);
  const size_t n = CopyCount(batch);
  std::vector<double> time;
  nb::list reasons;
  for (const EnvStep& one : step->steps) {
    time.push_back(one.time);
    reasons.append(ToString(one.reason));
  }
  return nb::make_tuple(Observations(batch), NewArray<double>(step->reward, {n}),
                        NewArray<uint8_t>(step->terminated, {n}),
                        NewArray<uint8_t>(step->truncated, {n}), NewArray<double>(time, {n}),
                        reasons);
}

// Returns {robot: {key: (count,) array}} of each robot's remaining motion in the last step.
nb::dict BatchMotions(EnvBatch& batch) {
  nb::dict robots;
  std::vector<double> numbers(CopyCount(batch));
  const std::vector<RobotLayout>& layouts = batch.layout().robots;
  for (size_t robot = 0; robot < layouts.size(); ++robot) {
    nb::dict motion;
    for (const MotionField& field : kMotionFields) {
      for (int i = 0; i < batch.size(); ++i)
        numbers[static_cast<size_t>(i)] = batch.env(i).motions()[robot].*field.value;
      motion[field.name] = NewArray<double>(numbers, {numbers.size()});
    }
    for (int i = 0; i < batch.size(); ++i)
      numbers[static_cast<size_t>(i)] = batch.ik_success(i, robot);
    motion["ik_success"] = NewArray<double>(numbers, {numbers.size()}).attr("astype")("bool");
    robots[layouts[robot].robot.c_str()] = motion;
  }
  return robots;
}

// Returns a number of the verdict on each copy's last step: (count,).
template <class Out, class T>
nb::object BatchNumbers(const EnvBatch& batch, T TaskVerdict::*member) {
  std::vector<Out> numbers;
  for (int i = 0; i < batch.size(); ++i) numbers.push_back(batch.last_step(i).*member);
  return NewArray<Out>(numbers, {numbers.size()});
}

// The same as for one environment.
int TraverseBatch(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  if (!nb::inst_ready(self)) return 0;
  auto& batch = *nb::inst_ptr<EnvBatch>(self);
  for (int i = 0; i < batch.size(); ++i) {
    if (const int stop = VisitEnv(batch.env(i), visit, arg)) return stop;
  }
  return 0;
}

int ClearBatch(PyObject* self) {
  if (!nb::inst_ready(self)) return 0;
  auto& batch = *nb::inst_ptr<EnvBatch>(self);
  for (int i = 0; i < batch.size(); ++i) batch.env(i).DropTask();
  return 0;
}

PyType_Slot batch_slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(&TraverseBatch)},
                             {Py_tp_clear, reinterpret_cast<void*>(&ClearBatch)},
                             {0, nullptr}};

}  // namespace

void BindEnvBatch(nb::module_& m) {
  nb::class_<EnvBatch> batches(
      m, "EnvBatch",
      "Copies of one environment on one model, stepped together on threads, with flat arrays."
      "\n\nExamples:\n"
      "    >>> batch = rc.envs.EnvBatch(rc.EnvConfig.load(rc.models.cell_file(\"rc7\")), count=4)\n"
      "    >>> batch.reset(seeds=[0, 1, 2, 3]).shape[0]\n"
      "    4",
      nb::type_slots(batch_slots), nb::is_weak_referenceable());
  // Its threads claim the scenes of the copies that they work on.
  GuardHandle<EnvBatch>(
      batches, [](const EnvBatch& batch, SceneClaims&) { RequireIdle(batch, &Place); },
      [](const EnvBatch& batch) { batch.RequireOpen(); },
      {.always = {"count"}, .closed = {"close"}});
  batches
      .def(
          "__init__",
          [](EnvBatch* self, const EnvConfig& config, int count, int threads,
             std::optional<int> max_episode_steps) {
            const DataFactory factory = DataForHooks(HasPythonHooks(config));
            // Another thread may change the configuration while the lock is released.
            const EnvConfig copy = config;  // NOLINT(performance-unnecessary-copy-initialization)
            const nb::gil_scoped_release release;
            new (self) EnvBatch(copy, count, threads, max_episode_steps, factory);
          },
          "config"_a, "count"_a, "threads"_a = 0, "max_episode_steps"_a = nb::none())
      .def_prop_ro("count", &EnvBatch::size, "Number of copies.")
      .def_prop_ro(
          "observed", [](const EnvBatch& batch) { return FeatureList(batch.layout().observed); },
          nb::sig("def observed(self, /) -> list[Feature]"),
          "Features of the observations, as in Env.observed.")
      .def_prop_ro(
          "commanded", [](const EnvBatch& batch) { return FeatureList(batch.layout().commanded); },
          nb::sig("def commanded(self, /) -> list[Feature]"),
          "Features of the actions, as in Env.commanded.")
      .def_prop_ro(
          "action_parts", [](const EnvBatch& batch) { return ActionParts(batch.layout()); },
          nb::sig("def action_parts(self, /) -> tuple[tuple[tuple[str, ...], int, int], "
                  "...]"),
          "(path in an action's dictionaries, first column, number of columns) of each "
          "part.")
      .def_prop_ro(
          "observation_parts",
          [](const EnvBatch& batch) { return ObservationParts(batch.layout()); },
          nb::sig("def observation_parts(self, /) -> tuple[tuple[tuple[str, ...], int, "
                  "int], ...]"),
          "(path in an observation's dictionaries, first column, number of columns) of each part.")
      .def_prop_ro(
          "action_range", [](const EnvBatch& batch) { return FlatRange(batch.layout().action); },
          nb::sig("def action_range(self, /) -> tuple[numpy.typing.NDArray[numpy.float64], "
                  "numpy.typing.NDArray[numpy.float64]]"),
          "The range of a copy's actions: (lower, upper), flat, each (n,).")
      .def_prop_ro(
          "observation_range",
          [](const EnvBatch& batch) { return FlatRange(batch.layout().observation); },
          nb::sig("def observation_range(self, /) -> tuple[numpy.typing.NDArray[numpy.float64], "
                  "numpy.typing.NDArray[numpy.float64]]"),
          "The range of a copy's observations: (lower, upper), flat, each (m,).")
      .def_prop_ro("instructions", &EnvBatch::instructions,
                   "The instruction of each copy's task, in words; '' without a task.")
      .def(
          "close",
          [](EnvBatch& batch) {
            const InUse use(batch, &Place, "closed");
            batch.Close();
          },
          "Closes all copies and their threads; may be repeated."
          "\n\nExamples:\n"
          "    >>> batch = rc.envs.EnvBatch(rc.EnvConfig.load(rc.models.cell_file(\"rc7\")), "
          "count=2)\n"
          "    >>> batch.close()")
      .def_prop_ro(
          "scene", [](EnvBatch& batch) { return batch.env(0).scene(); },
          "The simulation of the first copy, for looking up elements.")
      .def("render", &Pictures, "camera"_a.none(), "width"_a = 320, "height"_a = 240,
           nb::sig("def render(self, camera: str | OrbitCamera | FreeCamera | TrackingCamera, "
                   "width: int = 320, height: int = 240) -> numpy.typing.NDArray[numpy.uint8]"),
           "Renders a picture of each copy's present state (count, H, W, 3); `camera` as in "
           "Renderer.render.")
      .def_prop_ro("frames", &BatchFrames, nb::sig("def frames(self, /) -> dict[str, typing.Any]"),
                   "The last frames of all copies by stream, as in Env with the copies in front.")
      .def_prop_ro(
          "motions", &BatchMotions,
          nb::sig("def motions(self, /) -> dict[str, dict[str, "
                  "numpy.typing.NDArray[typing.Any]]]"),
          "The remaining motion of each robot at the end of the last step, as info['robots'] of "
          "Env.step with an array (count,) for each number; zeros after a reset.")
      .def_prop_ro(
          "progress",
          [](const EnvBatch& batch) { return BatchNumbers<double>(batch, &EnvStep::progress); },
          nb::sig("def progress(self, /) -> numpy.typing.NDArray[numpy.float64]"),
          "The task's progress in each copy at the end of the last step, (count,), from 0 to 1; 0 "
          "after a reset.")
      .def_prop_ro(
          "subtasks",
          [](const EnvBatch& batch) { return BatchNumbers<int32_t>(batch, &EnvStep::subtask); },
          nb::sig("def subtasks(self, /) -> numpy.typing.NDArray[numpy.int32]"),
          "The index (count,) of the subtask of each copy's task.")
      .def(
          "reset",
          [](EnvBatch& batch, const Seeds& seeds, const std::vector<bool>& which,
             const std::optional<KeyframeChoice>& keyframe) {
            const InUse use(batch, &Place, "reset");
            {
              const nb::gil_scoped_release release;
              batch.Reset(seeds, which, keyframe);
            }
            return Observations(batch);
          },
          "seeds"_a = Seeds{}, "which"_a = std::vector<bool>{}, "keyframe"_a = nb::none(),
          nb::sig("def reset(self, seeds: collections.abc.Sequence[int | None] = (), which: "
                  "collections.abc.Sequence[bool] = (), keyframe: int | str | "
                  "collections.abc.Mapping[str, int | str] | None = None) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          "Resets all copies, or those where `which` is true, to home or to a keyframe (see "
          "Scene.reset). Returns all observations (count, m).")
      .def(
          "row", &BatchRow, nb::sig("def row(self) -> dict[str, numpy.typing.NDArray[typing.Any]]"),
          "Returns the present state of all copies by the names of columns in datasets, as Env.row "
          "with the copies as the first axis."
          "\n\nExamples:\n"
          "    >>> batch = rc.envs.EnvBatch(rc.EnvConfig.load(rc.models.cell_file(\"rc7\")), "
          "count=2)\n"
          "    >>> start = batch.reset(seeds=[0, 1])\n"
          "    >>> target = batch.row()[\"robots/robot/arm/target\"]\n"
          "    >>> target.shape\n"
          "    (2, 7)\n"
          "    >>> step = batch.step({\"robots/robot/action/arm\": target + 0.01})")
      .def(
          "step", &StepBatch, "actions"_a, "reset_instead"_a = std::vector<bool>{},
          nb::sig("def step(self, actions: numpy.typing.ArrayLike | collections.abc.Mapping[str, "
                  "numpy.typing.ArrayLike], reset_instead: "
                  "collections.abc.Sequence[bool] = ()) -> "
                  "tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], "
                  "numpy.typing.NDArray[numpy.uint8], numpy.typing.NDArray[numpy.uint8], "
                  "numpy.typing.NDArray[numpy.float64], list[str]]"),
          "Steps all copies, except those where `reset_instead` is true, which begin their next "
          "episode. Returns (observations (count, m), rewards, terminated, truncated, time since "
          "the reset, reasons). `actions` are (count, n) numbers, or, as in Env.step, by the names "
          "of action columns in datasets: {'robots/left/action/arm': (count, n) numbers}. Ctrl-C "
          "ends it halfway. After an error during the step, or Ctrl-C, "
          "reset all copies."
          "\n\nExamples:\n"
          "    >>> batch = rc.envs.EnvBatch(rc.EnvConfig.load(rc.models.cell_file(\"rc7\")), "
          "count=2)\n"
          "    >>> start = batch.reset(seeds=[0, 1])\n"
          "    >>> lower, upper = batch.action_range\n"
          "    >>> observations, rewards, *ends = batch.step(np.stack([lower, lower]))\n"
          "    >>> rewards.shape\n"
          "    (2,)");
}

}  // namespace robocell::python
