// Datasets and episodes: read-only; writing is the runner's business.
#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/map.h>

#include <optional>

#include "bindings.h"
#include "robocell/base/error.h"
#include "robocell/base/names.h"
#include "robocell/data/dataset.h"
#include "robocell/data/dataset_lock.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/leftovers.h"
#include "robocell/data/quarantine.h"
#include "robocell/data/report_origin.h"
#include "robocell/data/require_dataset.h"
#include "robocell/data/signed_json.h"
#include "robocell/data/verify.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

// A new array that owns `values`; bool columns come back as bool.
template <class T, class Shown = T>
nb::object Array(std::vector<T> values, const std::vector<size_t>& shape) {
  auto* owned = new std::vector<T>(std::move(values));
  nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, Shown>(reinterpret_cast<Shown*>(owned->data()),
                                                shape.size(), shape.data(), owner));
}

nb::object ReadColumn(const Episode& episode, const std::string& name, int64_t first,
                      std::optional<int64_t> count) {
  const ColumnInfo& info = episode.column(name);
  const bool constant = info.table.empty();
  const RowRange range = constant ? RowRange{} : RowRange{first, count};
  std::vector<size_t> shape;
  if (!constant) shape.push_back(static_cast<size_t>(count.value_or(info.rows - first)));
  for (const int64_t n : info.spec.shape) shape.push_back(static_cast<size_t>(n));
  switch (info.spec.type) {
    case ColumnType::kFloat64:
      return Array(episode.Read<double>(name, range), shape);
    case ColumnType::kFloat32:
      return Array(episode.Read<float>(name, range), shape);
    case ColumnType::kInt64:
      return Array(episode.Read<int64_t>(name, range), shape);
    case ColumnType::kInt32:
      return Array(episode.Read<int32_t>(name, range), shape);
    case ColumnType::kUint8:
      return Array(episode.Read<uint8_t>(name, range), shape);
    case ColumnType::kBool:
      break;
  }
  std::vector<uint8_t> values(episode.ValueCount(name, range));
  episode.ReadBytes(name, range, ColumnType::kBool, std::as_writable_bytes(std::span(values)));
  return Array<uint8_t, bool>(std::move(values), shape);
}

template <class Pixel>
std::vector<Pixel> AllFrames(VideoReader video) {
  const nb::gil_scoped_release release;
  const size_t size = video.frame_bytes() / sizeof(Pixel);
  std::vector<Pixel> all(size * static_cast<size_t>(video.info().frames));
  for (size_t at = 0; at < all.size(); at += size) video.Next(std::span(all).subspan(at, size));
  return all;
}

nb::object ReadFrames(const Episode& episode, const std::string& camera, const std::string& kind) {
  const CameraInfo& info = episode.camera(camera);
  std::vector<size_t> shape = {static_cast<size_t>(info.frames), static_cast<size_t>(info.height),
                               static_cast<size_t>(info.width)};
  if (kind == "depth") return Array(AllFrames<uint16_t>(episode.DepthVideo(camera)), shape);
  if (kind == "segmentation")
    return Array(AllFrames<uint16_t>(episode.SegmentationVideo(camera)), shape);
  if (kind != "rgb") {
    throw NotFoundError(NoSuchName("camera '" + camera + "'", "kind of image", kind,
                                   {"rgb", "depth", "segmentation"}));
  }
  shape.push_back(3);
  return Array(AllFrames<uint8_t>(episode.Video(camera)), shape);
}

std::vector<std::string> ColumnNames(const Episode& episode) {
  std::vector<std::string> names;
  for (const ColumnInfo& info : episode.columns()) names.push_back(info.spec.name);
  return names;
}

nb::object Json(const std::string& text) {
  return nb::module_::import_("json").attr("loads")(text);
}

nb::dict ColumnDict(const ColumnInfo& info) {
  nb::dict d;
  d["name"] = info.spec.name;
  d["dtype"] = std::string(NameOf(info.spec.type));
  d["shape"] = nb::tuple(nb::cast(info.spec.shape));
  d["units"] = info.spec.units;
  d["frame"] = info.spec.frame;
  d["names"] = nb::cast(info.spec.names);
  d["values"] = nb::cast(info.spec.values);
  d["description"] = info.spec.description;
  d["table"] = info.table;
  d["rows"] = info.rows;
  return d;
}

