// Episodes written row by row (data/episode_writer.h), under Python's robocell.data.EpisodeWriter,
// which checks types and shapes.
#include "robocell/data/episode_writer.h"

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "robocell/base/error.h"
#include "robocell/data/column.h"
#include "robocell/data/episode_schema.h"

namespace nb = nanobind;

namespace robocell::python {

using namespace nb::literals;

namespace {

// Values of any type; rows are the first axis.
using Rows = nb::ndarray<nb::ro, nb::c_contig, nb::device::cpu>;
using Image = nb::ndarray<const uint8_t, nb::c_contig, nb::device::cpu>;
using Depth = nb::ndarray<const uint16_t, nb::c_contig, nb::device::cpu>;

ColumnType ColumnTypeNamed(const std::string& name) {
  for (const ColumnType type : {ColumnType::kFloat64, ColumnType::kFloat32, ColumnType::kInt64,
                                ColumnType::kInt32, ColumnType::kUint8, ColumnType::kBool}) {
    if (name == NameOf(type)) return type;
  }
  throw ArgumentError(fmt::format(
      "'{}' is not a type of columns: float64, float32, int64, int32, uint8, bool", name));
}

// A writer that several threads of Python may call: one after the other.
class PythonWriter {
 public:
  PythonWriter(const std::filesystem::path& dataset, const std::string& id,
               const EpisodeSchema& schema, const EpisodeOptions& options)
      : schema_(schema), writer_(dataset, id, schema, options) {}

  template <class F>
  auto Do(F&& f) {
    const nb::gil_scoped_release release;
    const std::lock_guard lock(mutex_);
    return f(writer_);
  }

  // Puts rows that are complete: one array for each column of the table.
  void PutRows(int table, const std::vector<std::pair<int, Rows>>& columns, int64_t count) {
    struct Source {
      ColumnId column;
      ColumnType type;
      const std::byte* values;
      size_t row_bytes;
    };
    std::vector<Source> sources;
    sources.reserve(columns.size());
    for (const auto& [index, values] : columns) {
      const ColumnId id{table, index};
      const ColumnSpec& spec = schema_.column(id);
      const size_t row_bytes = SizeOf(spec.type) * static_cast<size_t>(RowValues(spec.shape));
      if (values.nbytes() != row_bytes * static_cast<size_t>(count)) {
        throw ArgumentError(fmt::format("column '{}': {} bytes for {} rows of {}", spec.name,
                                        values.nbytes(), count, row_bytes));
      }
      sources.push_back({id, spec.type, static_cast<const std::byte*>(values.data()), row_bytes});
    }
    Do([&](EpisodeWriter& writer) {
      for (int64_t row = 0; row < count; ++row) {
        for (const Source& source : sources) {
          writer.PutBytes(
              source.column, source.type,
              {source.values + static_cast<size_t>(row) * source.row_bytes, source.row_bytes});
        }
        writer.EndRow({table});
      }
    });
  }

