// Finds models. A model is named in one of these ways, tried in this order:
//   menagerie:ufactory_xarm7/xarm7.xml   the MuJoCo Menagerie (menagerie.h)
//   /abs/path.xml                        that file
//   relative/path.xml                    from the referring file's folder, then from the working
//                                        folder, then below each root of ROBOCELL_MODEL_PATH
//                                        (folders separated by ':')
//   my_mug                               a user's object: objects/my_mug/my_mug.xml below one of
//                                        these roots
//   rc7, table, tabletop, ...            a built-in model by its name
// A variable ROBOCELL_OVERRIDE_<NAME> replaces the model of that name by another file:
// ROBOCELL_OVERRIDE_KINOVA_GEN3 is the file that `menagerie:kinova_gen3` means,
// ROBOCELL_OVERRIDE_TABLE the one that `table` means. <NAME> is the requested name of the model
// without `menagerie:`, in capitals and with `_` for everything but letters and digits. Paths are
// never replaced.
//
//   const std::string path = assets::Resolve("menagerie:ufactory_xarm7/xarm7.xml");
//
// NotFoundError lists where the search looked, and the command that fetches the model. Names below
// a root stay inside it: `..` and links that lead out are rejected (ArgumentError). Nothing is
// downloaded here. All functions read the file system and may be called from any thread.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace robocell::assets {

// Returns the absolute path of an existing file. `directory`: folder of the file that refers to the
// model.
std::string Resolve(const std::string& name, const std::string& directory = "");

// Returns the name of the variable that replaces a model. The name's prefix `menagerie:` is
// dropped.
std::string OverrideVariable(const std::string& name);
// Returns the absolute path that the variable contains; unset without the variable. Throws
// NotFoundError, with the variable, if the path is not a file.
std::optional<std::string> OverrideFile(const std::string& name);

// Returns the roots of ROBOCELL_MODEL_PATH, in order.
std::vector<std::string> ModelPathRoots();

// Returns the folder of the built-in models: ROBOCELL_MODELS, else beside the library (installed),
// else the source tree in which the library was built. Throws NotFoundError if there is none.
std::string ModelsRoot();
// Return names of built-in models, sorted (models/robots/NAME/NAME.xml, the same with objects and
// equipment, models/scenes/NAME.xml). Objects are what tasks pick; equipment is everything else in
// a cell: furniture, sensors, vessels.
std::vector<std::string> BuiltinRobots();
std::vector<std::string> BuiltinObjects();
std::vector<std::string> BuiltinEquipment();
std::vector<std::string> BuiltinScenes();
std::vector<std::string> BuiltinModels();  // all of these

// Returns the folders of the objects that tasks can draw, by name: those of users, which are
// objects/NAME below a root of ROBOCELL_MODEL_PATH and hide built-in ones of the same name, and
// models/objects. An object of a user does not hide a robot, equipment or a scene: it is left out
// with a warning.
std::map<std::string, std::string> ObjectFolders();
// Returns the folder of one of them, without a look at the others; unset if there is none.
std::optional<std::string> ObjectFolder(const std::string& name);
// Returns true for the name of a built-in robot, equipment or scene.
bool IsBuiltinOtherThanObject(const std::string& name);
// Returns the YAML file of a built-in robot. Throws NotFoundError with the nearest names.
std::string BuiltinRobotFile(const std::string& name);

// Return the names of ready-made environments, sorted, and the file of each for EnvConfig::Load
// (examples/envs/NAME.yaml beside the folder of the models). Throws NotFoundError with the nearest
// names.
std::vector<std::string> BuiltinCells();
std::string BuiltinCellFile(const std::string& name);

// Inverse of Resolve: returns a portable name if Resolve maps a built-in or Menagerie name to this
// file; else unset.
//
//   PortableName("<menagerie>/ufactory_xarm7/xarm7.xml")   // menagerie:ufactory_xarm7/xarm7.xml
//   PortableName("<models>/robots/rc7/rc7.xml")               // rc7
//   PortableName("mine/arm.xml")                              // unset: only this machine has it
std::optional<std::string> PortableName(const std::string& path);

}  // namespace robocell::assets

namespace robocell::menagerie {

// Returns the main model file of a Menagerie robot: "kinova_gen3" -> .../kinova_gen3/gen3.xml; also
// "ufactory_xarm7/xarm7.xml". Looks below MENAGERIE_ROOT, then in the cache of the Python package
// mujoco-menagerie (MENAGERIE_CACHE_DIR, else the user's cache folder). Throws NotFoundError with
// the command that fetches it, and ArgumentError if a robot has several models and none has its
// name (the message lists them).
std::string ModelPath(const std::string& name);

// Returns a robot's folder, found by the same rule.
std::string RobotFolder(const std::string& robot);
// Returns every robot that this rule finds here, with its folder.
std::map<std::string, std::string> RobotFolders();

}  // namespace robocell::menagerie