void BindEpisode(nb::module_& m) {
  nb::class_<SegmentLabel>(m, "SegmentLabel", "What the pixels of one number in segmentation show.")
      .def_ro("name", &SegmentLabel::name, "The body.")
      .def_ro("owner", &SegmentLabel::owner,
              "What it belongs to, as columns name it: 'robots/rc7', 'objects/mug'; or ''.")
      .def("__repr__", [](const SegmentLabel& label) {
        return "SegmentLabel(name='" + label.name + "', owner='" + label.owner + "')";
      });
  m.attr("NO_SEGMENT") = kNoSegment;
  nb::class_<Episode>(
      m, "Episode",
      "One committed episode: a folder with steps.h5, one mp4 per camera and episode.json.")
      .def(
          "__init__",
          [](Episode* self, const std::filesystem::path& folder) { new (self) Episode(folder); },
          "folder"_a,
          "Opens the episode in a folder. IoError names the file that is missing or damaged.")
      .def_prop_ro("folder", &Episode::folder)
      .def_prop_ro("id", &Episode::id)
      .def_prop_ro("success", &Episode::success)
      .def_prop_ro("terminated", &Episode::terminated)
      .def_prop_ro("truncated", &Episode::truncated)
      .def_prop_ro("end_reason", &Episode::end_reason)
      .def_prop_ro("warnings", &Episode::warnings)
      .def_prop_ro(
          "json", [](const Episode& e) { return Json(e.json()); }, "The content of episode.json.")
      .def_prop_ro(
          "metadata", [](const Episode& e) { return Json(e.metadata_json()); },
          "Seeds, scene, task and whatever else describes the episode.")
      .def("rows", &Episode::rows, "table"_a = "steps", "Number of rows of a table.")
      .def("__len__", [](const Episode& e) { return e.rows(); })
      .def_prop_ro("tables", &Episode::tables)
      .def_prop_ro("columns", &ColumnNames, "Names of all columns and constants.")
      .def(
          "column",
          [](const Episode& e, const std::string& name) { return ColumnDict(e.column(name)); },
          "name"_a,
          "What is known of a column: dtype, shape of a row, units, frame, component names, table, "
          "rows.")
      .def(
          "__getitem__",
          [](const Episode& e, const std::string& name) {
            return ReadColumn(e, name, 0, std::nullopt);
          },
          "name"_a, nb::sig("def __getitem__(self, name: str) -> numpy.typing.NDArray[typing.Any]"),
          "A whole column as an array (rows, ...). NotFoundError with the nearest names.")
      .def("read", &ReadColumn, "name"_a, "first"_a = 0, "count"_a = nb::none(),
           nb::sig("def read(self, name: str, first: int = 0, count: int | None = None) -> "
                   "numpy.typing.NDArray[typing.Any]"),
           "A range of rows of a column as an array.")
      .def_prop_ro("cameras",
                   [](const Episode& e) {
                     std::vector<std::string> names;
                     for (const CameraInfo& info : e.cameras()) names.push_back(info.name);
                     return names;
                   })
      .def_prop_ro(
          "depth_cameras",
          [](const Episode& e) {
            std::vector<std::string> names;
            for (const CameraInfo& info : e.cameras()) {
              if (!info.depth_file.empty()) names.push_back(info.name);
            }
            return names;
          },
          "The cameras that also have depth.")
      .def_prop_ro(
          "segmentation_cameras",
          [](const Episode& e) {
            std::vector<std::string> names;
            for (const CameraInfo& info : e.cameras()) {
              if (!info.segmentation_file.empty()) names.push_back(info.name);
            }
            return names;
          },
          "The cameras that also have segmentation.")
      .def_prop_ro("segment_labels", &Episode::segment_labels,
                   "What 0, 1, ... in frames(..., kind='segmentation') show.")
      .def("frames", &ReadFrames, "camera"_a, "kind"_a = "rgb",
           nb::sig("def frames(self, camera: str, kind: str = 'rgb') -> "
                   "numpy.typing.NDArray[typing.Any]"),
           "All frames of a camera. 'rgb': uint8 (frames, height, width, 3). 'depth': uint16 "
           "(frames, height, width), millimetres along the camera's axis, 0 for no hit, 65535 for "
           "that and more; exactly as rendered. 'segmentation': uint16 (frames, height, width), "
           "numbers of "
           "segment_labels, NO_SEGMENT where none of them is seen. NotFoundError when the camera "
           "has no such images.")
      .def_prop_ro("files", &Episode::files)
      .def_prop_ro("models", &Episode::models,
                   "The models it was made in: their names in the metadata -> where the dataset "
                   "keeps them.")
      .def("__repr__", [](const Episode& e) {
        return "<Episode " + e.id() + ": " + std::to_string(e.rows()) + " rows, " +
               (e.success() ? "success" : e.end_reason()) + ">";
      });
}

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
  m.def("sign_json", &SignJson, "text"_a,
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
        "Why a text is not exactly what was signed; None when it is.");
  m.def("other_run_of", &OtherRunOf, "report"_a, "dataset"_a,
        "The name of the run that a report (its text) is of when that is another one than "
        "dataset.json describes; None when it is the same, or nothing says so.");
  nb::class_<VerifyProblem>(m, "VerifyProblem", "What is wrong with one file of a dataset.")
      .def_ro("episode", &VerifyProblem::episode)
      .def_ro("file", &VerifyProblem::file)
      .def_ro("reason", &VerifyProblem::reason)
      .def("__str__", &VerifyProblem::Text);
  nb::class_<VerifyReport>(m, "VerifyReport", "The state of a dataset on disk.")
      .def_ro("good", &VerifyReport::good)
      .def_ro("bad", &VerifyReport::bad)
      .def_ro("unjudged", &VerifyReport::unjudged,
              "Ids of episodes that cannot be judged here: no access, another format version, no "
              "decoder. Repair leaves them alone.")
      .def_ro("foreign", &VerifyReport::foreign,
              "Things that do not belong there, in intact episodes or the dataset.")
      .def_prop_ro("only_unreadable", &VerifyReport::only_unreadable,
                   "Whether there are problems, and all of them are this machine's or version's.")
      .def_ro("problems", &VerifyReport::problems)
      .def_ro("leftovers", &VerifyReport::leftovers, "What a crash left behind.")
      .def_ro("being_written", &VerifyReport::being_written, "Episodes whose writer lives.")
      .def_ro("others", &VerifyReport::others)
      .def_prop_ro("ok", &VerifyReport::ok)
      .def("__str__", &VerifyReport::Text)
      .def("__repr__", [](const VerifyReport& r) {
        return fmt::format("<VerifyReport: {} good, {} bad, {} unfinished>", r.good.size(),
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
  BindEpisode(m);
  nb::class_<Dataset>(m, "Dataset",
                      "The committed episodes of a folder, in the order of their ids.")
      .def(
          "__init__",
          [](Dataset* self, const std::filesystem::path& folder) { new (self) Dataset(folder); },
          "folder"_a, nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("folder", &Dataset::folder)
      .def_prop_ro("ids", &Dataset::ids)
      .def("__len__", &Dataset::size)
      .def(
          "__iter__", [](nb::handle self) { return nb::steal(PySeqIter_New(self.ptr())); },
          nb::sig("def __iter__(self) -> collections.abc.Iterator[Episode]"))
      .def("__contains__", [](const Dataset& d, const std::string& id) { return d.Contains(id); })
      .def(
          "__getitem__", [](const Dataset& d, const std::string& id) { return d.Open(id); }, "id"_a)
      .def(
          "__getitem__",
          [](const Dataset& d, int64_t i) {
            const int64_t n = static_cast<int64_t>(d.size());
            if (i < -n || i >= n)
              throw nb::index_error(
                  fmt::format("dataset '{}': no episode {}, it has {}", d.folder().string(), i, n)
                      .c_str());
            return d.Open(d.ids()[static_cast<size_t>(i < 0 ? i + n : i)]);
          },
          "index"_a)
      .def_prop_ro("broken", &Dataset::broken,
                   "Names of folders that are or were episodes and have no episode.json: they do "
                   "not count. `robocell verify --repair` moves them aside.")
      .def_prop_ro("misnamed", &Dataset::misnamed,
                   "Folders that were copied or renamed, with the id of the episode that they "
                   "hold: they do not count.")
      .def("refresh", &Dataset::Refresh, nb::call_guard<nb::gil_scoped_release>(),
           "Looks at the folder again.")
      .def("__repr__", [](const Dataset& d) {
        return "<Dataset " + d.folder().string() + ": " + std::to_string(d.size()) + " episodes>";
      });
  BindLeftovers(m);
  BindVerify(m);
  BindLock(m);
}

}  // namespace robocell::python
