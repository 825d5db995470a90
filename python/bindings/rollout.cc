// Plans and the runner. A StopFlag, which signal handlers and other threads may set, interrupts a
// run.
#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>

#include <array>
#include <atomic>
#include <memory>

#include "bindings.h"
#include "in_use.h"
#include "python_hooks.h"
#include "python_owner.h"
#include "returned.h"
#include "sampler.h"
#include "signals.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/rollout/dataset_run.h"
#include "robocell/rollout/on_disk.h"
#include "robocell/rollout/plan.h"
#include "robocell/rollout/prepare.h"
#include "robocell/rollout/recorded_scene.h"
#include "robocell/rollout/replay.h"
#include "robocell/rollout/runner.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

struct StopFlag {
  std::atomic<bool> value{false};
};

void BindItemResult(nb::module_& m) {
  nb::class_<ItemResult>(m, "ItemResult",
                         "Result of one item of a plan."
                         "\n\nExamples:\n"
                         "    >>> rc.generate.prepare_dataset(run)\n"
                         "    >>> plan = rc.generate.make_plan(run)\n"
                         "    >>> result = rc.generate.Runner(run).run(plan[0])\n"
                         "    >>> result.success, sum(result.rollouts.values()), result.failures\n"
                         "    (True, 1, {})")
      .def_ro("item", &ItemResult::item, "The item of the plan.")
      .def_ro("committed", &ItemResult::committed, "True if an episode is on the disk.")
      .def_ro("complete", &ItemResult::complete, "True if the item needs no more attempts.")
      .def_ro("success", &ItemResult::success, "True if an attempt succeeded.")
      .def_ro("stopped", &ItemResult::stopped,
              "True if the stop flag ended it; nothing was stored then.")
      .def_ro("resumed", &ItemResult::resumed, "True if it was complete before.")
      .def_ro("kept", &ItemResult::kept, "Number of episodes written by this call.")
      .def_ro("attempts", &ItemResult::attempts, "Number of attempts that ended.")
      .def_ro("undecided", &ItemResult::undecided,
              "Number of attempts that the stop flag ended; they count nowhere else.")
      .def_ro("accepted", &ItemResult::accepted,
              "Number of attempts whose start the sampler accepted.")
      .def_ro("refusals", &ItemResult::refusals, "'stage: reason' -> count, of refused starts.")
      .def_ro("advice", &ItemResult::advice,
              "The most frequent reason of refused starts, and from where the robot would reach "
              "its object; '' if a start was accepted.")
      .def_ro("redrawn", &ItemResult::redrawn,
              "Reason -> count, of places for objects and robot that were rejected within the "
              "attempts; the sampler tried attempts + these.")
      .def_ro("failures", &ItemResult::failures, "Reason -> count, of failed rollouts.")
      .def_ro("failure", &ItemResult::failure, "Why the last rollout failed; '' if it succeeded.")
      .def_ro("robot", &ItemResult::robot, "Name of the robot.")
      .def_ro("object_kind", &ItemResult::object_kind,
              "Kind of the last attempt's target; '' if the sampler does not report it.")
      .def_ro("kinds", &ItemResult::kinds, "Object kind -> attempts.")
      .def_ro("rollouts", &ItemResult::rollouts, "Object kind -> rollouts.")
      .def_ro("rows", &ItemResult::rows,
              "Number of rows of the episode; without storing, of the last rollout.")
      .def_ro("seconds_sampling", &ItemResult::seconds_sampling, "Time for starts, seconds.")
      .def_ro("seconds_acting", &ItemResult::seconds_acting,
              "Time of expert, simulation and task, seconds.")
      .def_ro("seconds_rendering", &ItemResult::seconds_rendering,
              "Time that the rollout waited for images and encoders, seconds.")
      .def_ro("seconds_writing", &ItemResult::seconds_writing,
              "Time for writing rows and committing, seconds.")
      .def("__repr__", [](const ItemResult& r) {
        const char* end = r.stopped     ? "stopped"
                          : r.success   ? "success"
                          : r.committed ? "failures kept"
                                        : "nothing made";
        return fmt::format("<ItemResult {}: {}, {}, {}>", r.item.id, end,
                           Counted(r.attempts, "attempt"), Counted(r.rows, "row"));
      });
}

