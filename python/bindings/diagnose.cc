// Checks of robots and runs: reports errors, and valid settings that are probably unintended.
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>

#include <array>
#include <optional>

#include "bindings.h"
#include "robocell/diagnose/check_robot.h"
#include "robocell/diagnose/check_run.h"
#include "robocell/expert/expert_kind.h"
#include "robocell/rollout/validate_run.h"
#include "robocell/task/task_kind.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

using WithoutLock = nb::call_guard<nb::gil_scoped_release>;

void BindFinding(nb::module_& m) {
  nb::enum_<Severity>(m, "Severity", "Severity of a finding.")
      .value("NOTE", Severity::kNote, "Information that needs no change.")
      .value("WARNING", Severity::kWarning, "Valid, but probably unintended.");
  nb::class_<Finding>(m, "Finding", "A finding of a check.")
      .def_ro("subject", &Finding::subject, "'robot 'left''.")
      .def_ro("severity", &Finding::severity, "NOTE or WARNING.")
      .def_ro("place", &Finding::place,
              "Place: 'arm.yaml:9:14' or 'arm.xml:12'; '' without a file.")
      .def_ro("text", &Finding::text, "The finding, its reason, and the next step.")
      .def_ro("edit", &Finding::edit,
              "The entry of the robot file's `edits` that fixes it; '' if there is none.")
      .def_prop_ro("line", &Line, "Place, subject and text in one line.")
      .def("__str__", &LineWithoutSubject,
           "Returns place and text, as `robocell check` prints them.")
      .def("__repr__", [](const Finding& finding) { return "<Finding " + Line(finding) + ">"; });
}

}  // namespace

void BindDiagnose(nb::module_& m) {
  BindFinding(m);
  m.def(
      "check_robot",
      [](const Robot& robot, bool beside_warnings) {
        return CheckRobot(robot, {.beside_warnings = beside_warnings});
      },
      "robot"_a, nb::kw_only(), "beside_warnings"_a = false, WithoutLock(),
      "Tries a robot out in its scene, which is reset and stepped: contacts at home, whether its "
      "arms stay there and follow a small step of each joint, and groups and actuators that "
      "nothing commands. Returns a Finding for each problem; with `beside_warnings` without those "
      "that are already warnings of the scene."
      "\n\nExamples:\n"
      "    >>> [finding.text for finding in rc.diagnose.check_robot(robot)]\n"
      "    []");
  m.def(
      "validate_robot",
      [](const Robot& robot) {
        Problems problems(robot.config().locations);
        ValidateRobot(robot, problems);
        problems.Throw("robot '" + robot.name() + "'");
      },
      "robot"_a, WithoutLock(),
      "Raises SpecError if the robot's file contradicts its model: a gripper's `distance` that "
      "measuring contradicts, a base wider than the robot's reach. Also if no controller can drive "
      "its arm or gripper, or a name is not allowed in a record. `generate` makes the same "
      "checks.");
  m.def("why_not", &WhyNot, "robot"_a, "expert"_a, WithoutLock(),
        "Returns why the expert of a kind (`rc.tasks.expert_kinds()`) cannot use a robot. That of "
        "'pick' needs a base that can be placed anywhere, and an arm and a gripper with "
        "controllers. Empty if the expert can use the robot or has no requirements; `generate` "
        "rejects a robot for each of these reasons.");
  m.def(
      "stand_in_reach",
      [](const RunConfig& run) -> std::optional<std::array<double, 3>> {
        const ReachAdvice advice = FindTaskKind(run.task.kind())->AdviseReach(run);
        if (advice.reached != ReachedPart::kAll) return std::nullopt;
        return std::array{advice.height_offset, advice.distance[0], advice.distance[1]};
      },
      "run"_a, WithoutLock(),
      nb::sig("def stand_in_reach(run: RunConfig) -> tuple[float, float, float] | None"),
      "Returns `start.base_height_offset` and the nearest and farthest `start.base_distance`, m, "
      "from which the task is in reach, collisions aside. None without such a stand, and for tasks "
      "that give no advice. Takes about a second.");
  m.def(
      "check_run",
      [](const RunConfig& run, bool scripted_expert, bool on_this_machine) {
        return CheckRun(run,
                        {.scripted_expert = scripted_expert, .on_this_machine = on_this_machine});
      },
      "run"_a, "scripted_expert"_a = true, "on_this_machine"_a = true, WithoutLock(),
      "Raises SpecError with every problem that can be known before the first episode: fields, "
      "models, cameras, object kinds, names of columns, contradictions between the robot's file "
      "and its model, and what the scripted expert needs of the robot. With `on_this_machine`, "
      "streams are drawn once: IoError without ffmpeg, Error without OpenGL. Writes nothing. "
      "Returns warnings as Findings: configurations that are valid but probably unintended. Their "
      "subject is a field of the run or the robot.");
}

}  // namespace robocell::python
