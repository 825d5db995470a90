// Checks, repairs and locks datasets.
#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/function.h>

#include <optional>

#include "bindings.h"
#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/stored_file.h"
#include "robocell/data/dataset_folder.h"
#include "robocell/data/dataset_lock.h"
#include "robocell/data/dataset_reports.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/leftovers.h"
#include "robocell/data/verify.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

// A DatasetLock that is held between __enter__ and __exit__.
struct HeldLock {
  std::filesystem::path dataset;
  int shard, count;
  std::optional<DatasetLock> lock = {};
};

void BindLock(nb::module_& m) {
  nb::class_<HeldLock>(
      m, "DatasetLock",
      "A lock that keeps two runs, or a run and a repair, from working on the same "
      "dataset.\n\n`with DatasetLock(folder, shard, count):` raises IoError with the owner if the "
      "lock is taken. Count 1 locks the whole plan; shards of a plan share the folder and lock "
      "themselves. The locks of a killed process are free."
      "\n\nExamples:\n"
      "    >>> with rc.data.DatasetLock(\"experiment_output/demo\", 0, 1):\n"
      "    ...     result = rc.data.verify(\"experiment_output/demo\")")
      .def(
          "__init__",
          [](HeldLock* self, const std::filesystem::path& dataset, int shard, int count) {
            new (self) HeldLock{dataset, shard, count};
          },
          "dataset"_a, "shard"_a = 0, "count"_a = 1)
      .def(
          "__enter__",
          [](HeldLock& self) -> HeldLock& {
            self.lock.emplace(self.dataset, self.shard, self.count);
            return self;
          },
          nb::rv_policy::reference)
      .def(
          "__exit__", [](HeldLock& self, const nb::args&) { self.lock.reset(); },
          nb::sig("def __exit__(self, *args: object) -> None"));
}

void BindLeftovers(nb::module_& m) {
  m.def(
      "remove_leftovers",
      [](const std::filesystem::path& dataset, const std::string& episode,
         std::optional<int64_t> process, bool folders_only) {
        if (folders_only) return RemoveLeftoverFolders(dataset);
        std::optional<DeadWriter> writer;
        if (process) writer = {episode, *process};
        return RemoveLeftovers(dataset, writer);
      },
      "dataset"_a, "episode"_a = "", "process"_a = nb::none(), "folders_only"_a = false,
      nb::call_guard<nb::gil_scoped_release>(),
      "Removes half-written files and folders of dead processes, and returns their names. Files "
      "that are being written stay. Selects one process and the episodes whose ids begin with "
      "`episode`, or all; for the holder of the DatasetLock of the whole dataset. With "
      "`folders_only`, which needs no lock, files stay.");
}