void BindReplay(nb::module_& m) {
  nb::class_<ReplayDifference>(m, "ReplayDifference",
                               "A difference between a replay and its record.")
      .def_ro("row", &ReplayDifference::row, "Row of the table steps.")
      .def_ro("tick", &ReplayDifference::tick, "Row of the table control.")
      .def_ro("time", &ReplayDifference::time, "Recorded time, seconds.")
      .def_ro("what", &ReplayDifference::what,
              "Description: joint 'joint3' of rc7/arm, object 'target' z.")
      .def_ro("column", &ReplayDifference::column, "The recorded column.")
      .def_ro("recorded", &ReplayDifference::recorded, "The recorded value, in `units`.")
      .def_ro("replayed", &ReplayDifference::replayed, "The value of the replay, in `units`.")
      .def_ro("units", &ReplayDifference::units, "Unit of both values.")
      .def_ro("others", &ReplayDifference::others,
              "Number of further values of the row that differ.");
  nb::class_<ReplayResult>(m, "ReplayResult", "Result of replaying an episode.")
      .def_ro("episode", &ReplayResult::episode, "Id of the episode.")
      .def_ro("rows", &ReplayResult::rows, "Number of rows without a difference.")
      .def_ro("ticks", &ReplayResult::ticks, "Number of control ticks without a difference.")
      .def_ro("first", &ReplayResult::first, "The first difference, or None.")
      .def_ro("versions", &ReplayResult::versions, "Versions that changed since, or ''.")
      .def_prop_ro("ok", &ReplayResult::ok, "True if nothing differs.")
      .def("__str__", &ReplayResult::Text)
      .def("__repr__", [](const ReplayResult& r) { return "<ReplayResult " + r.Text() + ">"; });
  m.def("recorded_scene", &RecordedScene, "episode"_a, nb::call_guard<nb::gil_scoped_release>(),
        "Returns the SceneSpec of a generated episode, with the models stored in its dataset. "
        "Raises ArgumentError if the episode does not contain it.");
  m.def("run_of_dataset", &RunOfDataset, "dataset"_a, nb::call_guard<nb::gil_scoped_release>(),
        "Returns the run that made a dataset, with the robot and the scene files that it keeps.\n\n"
        "Imports nothing: kinds of your own are registered before. Raises ArgumentError for a "
        "dataset that no run made, SpecError for kinds that nobody registered and for other code.");
  m.def("first_episode_of_run", &FirstEpisodeOfRun, "dataset"_a,
        "Returns the first episode. Raises ArgumentError if there is none, or if no run made it.");
  m.def(
      "plan_numbers",
      [](const std::vector<std::string>& ids) {
        nb::list numbers;
        for (const std::string& id : ids) {
          if (const auto found = NumbersOfId(id))
            numbers.append(nb::make_tuple(found->scene, found->episode));
        }
        return numbers;
      },
      "ids"_a,
      nb::sig("def plan_numbers(ids: collections.abc.Sequence[str]) -> list[tuple[int, int]]"),
      "Returns scene and episode of each id of a run's episode, such as (3, 1) of 's0003_e0001'.");
  m.def(
      "verify_replay",
      [](const Episode& episode, double tolerance) {
        return VerifyReplay(episode, {.tolerance = tolerance});
      },
      "episode"_a, "tolerance"_a = ReplayOptions{}.tolerance,
      nb::call_guard<nb::gil_scoped_release>(),
      "Simulates a generated episode again from its start with its recorded controls, and compares "
      "joints, objects and clock. Stops at the first row or tick in which a value differs by more "
      "than the tolerance (m, rad, m/s, rad/s, s).");
}

