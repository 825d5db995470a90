// Episodes from environments, and environments from episodes (rollout/env_recorder.h,
// rollout/env_of_episode.h), under Python's robocell.data.EnvRecorder.
#include "robocell/rollout/env_recorder.h"

#include <nanobind/nanobind.h>

#include <memory>
#include <optional>
#include <utility>

#include "bindings.h"
#include "env.h"
#include "in_use.h"
#include "scene_sharing.h"
#include "signals.h"
#include "robocell/env/env_batch.h"
#include "robocell/rollout/env_of_episode.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

// A recorder of an environment, or of a copy in a batch, which others may be stepping. It keeps that
// alive, in view of the collector: its task may be written in Python, and refer to its script's
// variables.
class PythonRecorder {
 public:
  template <class F>
  auto Do(const char* done, F&& f) {
    std::optional<InUse> of_batch, of_env;
    if (batch_) {
      of_batch.emplace(*batch_, static_cast<std::string (*)(const EnvBatch&)>(&Place), done);
    } else {
      of_env.emplace(env_, static_cast<std::string (*)(const Env&)>(&Place), done);
    }
    const nb::gil_scoped_release release;
    return f();
  }
  PythonRecorder(nb::object owner, Env& env, EnvBatch* batch, const std::filesystem::path& dataset,
                 EnvRecorderOptions options)
      : owner_(std::move(owner)), env_(env), batch_(batch) {
    Do("recorded",
       [&] { recorder_ = std::make_unique<EnvRecorder>(env_, dataset, std::move(options)); });
  }
  // A step on another thread, or a step on this one whose task releases the recorder, still uses
  // it: then the recorder is freed when that step has ended.
  ~PythonRecorder() { Free(); }
  PythonRecorder(const PythonRecorder&) = delete;
  PythonRecorder& operator=(const PythonRecorder&) = delete;
  EnvRecorder* operator->() {
    if (!recorder_) throw ClosedError("the recorder is gone");
    return recorder_.get();
  }

  static int Traverse(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    if (nb::inst_ready(self)) Py_VISIT(nb::inst_ptr<PythonRecorder>(self)->owner_.ptr());
    return 0;
  }
  static int Clear(PyObject* self) {
    if (!nb::inst_ready(self)) return 0;
    auto& recorder = *nb::inst_ptr<PythonRecorder>(self);
    recorder.Free();
    recorder.owner_.reset();
    return 0;
  }

 private:
  void Free() {
    if (!recorder_) return;
    const void* used = batch_ ? static_cast<const void*>(batch_) : &env_;
    WhenIdle(used, [last = std::shared_ptr<EnvRecorder>(std::move(recorder_))]() mutable {
      last.reset();
    });
  }

  nb::object owner_;  // of the environment
  Env& env_;
  EnvBatch* batch_;
  std::unique_ptr<EnvRecorder> recorder_;
};

PyType_Slot recorder_slots[] = {
    {Py_tp_traverse, reinterpret_cast<void*>(&PythonRecorder::Traverse)},
    {Py_tp_clear, reinterpret_cast<void*>(&PythonRecorder::Clear)},
    {0, nullptr}};

EnvRecorderOptions OptionsOf(const std::string& prefix, bool images, const std::string& metadata) {
  return {.prefix = prefix, .images = images, .metadata_json = metadata};
}

Env& CopyOf(EnvBatch& batch, int copy) {
  batch.RequireOpen();
  if (copy >= 0 && copy < batch.size()) return batch.env(copy);
  throw ArgumentError("copy " + std::to_string(copy) + " of a " + Place(batch) + " of " +
                      std::to_string(batch.size()) + ": copies are counted from 0");
}

void BindRecorder(nb::module_& m) {
  nb::class_<PythonRecorder>(m, "_EnvRecorder", "Under robocell.data.EnvRecorder.",
                             nb::type_slots(recorder_slots))
      .def(
          "__init__",
          [](PythonRecorder* self, Env& env, const std::filesystem::path& dataset,
             const std::string& prefix, bool images, const std::string& metadata) {
            new (self) PythonRecorder(nb::find(env), env, nullptr, dataset,
                                      OptionsOf(prefix, images, metadata));
          },
          "env"_a, "dataset"_a, "prefix"_a, "images"_a, "metadata_json"_a)
      .def(
          "__init__",
          [](PythonRecorder* self, EnvBatch& batch, int copy, const std::filesystem::path& dataset,
             const std::string& prefix, bool images, const std::string& metadata) {
            new (self) PythonRecorder(nb::find(batch), CopyOf(batch, copy), &batch, dataset,
                                      OptionsOf(prefix, images, metadata));
          },
          "batch"_a, "copy"_a, "dataset"_a, "prefix"_a, "images"_a, "metadata_json"_a)
      .def(
          "save",
          [](PythonRecorder& r, std::optional<bool> success, const std::string& reason) {
            return r.Do("recorded",
                        [&] { return r->Save({.success = success, .reason = reason}); });
          },
          "success"_a.none() = nb::none(), "reason"_a = "")
      .def("discard", [](PythonRecorder& r) { r.Do("recorded", [&] { r->Discard(); }); })
      .def("close", [](PythonRecorder& r) { r.Do("recorded", [&] { r->Close(); }); })
      .def_prop_ro("closed", [](PythonRecorder& r) { return r->closed(); })
      .def_prop_ro("dataset", [](PythonRecorder& r) { return r->dataset(); })
      .def_prop_ro("episodes",
                   [](PythonRecorder& r) { return std::vector<std::string>(r->episodes()); })
      .def_prop_ro("rows", [](PythonRecorder& r) { return r->rows(); });
}

}  // namespace

void BindEnvRecorder(nb::module_& m) {
  BindRecorder(m);
  m.def(
      "env_of_episode",
      [](const Episode& episode, bool images) {
        ImportMujoco();
        const nb::gil_scoped_release release;
        return EnvOfEpisode(episode, images, PythonData()).release();
      },
      "episode"_a, "images"_a = false, nb::rv_policy::take_ownership,
      "Makes the environment that an episode was recorded in, from the dataset alone; without "
      "`images` it has no streams.\n\nRaises ArgumentError for episodes that no environment "
      "recorded, SpecError when the code of its task or features differs from the recorded one, "
      "and NotFoundError for a task that is not registered: import its module first.");
  m.def(
      "replay_actions",
      [](Env& env, const Episode& episode, const std::string& frame, double tolerance) {
        const StateFrame in = ToStateFrame(frame);
        const InUse use(env, &Place, "replayed");
        const nb::gil_scoped_release release;
        return ReplayActions(env, episode,
                             {.frame = in, .tolerance = tolerance, .poll = SparsePoll()});
      },
      "env"_a, "episode"_a, "frame"_a = "world", "tolerance"_a = 0.0,
      "Returns to the start of an episode and repeats its actions, until an observation or a "
      "reward differs from the record by more than `tolerance` (0: to the bit).\n\n`frame` as in "
      "Env.set_state: 'root' for a rig at another pose in the world, which needs a tolerance. "
      "Raises ArgumentError for an episode of another configuration, and SpecError for one of "
      "other code. Ctrl-C ends it.");
}

}  // namespace robocell::python
