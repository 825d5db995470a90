// Finds models: resolves names and lists built-in ones. Converts URDFs.

#include "bindings.h"
#include "robocell/assets/lfs_pointers.h"
#include "robocell/assets/resolve.h"
#include "robocell/scene/urdf_to_mjcf.h"

namespace robocell::python {

void BindAssets(nb::module_& m) {
  m.def("resolve_model", &assets::Resolve, nb::arg("name"), nb::arg("directory") = "",
        "Returns the absolute path of a model file: of a path, `menagerie:dir/file.xml`, a path "
        "below a root of ROBOCELL_MODEL_PATH, or a built-in name.\n\nRelative paths start at "
        "`directory`. Raises NotFoundError with the searched folders and the command that fetches "
        "the model.");
  m.def("override_file", &assets::OverrideFile, nb::arg("name"),
        "Returns the file of ROBOCELL_OVERRIDE_<NAME>, or None if the variable is not set.");
  m.def("models_root", &assets::ModelsRoot, "Returns the folder of the built-in models.");
  m.def("builtin_robots", &assets::BuiltinRobots, "Returns the names of the built-in robots.");
  m.def("builtin_objects", &assets::BuiltinObjects, "Returns the names of the built-in objects.");
  m.def("builtin_equipment", &assets::BuiltinEquipment,
        "Returns the names of the built-in furniture, sensors and vessels.");
  m.def("builtin_scenes", &assets::BuiltinScenes, "Returns the names of the built-in scenes.");
  m.def("builtin_robot_file", &assets::BuiltinRobotFile, nb::arg("name"),
        "Returns the path of the YAML file of a built-in robot.");
  m.def("builtin_cells", &assets::BuiltinCells,
        "Returns the names of the ready-made environments.");
  m.def("builtin_cell_file", &assets::BuiltinCellFile, nb::arg("name"),
        "Returns the path of the YAML file of a ready-made environment, for EnvConfig.load.");
  m.def("menagerie_model_path", &menagerie::ModelPath, nb::arg("name"),
        "Returns the absolute path of a model of the MuJoCo Menagerie, \"dir/file.xml\". Raises "
        "NotFoundError with the searched folders and the command that fetches the model.");
  m.def("menagerie_robot_folder", &menagerie::RobotFolder, nb::arg("robot"),
        "Returns the folder of a robot of the Menagerie on this machine. Raises NotFoundError with "
        "the command that fetches it.");
  m.def("advice_about_pointers", &assets::AdviceAboutPointers, nb::arg("model"),
        "Returns what to do about files of a model that are pointers of Git LFS, for a model that "
        "the engine cannot read; \"\" if none is one.");
  m.def(
      "urdf_to_mjcf",
      [](const std::string& file, const std::string& folder) {
        std::vector<std::string> notes;
        std::string text = UrdfToMjcf(file, folder, &notes);
        return std::pair(std::move(text), std::move(notes));
      },
      nb::arg("file"), nb::arg("folder"),
      "Returns the MJCF of a URDF, with position servos, and remarks about what was read.\n\n"
      "`folder` is where the text will lie: mesh files are named from there. Raises SpecError with "
      "all problems of the URDF, each with its line and the next step.");
  m.def("menagerie_robot_folders", &menagerie::RobotFolders,
        "Returns the robots of the Menagerie on this machine: {name: folder}.");
}

}  // namespace robocell::python