// The factory's arguments and its result may be kept: the arguments are copies that share scene and
// task, the expert lives as long as either side uses it.
std::function<std::shared_ptr<Expert>(const RunConfig&, const EpisodeStart&)> MakeExpertFactory(
    const SharedKeeper& factory) {
  if (!*factory) return {};
  return [factory](const RunConfig& run, const EpisodeStart& start) {
    const nb::gil_scoped_acquire gil;
    nb::object made = CallMaker(ObjectOf(*factory), nb::cast(run), nb::cast(start));
    if (!nb::isinstance<Expert>(made)) {
      ThrowReturned("Runner: expert()", "an Expert", made, PlaceOfCode(ObjectOf(*factory)));
    }
    return ConvertReturned(made, "__init__", [&] { return Shared<Expert>(made); });
  };
}

std::string PlaceOfRunner(const Runner& runner) { return "runner of '" + runner.run().run + "'"; }

// A runner that the collector can traverse. Functions and classes of a script refer to the script's
// variables, and the runner is often among them: otherwise this cycle lives until the process ends,
// and nanobind reports it as leaked.
class PythonRunner : public Runner {
 public:
  PythonRunner(const RunConfig& run, SharedKeeper expert, SharedKeeper sampler, bool stores,
               SharedKeeper made = ShareKeeper(nb::none()))
      : Runner(run, {.sampler = MakeSamplerFactory(sampler, made),
                     .expert = MakeExpertFactory(expert),
                     .scene_data = DataForHooks(*expert || *sampler || HasPythonHooks(run)),
                     .stores = stores}),
        kept_{std::move(expert), std::move(sampler), std::move(made)} {}

  static int Traverse(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    if (!nb::inst_ready(self)) return 0;
    const PythonRunner& runner = *nb::inst_ptr<PythonRunner>(self);
    for (const SharedKeeper& keeper : runner.kept_) Py_VISIT(TargetOf(*keeper));
    if (UseByOthers(static_cast<const Runner*>(&runner))) return 0;  // it changes without the GIL
    return VisitSampler(runner.sampler(), visit, arg);
  }
  static int Clear(PyObject* self) {
    if (!nb::inst_ready(self)) return 0;
    auto& runner = *nb::inst_ptr<PythonRunner>(self);
    runner.DropSampler();
    for (const SharedKeeper& keeper : runner.kept_) keeper->reset();
    return 0;
  }

 private:
  std::array<SharedKeeper, 3> kept_;  // the functions, and the sampler that one of them has made
};

PyType_Slot runner_slots[] = {{Py_tp_traverse, reinterpret_cast<void*>(&PythonRunner::Traverse)},
                              {Py_tp_clear, reinterpret_cast<void*>(&PythonRunner::Clear)},
                              {0, nullptr}};

}  // namespace

