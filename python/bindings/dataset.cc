// Datasets: their episodes by place, id and slice.
#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>

#include <filesystem>
#include <string>
#include <vector>

#include "bindings.h"
#include "robocell/base/suggestions.h"
#include "robocell/data/dataset.h"

namespace robocell::python {

namespace nb = nanobind;
using namespace nb::literals;

namespace {

Episode EpisodeAt(const Dataset& dataset, int64_t index) {
  const auto size = static_cast<int64_t>(dataset.size());
  if (index < -size || index >= size) {
    throw nb::index_error(fmt::format("dataset '{}': no episode {}, it has {}",
                                      dataset.folder().string(), index, size)
                              .c_str());
  }
  return dataset.At(static_cast<size_t>(index < 0 ? index + size : index));
}

Dataset EpisodesOf(const Dataset& dataset, const nb::slice& episodes) {
  const auto [first, stop, step, count] = episodes.compute(dataset.size());
  std::vector<std::string> ids;
  for (size_t i = 0; i < count; ++i)
    ids.push_back(dataset.ids()[static_cast<size_t>(first + static_cast<Py_ssize_t>(i) * step)]);
  return dataset.Select(std::move(ids));
}

}  // namespace

void BindDataset(nb::module_& m) {
  nb::class_<Dataset>(m, "Dataset",
                      "The committed episodes of a folder, in the order of their ids.\n\nEpisodes "
                      "and their contents are read on demand. Datasets and episodes can be "
                      "pickled: other processes, forked or spawned, open the files again."
                      "\n\nExamples:\n"
                      "    >>> dataset = rc.Dataset(\"experiment_output/demo\")\n"
                      "    >>> episode = dataset[0]\n"
                      "    >>> episode.success\n"
                      "    True")
      .def(
          "__init__",
          [](Dataset* self, const std::filesystem::path& folder) { new (self) Dataset(folder); },
          "folder"_a, nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("folder", &Dataset::folder,
                   "The folder that was opened."
                   "\n\nExamples:\n"
                   "    >>> dataset.folder.name\n"
                   "    'demo'")
      .def_prop_ro("ids", &Dataset::ids,
                   "Ids of the episodes, sorted, or in the order of the selection."
                   "\n\nExamples:\n"
                   "    >>> dataset.ids[0]\n"
                   "    's0000_e0000'")
      .def("__len__", &Dataset::size)
      .def(
          "__iter__", [](nb::handle self) { return nb::steal(PySeqIter_New(self.ptr())); },
          nb::sig("def __iter__(self) -> collections.abc.Iterator[Episode]"))
      .def("__contains__", [](const Dataset& d, const std::string& id) { return d.Contains(id); })
      .def(
          "__getitem__", [](const Dataset& d, const std::string& id) { return d.Open(id); }, "id"_a)
      .def("__getitem__", &EpisodeAt, "index"_a)
      .def("__getitem__", &EpisodesOf, "episodes"_a,
           "Returns an episode by its place, `dataset[3]` or `dataset[-1]`, or by its id, "
           "`dataset['s0000_e0017']`; `dataset[0:20]` returns a Dataset of those only.")
      .def("select", &Dataset::Select, "ids"_a,
           "Returns a Dataset of the episodes with these ids, in this order, for example for a "
           "random split. Raises NotFoundError for an unknown id.")
      .def("__getstate__",
           [](const Dataset& d) {
             return nb::make_tuple(std::filesystem::absolute(d.folder()).string(), d.ids(),
                                   d.is_selection());
           })
      .def("__setstate__",
           [](Dataset& d, const nb::tuple& state) {
             new (&d) Dataset(Dataset::Restore(nb::cast<std::string>(state[0]),
                                               nb::cast<std::vector<std::string>>(state[1]),
                                               nb::cast<bool>(state[2])));
           })
      .def_prop_ro("broken", &Dataset::broken,
                   "Names of folders that are or were episodes but have no episode.json; they do "
                   "not count. `robocell verify --repair` moves them aside.")
      .def_prop_ro("misnamed", &Dataset::misnamed,
                   "Folders that were copied or renamed, with the id of the episode in them; they "
                   "do not count.")
      .def("refresh", &Dataset::Refresh, nb::call_guard<nb::gil_scoped_release>(),
           "Reads the folder again.")
      .def("__repr__", [](const Dataset& d) {
        return fmt::format("<Dataset {}: {}{}>", d.folder().string(),
                           Counted(static_cast<int64_t>(d.size()), "episode"),
                           d.is_selection() ? ", selected" : "");
      });
}

}  // namespace robocell::python
