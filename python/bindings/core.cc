// The extension module robocell._core: everything of the C++ library that Python uses. Users import
// the package robocell, which re-exports it.
#include "argument_errors.h"
#include "bindings.h"
#include "ik_objectives.h"
#include "scene_cycles.h"
#include "robocell/mujoco/version.h"

// NOLINTNEXTLINE(clang-diagnostic-reserved-identifier): Python's and nanobind's names
NB_MODULE(_core, m) {
  using namespace robocell::python;
  m.doc() = "robocell's C++ core. Use it through the package `robocell`.";
  BindBase(m);
  BindLog(m);
  robocell::RequireEngineVersion();
  m.attr("__mujoco_version__") = robocell::CompiledEngineVersion();
  m.def("mujoco_version", &robocell::LoadedEngineVersion,
        "Returns the version of the loaded MuJoCo; __mujoco_version__ is the one robocell was "
        "built for.");
  BindMujoco(m);
  BindMath(m);
  BindSpec(m);
  BindAssets(m);
  BindSceneNodes(m);
  BindScene(m);
  BindKinematics(m);
  BindRobot(m);
  BindCollisionFilter(m);
  BindMotion(m);
  BindRender(m);
  BindTask(m);
  BindSampler(m);
  BindStartSampler(m);
  BindPick(m);
  BindSceneSources(m);
  BindObjectViews(m);
  BindTaskKinds(m);
  BindFeatures(m);
  BindRunEnv(m);
  BindEnv(m);
  BindEnvBatch(m);
  BindColumn(m);
  BindEpisode(m);
  BindDataset(m);
  BindWriter(m);
  BindData(m);
  BindRollout(m);
  BindDiagnose(m);
  BindEnvRecorder(m);
  BindViewer(m);
  BindHardware(m);
  ExplainArgumentErrors(m);
}