void BindRollout(nb::module_& m) {
  nb::class_<PlanItem>(m, "PlanItem", "One episode of a plan.")
      .def_ro("index", &PlanItem::index, "Place in the plan.")
      .def_ro("scene", &PlanItem::scene, "Number of the scene in the source.")
      .def_ro("episode", &PlanItem::episode, "Number of the episode in its scene.")
      .def_ro("id", &PlanItem::id, "Name of the episode's folder.")
      .def_rw("first_attempt", &PlanItem::first_attempt,
              "Number of its first attempt: above 0 to make a recorded episode from its own start.")
      .def("__repr__", [](const PlanItem& item) { return "<PlanItem " + item.id + ">"; });
  m.def("make_plan", &MakePlan, "run"_a,
        "Returns the episodes of a run: the same file gives the same plan and the same seeds."
        "\n\nExamples:\n"
        "    >>> rc.generate.make_plan(run)[0].id\n"
        "    's0000_e0000'");
  m.def("shard_plan", &Shard, "plan"_a, "shard"_a, "count"_a,
        "Returns the items of shard `shard` of `count`.");
  m.def(
      "parse_shard",
      [](const std::string& text) {
        const ShardSpec spec = ParseShard(text);
        return nb::make_tuple(spec.shard, spec.count);
      },
      "text"_a, "Parses 'i/N' to (i, N).");
  m.def("run_identity", &RunIdentity, "run"_a,
        "Returns the identity of a run as YAML: its fields without workers and output.");
  m.def(
      "prepare_dataset",
      [](const RunConfig& run, bool validate) { PrepareDataset(run, {.validate = validate}); },
      "run"_a, nb::kw_only(), "validate"_a = true, nb::call_guard<nb::gil_scoped_release>(),
      "Creates the run's output folder, or checks that the existing one belongs to the same run "
      "(raises SpecError with the differences). A dataset without episodes is recreated. Validates "
      "the run first, unless `validate` is False."
      "\n\nExamples:\n"
      "    >>> rc.generate.prepare_dataset(run)");
  m.def("validate_dataset", &ValidateDataset, "run"_a, nb::call_guard<nb::gil_scoped_release>(),
        "Checks the run's output folder as prepare_dataset does, without writing.");
  m.def(
      "require_same_run", [](const RunConfig& run) { RequireSameRun(run); }, "run"_a,
      nb::call_guard<nb::gil_scoped_release>(),
      "Raises SpecError with each difference unless the run's dataset was prepared for it: same "
      "fields, model files and versions.");
  m.def(
      "items_on_disk",
      [](const RunConfig& run, const std::vector<PlanItem>& items) {
        const PlanOnDisk found = LookForItems(run, items);
        return std::make_pair(found.made, found.broken);
      },
      "run"_a, "items"_a, nb::call_guard<nb::gil_scoped_release>(),
      "Returns (ids of the items whose episode is on the disk, with all failures before it that "
      "the run keeps; messages about what blocks the others).");
  m.def("is_complete", &IsComplete, "run"_a, "item"_a, nb::call_guard<nb::gil_scoped_release>(),
        "Returns True if an item's episode is on the disk.");
  nb::class_<StopFlag>(m, "StopFlag", "Asks a running Runner to stop at the next action.")
      .def(nb::init<>())
      .def(
          "set", [](StopFlag& flag) { flag.value = true; },
          "Ends the run after its present control tick.")
      .def_prop_ro(
          "is_set", [](const StopFlag& flag) { return flag.value.load(); }, "True after set().");
  BindItemResult(m);
  BindReplay(m);
  nb::class_<PythonRunner>(m, "Runner",
                           "Makes the episodes of a plan in this process, one after the other."
                           "\n\nExamples:\n"
                           "    >>> rc.generate.prepare_dataset(run)\n"
                           "    >>> runner = rc.generate.Runner(run)\n"
                           "    >>> runner.run(rc.generate.make_plan(run)[0]).success\n"
                           "    True",
                           nb::type_slots(runner_slots))
      .def(
          "__init__",
          [](PythonRunner* self, const RunConfig& run, nb::object expert, nb::object sampler,
             bool stores) {
            RequireCallable(expert, "expert", "a function (run, start) -> Expert");
            RequireCallable(sampler, "sampler", "a function (run) -> TaskSampler");
            new (self) PythonRunner(run, ShareKeeper(std::move(expert)),
                                    ShareKeeper(std::move(sampler)), stores);
          },
          "run"_a, "expert"_a = nb::none(), "sampler"_a = nb::none(), "stores"_a = true,
          "`expert`: a function (run, start) -> Expert that replaces the scripted expert; "
          "`sampler`: a function (run) -> TaskSampler. With `stores=False`, `run` returns results "
          "and writes nothing.")
      .def(
          "run",
          [](PythonRunner& runner, const PlanItem& item, const StopFlag* flag) {
            const InUse use(static_cast<const Runner&>(runner), &PlaceOfRunner, "run");
            SignalPoll poll;
            const nb::gil_scoped_release release;
            return runner.Run(item, [&] {
              poll();
              return flag && flag->value;
            });
          },
          "item"_a, "stop"_a = nb::none(),
          "Makes attempts until an episode is kept, and returns an ItemResult. Ctrl-C ends it "
          "within an action;\nepisodes that were kept before stay.");
}

}  // namespace robocell::python