void BindVerify(nb::module_& m) {
  m.def("self_hashed_json", &InsertSelfHash, "text"_a,
        "Returns a JSON text with its own hash in place of 64 zeros: \"json_sha256\": \"000...\".");
  m.def(
      "set_aside",
      [](const std::filesystem::path& dataset, const std::string& name) {
        return std::string(kQuarantineFolder) + "/" + Quarantine(dataset, name);
      },
      "dataset"_a, "name"_a,
      "Moves a damaged part of a dataset to the quarantine, as repair does. Returns its new name "
      "relative to the dataset.");
  m.def(
      "packed_part",
      [](const std::filesystem::path& file) -> nb::object {
        const auto part = PartAt(file);
        if (!part) return nb::none();
        return nb::make_tuple(part->shard, part->begin, part->bytes);
      },
      "file"_a,
      nb::sig(
          "def packed_part(file: str | os.PathLike[str]) -> tuple[pathlib.Path, int, int] | None"),
      "Returns the shard, first byte and size of an episode's file in a packed dataset; None for a "
      "file of its own.");
  m.def("ffmpeg_input", &FfmpegInput, "video"_a,
        "Returns the word by which ffmpeg opens a video of an episode.");
  m.def("require_dataset", &RequireDataset, "dataset"_a,
        "Raises ArgumentError for a folder that is not a dataset, with the nearest dataset.");
  m.def("json_damage", &JsonDamage, "text"_a,
        "Returns why a text does not match the hash that it contains; None when it does.");
  m.def("other_run_of", &OtherRunOf, "report"_a, "dataset"_a,
        "Returns the name of a report's run if it differs from the run in dataset.json; None if it "
        "is the same or unknown.");
  nb::class_<VerifyProblem>(m, "VerifyProblem", "A problem with one file of a dataset.")
      .def_ro("episode", &VerifyProblem::episode, "Id of the episode; \"\" for the dataset itself.")
      .def_ro("file", &VerifyProblem::file, "The file, relative to the episode or to the dataset.")
      .def_ro("reason", &VerifyProblem::reason, "Description of the problem.")
      .def("__str__", &VerifyProblem::Text);
  nb::class_<VerifyResult>(m, "VerifyResult",
                           "The state of a dataset on disk."
                           "\n\nExamples:\n"
                           "    >>> rc.data.verify(\"experiment_output/demo\").good\n"
                           "    ['s0000_e0000', 's0000_e0001']")
      .def_ro("good", &VerifyResult::good, "Ids of the intact episodes.")
      .def_ro("bad", &VerifyResult::bad, "Ids of the damaged episodes.")
      .def_ro("unjudged", &VerifyResult::unjudged,
              "Ids of episodes that cannot be judged here: no access, another format version, no "
              "decoder. Repair leaves them alone.")
      .def_ro("foreign", &VerifyResult::foreign,
              "Foreign files and folders in intact episodes or the dataset.")
      .def_prop_ro("only_unreadable", &VerifyResult::only_unreadable,
                   "True if all problems, if any, come from this machine or version.")
      .def_ro("problems", &VerifyResult::problems,
              "The problems of damaged episodes and of the dataset.")
      .def_ro("leftovers", &VerifyResult::leftovers, "Remains of a crash.")
      .def_ro("being_written", &VerifyResult::being_written, "Episodes that are being written.")
      .def_ro("others", &VerifyResult::others,
              "Files and folders that are not part of a dataset, such as notes; these are not "
              "problems.")
      .def_prop_ro("ok", &VerifyResult::ok, "True if there are no problems.")
      .def("__str__", &VerifyResult::Text)
      .def("__repr__", [](const VerifyResult& r) {
        return fmt::format("<VerifyResult: {} intact, {} damaged, {} unfinished>", r.good.size(),
                           r.bad.size(), r.leftovers.size() + r.being_written.size());
      });
  nb::class_<RepairResult>(m, "RepairResult", "Result of a repair: what it found and moved aside.")
      .def_ro("found", &RepairResult::found, "The state before the repair.")
      .def_ro("moved", &RepairResult::moved, "Names of the entries now in <dataset>/.quarantine.")
      .def_ro("remaining", &RepairResult::remaining,
              "Problems that repair could not fix; their texts say how to fix them.")
      .def("__repr__", [](const RepairResult& r) {
        return fmt::format("<RepairResult: {} moved aside>", r.moved.size());
      });
  m.def(
      "verify",
      [](const std::filesystem::path& dataset, bool decode_videos) {
        return Verify(dataset, {.decode_videos = decode_videos, .progress = {}});
      },
      "dataset"_a, "decode_videos"_a = false, nb::call_guard<nb::gil_scoped_release>(),
      "Checks every episode of a dataset: sizes, hashes, rows and frame counts."
      "\n\nExamples:\n"
      "    >>> rc.data.verify(\"experiment_output/demo\").ok\n"
      "    True");
  m.def(
      "repair",
      [](const std::filesystem::path& dataset, bool decode_videos) {
        return Repair(dataset, {.decode_videos = decode_videos, .progress = {}});
      },
      "dataset"_a, "decode_videos"_a = false, nb::call_guard<nb::gil_scoped_release>(),
      "Moves damaged episodes, foreign files in good ones, damaged models, a damaged dataset.json, "
      "and remains of a crash aside, into <dataset>/.quarantine. What cannot be judged here stays. "
      "Raises IoError with the process that generates into the dataset.");
}

}  // namespace

void BindData(nb::module_& m) {
  BindLeftovers(m);
  BindVerify(m);
  BindLock(m);
}

}  // namespace robocell::python
