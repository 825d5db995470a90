// Checks of other people's files: what is wrong with a robot or a run, and what works and is probably
// not meant.
#include <nanobind/nanobind.h>

#include "bindings.h"
#include "robocell/diagnose/check_robot.h"
#include "robocell/diagnose/check_run.h"
#include "robocell/expert/pick_expert.h"
#include "robocell/rollout/validate_robot.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

using WithoutLock = nb::call_guard<nb::gil_scoped_release>;

void BindFinding(nb::module_& m) {
  nb::enum_<Severity>(m, "Severity", "How a finding of a check is meant.")
      .value("NOTE", Severity::kNote, "Good to know; needs no change.")
      .value("WARNING", Severity::kWarning, "It works, and is probably not what was meant.");
  nb::class_<Finding>(m, "Finding", "What a check says about somebody's robot.")
      .def_ro("subject", &Finding::subject, "'robot 'left''.")
      .def_ro("severity", &Finding::severity)
      .def_ro("place", &Finding::place,
              "'arm.yaml:9:14' or 'arm.xml:12'; '' when it stands in no file.")
      .def_ro("text", &Finding::text, "What is found, why, and the next step.")
      .def_ro("edit", &Finding::edit,
              "The entry of the robot file's `edits` that mends it; '' when none does.")
      .def("__str__", &LineWithoutSubject, "Place and text, as `robocell check` shows them.")
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
      "Tries a robot out in its scene, which is reset and stepped: what touches at home, whether "
      "its arms stay there and follow a small step of each joint, which groups and actuators "
      "nothing commands. Returns a Finding for whatever does not work as it should; with "
      "`beside_warnings` without those that the scene's warnings have already.");
  m.def(
      "validate_robot",
      [](const Robot& robot) {
        Problems problems(robot.config().locations);
        ValidateRobot(robot, problems);
        problems.Throw("robot '" + robot.name() + "'");
      },
      "robot"_a, WithoutLock(),
      "SpecError when the robot's file says what its model does not do: a gripper's `distance` "
      "that measuring contradicts, a base wider than the robot reaches; or when no controller can "
      "drive its arm or gripper, or a name cannot stand in a record. `generate` asks the same.");
  m.def(
      "why_no_picks", &WhyNoPicks, "robot"_a, WithoutLock(),
      "What the scripted expert of pick tasks misses of a robot: a base that can be put anywhere, "
      "an arm and a gripper with controllers. Empty when pick tasks can use it. `generate` refuses "
      "a robot for each of these reasons.");
  m.def(
      "check_run",
      [](const RunConfig& run, bool scripted_expert, bool on_this_machine) {
        return CheckRun(run,
                        {.scripted_expert = scripted_expert, .on_this_machine = on_this_machine});
      },
      "run"_a, "scripted_expert"_a = true, "on_this_machine"_a = true, WithoutLock(),
      "SpecError with everything that can be known to be wrong before the first episode: fields, "
      "models, cameras, object kinds, names of columns, what the robot file says although its "
      "model does otherwise, and what the scripted expert needs of the robot. With "
      "`on_this_machine`, streams are drawn once: IoError without ffmpeg, Error without OpenGL. "
      "Writes nothing. Returns warnings: what works and is probably not meant.");
}

}  // namespace robocell::python
