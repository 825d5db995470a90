// What datasets are checked, repaired and locked with.
#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/function.h>

#include <optional>

#include "bindings.h"
#include "robocell/base/error.h"
#include "robocell/data/dataset_folder.h"
#include "robocell/data/dataset_lock.h"
#include "robocell/data/dataset_reports.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/leftovers.h"
#include "robocell/data/self_hashed_json.h"
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
      "Keeps two runs, or a run and a repair, from working on the same dataset.\n\n"
      "`with DatasetLock(folder, shard, count):` IoError names the owner when it "
      "is taken. The whole plan is locked with count 1; shards of a plan share the "
      "folder and lock themselves. The locks of a killed process are free.")
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
      "Removes what dead processes left half-written, and returns its names; never what somebody "
      "is "
      "writing. Of one process and the episodes whose ids begin with `episode`, or all: that is "
      "for "
      "whoever holds the DatasetLock of the whole dataset. With `folders_only`, which anybody may, "
      "files stay.");
}

void BindVerify(nb::module_& m) {
  m.def("sign_json", &InsertSelfHash, "text"_a,
        "A JSON text with its own hash where 64 zeros are: \"json_sha256\": \"000...\".");
  m.def(
      "set_aside",
      [](const std::filesystem::path& dataset, const std::string& name) {
        return std::string(kQuarantineFolder) + "/" + Quarantine(dataset, name);
      },
      "dataset"_a, "name"_a,
      "Moves a damaged part of a dataset to where repair moves it; its name from the dataset on.");
  m.def("require_dataset", &RequireDataset, "dataset"_a,
        "ArgumentError for a folder that is no dataset; it names the one that is near.");
  m.def("json_damage", &JsonDamage, "text"_a,
        "Returns why a text does not match the hash that it contains; None when it does.");
  m.def("other_run_of", &OtherRunOf, "report"_a, "dataset"_a,
        "The name of the run that a report (its text) is of when that is another one than "
        "dataset.json describes; None when it is the same, or nothing says so.");
  nb::class_<VerifyProblem>(m, "VerifyProblem", "What is wrong with one file of a dataset.")
      .def_ro("episode", &VerifyProblem::episode)
      .def_ro("file", &VerifyProblem::file)
      .def_ro("reason", &VerifyProblem::reason)
      .def("__str__", &VerifyProblem::Text);
  nb::class_<VerifyResult>(m, "VerifyResult", "The state of a dataset on disk.")
      .def_ro("good", &VerifyResult::good)
      .def_ro("bad", &VerifyResult::bad)
      .def_ro("unjudged", &VerifyResult::unjudged,
              "Ids of episodes that cannot be judged here: no access, another format version, no "
              "decoder. Repair leaves them alone.")
      .def_ro("foreign", &VerifyResult::foreign,
              "Things that do not belong there, in intact episodes or the dataset.")
      .def_prop_ro("only_unreadable", &VerifyResult::only_unreadable,
                   "Whether there are problems, and all of them are this machine's or version's.")
      .def_ro("problems", &VerifyResult::problems)
      .def_ro("leftovers", &VerifyResult::leftovers, "What a crash left behind.")
      .def_ro("being_written", &VerifyResult::being_written, "Episodes whose writer lives.")
      .def_ro("others", &VerifyResult::others)
      .def_prop_ro("ok", &VerifyResult::ok)
      .def("__str__", &VerifyResult::Text)
      .def("__repr__", [](const VerifyResult& r) {
        return fmt::format("<VerifyResult: {} good, {} bad, {} unfinished>", r.good.size(),
                           r.bad.size(), r.leftovers.size() + r.being_written.size());
      });
  nb::class_<RepairResult>(m, "RepairResult", "What repair found and moved aside.")
      .def_ro("found", &RepairResult::found)
      .def_ro("moved", &RepairResult::moved, "Names of what now lies in <dataset>/.quarantine.")
      .def_ro("remaining", &RepairResult::remaining,
              "Problems that moving things aside could not mend; their texts say what can.")
      .def("__repr__", [](const RepairResult& r) {
        return fmt::format("<RepairResult: {} moved aside>", r.moved.size());
      });
  m.def(
      "verify",
      [](const std::filesystem::path& dataset, bool decode_videos) {
        return Verify(dataset, {.decode_videos = decode_videos, .progress = {}});
      },
      "dataset"_a, "decode_videos"_a = false, nb::call_guard<nb::gil_scoped_release>(),
      "Checks every episode of a dataset: sizes, hashes, rows and frame counts.");
  m.def(
      "repair",
      [](const std::filesystem::path& dataset, bool decode_videos) {
        return Repair(dataset, {.decode_videos = decode_videos, .progress = {}});
      },
      "dataset"_a, "decode_videos"_a = false, nb::call_guard<nb::gil_scoped_release>(),
      "Moves damaged episodes, foreign things in good ones, damaged models, a damaged "
      "dataset.json, and what a crash left behind aside, into <dataset>/.quarantine. What cannot "
      "be judged here stays. "
      "IoError names who is generating into the dataset.");
}

}  // namespace

void BindData(nb::module_& m) {
  BindLeftovers(m);
  BindVerify(m);
  BindLock(m);
}

}  // namespace robocell::python