 private:
  EpisodeSchema schema_;
  std::mutex mutex_;
  EpisodeWriter writer_;
};

void BindSchema(nb::module_& m) {
  nb::class_<EpisodeSchema>(m, "_EpisodeSchema", "Under robocell.data.EpisodeWriter.")
      .def(nb::init<>())
      .def(
          "add_table",
          [](EpisodeSchema& schema, const std::string& name) {
            return schema.AddTable(name).index;
          },
          "name"_a)
      .def(
          "add_column",
          [](EpisodeSchema& schema, int table, const std::string& name, const std::string& dtype,
             std::vector<int64_t> shape, const std::string& units, const std::string& frame,
             std::vector<std::string> names, std::vector<std::string> values,
             const std::string& description) {
            return schema
                .AddColumn({.name = name,
                            .type = ColumnTypeNamed(dtype),
                            .shape = std::move(shape),
                            .units = units,
                            .frame = frame,
                            .names = std::move(names),
                            .values = std::move(values),
                            .description = description},
                           {table})
                .index;
          },
          "table"_a, "name"_a, "dtype"_a, "shape"_a, "units"_a, "frame"_a, "names"_a, "values"_a,
          "description"_a)
      .def(
          "add_camera",
          [](EpisodeSchema& schema, int table, const std::string& name, int width, int height,
             std::pair<int, int> fps, std::optional<std::array<double, 9>> intrinsics, bool depth) {
            return schema
                .AddCamera({.name = name,
                            .width = width,
                            .height = height,
                            .fps_num = fps.first,
                            .fps_den = fps.second,
                            .intrinsics = intrinsics,
                            .depth = depth},
                           {table})
                .index;
          },
          "table"_a, "name"_a, "width"_a, "height"_a, "fps"_a, "intrinsics"_a.none(), "depth"_a);
}

void BindContent(nb::class_<PythonWriter>& writer) {
  writer
      .def("put_rows", &PythonWriter::PutRows, "table"_a, "columns"_a, "count"_a,
           nb::sig("def put_rows(self, table: int, columns: collections.abc.Sequence[tuple[int, "
                   "numpy.typing.NDArray[typing.Any]]], count: int) -> None"))
      .def(
          "write_frame",
          [](PythonWriter& writer, int camera, const Image& rgb) {
            writer.Do([&](EpisodeWriter& w) { w.WriteFrame({camera}, {rgb.data(), rgb.size()}); });
          },
          "camera"_a, "rgb"_a,
          nb::sig("def write_frame(self, camera: int, rgb: numpy.typing.NDArray[numpy.uint8]) -> "
                  "None"))
      .def(
          "write_depth",
          [](PythonWriter& writer, int camera, const Depth& millimetres) {
            writer.Do([&](EpisodeWriter& w) {
              w.WriteDepth({camera}, {millimetres.data(), millimetres.size()});
            });
          },
          "camera"_a, "millimetres"_a,
          nb::sig("def write_depth(self, camera: int, millimetres: "
                  "numpy.typing.NDArray[numpy.uint16]) -> None"))
      .def(
          "add_video",
          [](PythonWriter& writer, int camera, const std::filesystem::path& video) {
            writer.Do([&](EpisodeWriter& w) { w.AddVideo({camera}, video); });
          },
          "camera"_a, "video"_a)
      .def(
          "add_file",
          [](PythonWriter& writer, const std::string& name, const nb::bytes& content) {
            const std::string_view bytes(content.c_str(), content.size());
            writer.Do([&](EpisodeWriter& w) { w.AddFile(name, bytes); });
          },
          "name"_a, "content"_a);
}

void BindClass(nb::module_& m) {
  nb::class_<PythonWriter> writer(m, "_EpisodeWriter", "Under robocell.data.EpisodeWriter.");
  writer.def(
      "__init__",
      [](PythonWriter* self, const std::filesystem::path& dataset, const std::string& id,
         const EpisodeSchema& schema, const std::string& metadata, const std::string& versions) {
        const nb::gil_scoped_release release;
        new (self) PythonWriter(dataset, id, schema,
                                {.metadata_json = metadata, .versions_json = versions});
      },
      "dataset"_a, "id"_a, "schema"_a, "metadata_json"_a, "versions_json"_a);
  BindContent(writer);
  writer
      .def(
          "commit",
          [](PythonWriter& writer, bool success, bool terminated, bool truncated,
             const std::string& end_reason, std::vector<std::string> warnings,
             const std::string& results, const std::string& run) {
            const EpisodeSummary summary{.success = success,
                                         .terminated = terminated,
                                         .truncated = truncated,
                                         .end_reason = end_reason,
                                         .warnings = std::move(warnings),
                                         .results_json = results,
                                         .run_json = run};
            return writer.Do([&](EpisodeWriter& w) { return w.Commit(summary); });
          },
          "success"_a, "terminated"_a, "truncated"_a, "end_reason"_a, "warnings"_a,
          "results_json"_a, "run_json"_a)
      .def("abort", [](PythonWriter& writer) { writer.Do([](EpisodeWriter& w) { w.Abort(); }); })
      .def(
          "rows",
          [](PythonWriter& writer, int table) {
            return writer.Do([&](EpisodeWriter& w) { return w.rows({table}); });
          },
          "table"_a)
      .def(
          "frames",
          [](PythonWriter& writer, int camera) {
            return writer.Do([&](EpisodeWriter& w) { return w.frames({camera}); });
          },
          "camera"_a)
      .def_prop_ro("is_open", [](PythonWriter& writer) {
        return writer.Do([](EpisodeWriter& w) { return w.is_open(); });
      });
}

}  // namespace

void BindWriter(nb::module_& m) {
  BindSchema(m);
  BindClass(m);
}

}  // namespace robocell::python
