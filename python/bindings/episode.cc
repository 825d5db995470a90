// Episodes: their description, columns and images.
#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "column.h"
#include "features.h"
#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"
#include "robocell/data/episode_reader.h"

namespace robocell::python {

namespace nb = nanobind;
using namespace nb::literals;

namespace {

std::vector<std::string> ColumnNames(const Episode& episode) {
  std::vector<std::string> names;
  for (const ColumnInfo& info : episode.columns()) names.push_back(info.spec.name);
  return names;
}

nb::object Json(const std::string& text) {
  return nb::module_::import_("json").attr("loads")(text);
}

// The images of one stream, and their array type.
struct Stream {
  const CameraInfo& camera;
  ImageKind kind;

  std::vector<size_t> shape() const {
    std::vector<size_t> shape = {static_cast<size_t>(camera.height),
                                 static_cast<size_t>(camera.width)};
    if (kind == ImageKind::kColour) shape.push_back(3);
    return shape;
  }
};

constexpr ImageKind kKinds[] = {ImageKind::kColour, ImageKind::kDepth, ImageKind::kSegmentation};

// Finds a camera with a kind of its images, or without a kind a stream by its own name.
Stream FindStream(const Episode& episode, const std::string& name,
                  const std::optional<std::string>& kind) {
  if (!kind) {
    const ImageStream stream = episode.stream(name);
    return {episode.camera(stream.camera), stream.kind};
  }
  std::vector<std::string> known;
  for (const ImageKind each : kKinds) {
    if (NameOf(each) == *kind) return {episode.camera(name), each};
    known.emplace_back(NameOf(each));
  }
  throw NotFoundError(NoSuchName("camera '" + name + "'", "kind of image", *kind, known));
}

size_t SizeOf(const std::vector<size_t>& shape) {
  return std::accumulate(shape.begin(), shape.end(), size_t{1}, std::multiplies<>());
}

template <class Pixel>
nb::object ReadFrame(const Episode& episode, const Stream& stream, int64_t index) {
  const std::vector<size_t> shape = stream.shape();
  std::vector<Pixel> pixels(SizeOf(shape));
  {
    const nb::gil_scoped_release release;
    episode.ReadFrame(stream.camera.name, stream.kind, index, std::span(pixels));
  }
  return NewArray(std::move(pixels), shape);
}

nb::object FrameAt(const Episode& episode, const std::string& name, int64_t index,
                   const std::optional<std::string>& kind) {
  const Stream stream = FindStream(episode, name, kind);
  const int64_t frames = stream.camera.frames;
  if (index < -frames || index >= frames) {
    throw nb::index_error(fmt::format("episode '{}': no frame {} of '{}', it has {}",
                                      episode.folder().string(), index, name,
                                      Counted(frames, "frame"))
                              .c_str());
  }
  if (index < 0) index += frames;
  return stream.kind == ImageKind::kColour ? ReadFrame<uint8_t>(episode, stream, index)
                                           : ReadFrame<uint16_t>(episode, stream, index);
}

template <class Pixel>
nb::object AllFrames(VideoReader video, const std::vector<size_t>& shape) {
  const size_t size = SizeOf(shape), frame = size / std::max<size_t>(shape[0], 1);
  std::vector<Pixel> all(size);
  {
    const nb::gil_scoped_release release;
    for (size_t at = 0; at < size; at += frame) {
      if (!video.Next(std::span(all).subspan(at, frame)))
        throw IoError(fmt::format("an episode says that a video has {}, it has {}",
                                  Counted(static_cast<int64_t>(shape[0]), "frame"),
                                  video.info().frames));
    }
  }
  return NewArray(std::move(all), shape);
}

nb::object AllFramesOf(const Episode& episode, const std::string& name,
                       const std::optional<std::string>& kind) {
  const Stream stream = FindStream(episode, name, kind);
  std::vector<size_t> shape = stream.shape();
  shape.insert(shape.begin(), static_cast<size_t>(stream.camera.frames));
  const std::string& camera = stream.camera.name;
  switch (stream.kind) {
    case ImageKind::kColour:
      return AllFrames<uint8_t>(episode.Video(camera), shape);
    case ImageKind::kDepth:
      return AllFrames<uint16_t>(episode.DepthVideo(camera), shape);
    default:
      return AllFrames<uint16_t>(episode.SegmentationVideo(camera), shape);
  }
}

}  // namespace

void BindEpisode(nb::module_& m) {
  nb::class_<SegmentLabel>(m, "SegmentLabel", "Meaning of one id in segmentation.")
      .def_ro("name", &SegmentLabel::name, "The body.")
      .def_ro("owner", &SegmentLabel::owner,
              "Owner of the body, named as in columns: 'robots/rc7', 'objects/mug'; or ''.")
      .def("__repr__", [](const SegmentLabel& label) {
        return "SegmentLabel(name='" + label.name + "', owner='" + label.owner + "')";
      });
  m.attr("NO_SEGMENT") = kNoSegment;
  nb::class_<Episode>(
      m, "Episode",
      "One committed episode: a folder with steps.h5, one mp4 per camera and episode.json."
      "\n\nExamples:\n"
      "    >>> episode = dataset[\"s0000_e0000\"]\n"
      "    >>> episode.id\n"
      "    's0000_e0000'\n"
      "    >>> episode[\"robots/rc7/arm/qpos\"].shape == (len(episode), 7)\n"
      "    True")
      .def(
          "__init__",
          [](Episode* self, const std::filesystem::path& folder) { new (self) Episode(folder); },
          "folder"_a,
          "Opens the episode in a folder. Raises IoError with the missing or damaged file.")
      .def_prop_ro("folder", &Episode::folder, "The folder of the episode.")
      .def_prop_ro("id", &Episode::id,
                   "Id of the episode, the name of its folder: \"s0000_e0017\".")
      .def_prop_ro("success", &Episode::success,
                   "True if the task was done."
                   "\n\nExamples:\n"
                   "    >>> [each.id for each in dataset if each.success][0]\n"
                   "    's0000_e0000'")
      .def_prop_ro("terminated", &Episode::terminated,
                   "True if the task ended the episode, with success or failure.")
      .def_prop_ro("truncated", &Episode::truncated,
                   "True if the episode was cut off, as by the largest number of steps.")
      .def_prop_ro("end_reason", &Episode::end_reason,
                   "Reason for the end of the episode: \"success\", \"timeout\".")
      .def_prop_ro("warnings", &Episode::warnings,
                   "Warnings of the scene that the episode was recorded in.")
      .def_prop_ro(
          "json", [](const Episode& e) { return Json(e.json()); },
          "The content of episode.json."
          "\n\nExamples:\n"
          "    >>> episode.json[\"success\"], episode.json[\"end_reason\"]\n"
          "    (True, 'success')")
      .def_prop_ro(
          "results", [](const Episode& e) { return Json(e.results_json()); },
          nb::sig("def results(self) -> dict[str, object]"),
          "Results at the end of the episode, from `json`; EnvRecorder adds `final_observation`.")
      .def_prop_ro(
          "metadata", [](const Episode& e) { return Json(e.metadata_json()); },
          "Seed, scene, task and other metadata of the episode.\n\nExamples:\n"
          "    >>> episode.metadata[\"seed\"]\n"
          "    0")
      .def_prop_ro(
          "randomized",
          [](const Episode& e) {
            const nb::dict metadata = nb::cast<nb::dict>(Json(e.metadata_json()));
            return metadata.contains("randomized") ? nb::cast<nb::dict>(metadata["randomized"])
                                                   : nb::dict();
          },
          nb::sig("def randomized(self) -> dict[str, float | list[float] | str]"),
          "The values that `randomize` drew for the episode, by their names; empty without it."
          "\n\nExamples:\n"
          "    >>> episode.randomized.get(\"light/0/intensity\", \"not varied\")\n"
          "    'not varied'")
      .def_prop_ro(
          "features", [](const Episode& e) { return FeatureList(e.features()); },
          nb::sig("def features(self) -> list[Feature]"),
          "Features of the columns: role, unit, frame, range of each. Empty in episodes that were "
          "recorded without features.")
      .def("rows", &Episode::rows, "table"_a = "steps", "Returns the number of rows of a table.")
      .def("__len__", [](const Episode& e) { return e.rows(); })
      .def_prop_ro("tables", &Episode::tables,
                   "Names of the tables of steps.h5: \"steps\", \"control\".")
      .def_prop_ro("columns", &ColumnNames,
                   "Names of all columns and constants."
                   "\n\nExamples:\n"
                   "    >>> \"reward\" in episode.columns\n"
                   "    True")
      .def(
          "column",
          [](const Episode& e, const std::string& name) {
            return Column{&e, &e.column(name)};
          },
          "name"_a, nb::keep_alive<0, 1>(),
          "Returns a column without reading it; `column[10:20]` reads ten rows. Raises "
          "NotFoundError with the nearest names.\n\nExamples:\n"
          "    >>> column = episode.column(\"robots/rc7/arm/qpos\")\n"
          "    >>> column.units, column[10:20].shape\n"
          "    ('rad', (10, 7))")
      .def(
          "__getitem__",
          [](const Episode& e, const std::string& name) {
            return ReadRows({&e, &e.column(name)}, 0, std::nullopt);
          },
          "name"_a, nb::sig("def __getitem__(self, name: str) -> numpy.typing.NDArray[typing.Any]"),
          "Reads a whole column as an array (rows, ...). Raises NotFoundError with the nearest "
          "names.")
      .def(
          "__contains__",
          [](const Episode& e, nb::handle name) {
            std::string text;
            if (!nb::try_cast(name, text)) return false;
            const std::vector<std::string> names = ColumnNames(e);
            return std::ranges::find(names, text) != names.end();
          },
          "name"_a.none(), nb::sig("def __contains__(self, name: object) -> bool"),
          "Returns True for the name of a column or constant."
          "\n\nExamples:\n"
          "    >>> \"reward\" in episode, \"rewards\" in episode\n"
          "    (True, False)")
      .def(
          "read",
          [](const Episode& e, const std::string& name, int64_t first,
             std::optional<int64_t> count) {
            return ReadRows({&e, &e.column(name)}, first, count);
          },
          "name"_a, "first"_a = 0, "count"_a = nb::none(),
          nb::sig("def read(self, name: str, first: int = 0, count: int | None = None) -> "
                  "numpy.typing.NDArray[typing.Any]"),
          "Reads a range of rows of a column as an array.")
      .def_prop_ro(
          "cameras",
          [](const Episode& e) {
            std::vector<std::string> names;
            for (const CameraInfo& info : e.cameras()) names.push_back(info.name);
            return names;
          },
          "Names of the cameras that have colour images.")
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
                   "Meaning of 0, 1, ... in frames(..., kind='segmentation').")
      .def_prop_ro(
          "streams",
          [](const Episode& e) {
            std::vector<std::string> names;
            for (const ImageStream& stream : e.streams()) names.push_back(stream.name);
            return names;
          },
          "Names of all image streams: 'wrist' for the colour images of a camera, 'wrist.depth' "
          "and 'wrist.segmentation' if it has those."
          "\n\nExamples:\n"
          "    >>> episode.streams\n"
          "    ['wrist', 'exo']")
      .def("frame", &FrameAt, "stream"_a, "index"_a, "kind"_a = nb::none(),
           nb::sig("def frame(self, stream: str, index: int, kind: str | None = None) -> "
                   "numpy.typing.NDArray[typing.Any]"),
           "Decodes one image: `frames(stream, kind)[index]` without the others.\n\n`stream` is "
           "one of `streams`, or a camera with its `kind`: 'rgb', 'depth', 'segmentation'. "
           "Negative indices count from the end. A decoder stays alive between calls, so images in "
           "order are cheap; another image is found from the key frame before it. IndexError names "
           "the number of frames, NotFoundError the nearest streams."
           "\n\nExamples:\n"
           "    >>> episode.frame(\"wrist\", 0).dtype\n"
           "    dtype('uint8')")
      .def("frames", &AllFramesOf, "stream"_a, "kind"_a = nb::none(),
           nb::sig("def frames(self, stream: str, kind: str | None = None) -> "
                   "numpy.typing.NDArray[typing.Any]"),
           "Decodes all frames of a stream, or of a camera and a kind. 'rgb': uint8 (frames, "
           "height, width, 3). 'depth': uint16 (frames, height, width), millimetres along the "
           "camera's axis, 0 for no hit, 65535 for that and more; exactly as rendered. "
           "'segmentation': uint16 (frames, height, width), indices of segment_labels, NO_SEGMENT "
           "for none. Raises NotFoundError if the camera has no such images."
           "\n\nExamples:\n"
           "    >>> len(episode.frames(\"wrist\")) == len(episode)\n"
           "    True")
      .def(
          "frames_of_rows",
          [](const Episode& e, const std::string& camera, const std::string& table) {
            return NewArray(std::span<const int64_t>(e.FramesOfRows(camera, table)),
                            {static_cast<size_t>(e.rows(table))});
          },
          "camera"_a, "table"_a = "steps",
          nb::sig("def frames_of_rows(self, camera: str, table: str = 'steps') -> "
                  "numpy.typing.NDArray[numpy.int64]"),
          "Returns the index of the camera's frame at each row of a table: the last one that is "
          "not newer, -1 before the first. Frame i belongs to row i of the camera's own table; for "
          "other tables the column `time` of both is compared.")
      .def_prop_ro("files", &Episode::files,
                   "Names of the files in the folder, as episode.json lists them.")
      .def_prop_ro("models", &Episode::models,
                   "Models of the episode: name in the metadata -> path in the dataset.")
      .def("__getstate__",
           [](const Episode& e) {
             return nb::make_tuple(std::filesystem::absolute(e.folder()).string());
           })
      .def("__setstate__",
           [](Episode& e, const nb::tuple& state) {
             new (&e) Episode(nb::cast<std::string>(state[0]));
           })
      .def("__repr__", [](const Episode& e) {
        return "<Episode " + e.id() + ": " + std::to_string(e.rows()) + " rows, " +
               (e.success() ? "success" : e.end_reason()) + ">";
      });
  m.def("release_idle_files", &ReleaseIdleFiles, nb::call_guard<nb::gil_scoped_release>(),
        "Closes the files and decoders that episodes keep for their next call, for example before "
        "a dataset is moved or deleted. Episodes open them again on demand.");
}

}  // namespace robocell::python
