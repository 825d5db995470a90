// Where models are found.

#include "bindings.h"
#include "robocell/assets/override.h"
#include "robocell/assets/resolve.h"

namespace robocell::python {

void BindAssets(nb::module_& m) {
  m.def("resolve_model", &assets::Resolve, nb::arg("name"), nb::arg("directory") = "",
        "Absolute path of a model file: a path, `menagerie:dir/file.xml`, a path below a root of "
        "ROBOCELL_MODEL_PATH, or a built-in name.\n\n"
        "Relative paths start at `directory`. NotFoundError lists where it looked and the command "
        "that fetches.");
  m.def("override_file", &assets::OverrideFile, nb::arg("name"),
        "The file of ROBOCELL_OVERRIDE_<NAME>; None when the variable is not set.");
  m.def("models_root", &assets::ModelsRoot, "Folder of the built-in models.");
  m.def("builtin_robots", &assets::BuiltinRobots, "Names of the built-in robots.");
  m.def("builtin_objects", &assets::BuiltinObjects, "Names of the built-in objects.");
  m.def("builtin_equipment", &assets::BuiltinEquipment,
        "Names of the built-in furniture, sensors and vessels.");
  m.def("builtin_scenes", &assets::BuiltinScenes, "Names of the built-in scenes.");
  m.def("builtin_robot_file", &assets::BuiltinRobotFile, nb::arg("name"),
        "The YAML file of a built-in robot.");
  m.def("builtin_cells", &assets::BuiltinCells, "Names of the ready-made environments.");
  m.def("builtin_cell_file", &assets::BuiltinCellFile, nb::arg("name"),
        "The YAML file of a ready-made environment, for EnvConfig.load.");
  m.def("menagerie_model_path", &menagerie::ModelPath, nb::arg("name"));
  m.def("menagerie_robot_folder", &menagerie::RobotFolder, nb::arg("robot"));
  m.def("menagerie_robot_folders", &menagerie::RobotFolders);
}

}  // namespace robocell::python
