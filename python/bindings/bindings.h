// The parts of the extension robocell._core: one function per C++ folder. core.cc calls them in the
// order of the layers, so that a class is registered before it appears in a signature.
#pragma once

#include <nanobind/nanobind.h>
// Type casters are templates: a file that forgets one gives the same cast another meaning, and the
// linker keeps either. Therefore all files see all of them.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "keyframe_choice.h"

namespace robocell::python {

namespace nb = nanobind;

void BindBase(nb::module_& m);          // errors, version
void BindLog(nb::module_& m);           // the log
void BindMujoco(nb::module_& m);        // known defects of the engine
void BindMath(nb::module_& m);          // Pose
void BindSpec(nb::module_& m);          // SceneSpec, RobotConfig, ...
void BindAssets(nb::module_& m);        // paths of models
void BindScene(nb::module_& m);         // compiled and live scenes
void BindKinematics(nb::module_& m);    // inverse kinematics
void BindRobot(nb::module_& m);         // robots and groups, with the stepper
void BindMotion(nb::module_& m);        // collision-free motions
void BindRender(nb::module_& m);        // images and videos
void BindTask(nb::module_& m);          // tasks and experts
void BindSampler(nb::module_& m);       // starts of episodes
void BindSceneSources(nb::module_& m);  // sources of scenes
void BindObjectViews(nb::module_& m);   // what cameras see of objects, and words for them
void BindPick(nb::module_& m);          // the pick task and the scripted planners
void BindStartSampler(nb::module_& m);  // starts of any task, stage by stage
void BindFeatures(nb::module_& m);      // observations and commands of cells
void BindRunEnv(nb::module_& m);        // cells of runs, step by step
void BindTaskKinds(nb::module_& m);     // kinds of tasks
void BindEnv(nb::module_& m);           // environments
void BindEnvBatch(nb::module_& m);      // copies of one, in step
void BindColumn(nb::module_& m);        // columns of episodes
void BindEpisode(nb::module_& m);       // episodes
void BindDataset(nb::module_& m);       // datasets
void BindWriter(nb::module_& m);        // episodes row by row
void BindData(nb::module_& m);          // their locks, their verification
void BindRollout(nb::module_& m);       // plans and the runner
void BindEnvRecorder(nb::module_& m);   // episodes from environments and back
void BindDiagnose(nb::module_& m);      // checks of robots and runs
void BindViewer(nb::module_& m);        // the window
void BindHardware(nb::module_& m);      // real arms

}  // namespace robocell::python
