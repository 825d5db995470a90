// Private to scene: a model file that becomes part of a scene. Loading makes it safe to attach:
// asset paths become absolute (several folders can meet in one scene), keyframes are read and
// dropped (the scene writes its own), global settings are reported and dropped (the scene sets its
// own).
#pragma once

#include <optional>
#include <string>
#include <vector>
#include <mujoco/mjtype.h>

#include "robocell/mujoco/owners.h"
#include "robocell/scene/compile_log.h"
#include "robocell/scene/part_keys.h"
#include "robocell/spec/sim_options.h"

struct mjsBody_;
typedef struct mjsBody_ mjsBody;

namespace robocell::internal {

struct Part {
  // A tool that became part of it, and the prefix of its names there.
  struct Tool {
    std::string prefix, file;
  };
  std::string place;  // "robot 'left'", for messages
  std::string field;  // field of the spec that names the file
  std::string file;
  SpecPtr spec;
  PartKeys keys;
  std::string other_keys = {};  // remark about keyframes with other names; may be empty
  std::vector<Tool> tools = {};
};

// Chooses whether joints of a URDF, which has no actuators, get position servos: joints of robots
// and tools do.
enum class UrdfServos { kNone, kAll };

// Returns the spec of a model file, MJCF or URDF. Remarks about a URDF go to the log. Throws the
// errors of ParseXmlFile and ReadUrdf.
SpecPtr ParseModel(const std::string& file, const std::string& place, UrdfServos servos,
                   CompileLog& log);

// Returns the absolute path of a model file that `field` names. Unset, with an entry in the log, if
// it is not found.
std::optional<std::string> FindModel(const std::string& name, const std::string& directory,
                                     const std::string& place, const std::string& field,
                                     CompileLog& log);

// Loads the model of `place`, which names it as `name` in `field`. Unset, with an entry in the log,
// if it or a file that it refers to is missing. `options` are the scene's; a warning reports those
// that the part specifies differently. With a `root_label`, unnamed elements are labelled
// (label_unnamed.h).
std::optional<Part> LoadPart(const std::string& name, const std::string& directory,
                             const std::string& place, const std::string& field,
                             const SimOptions& options, const std::string& root_label,
                             CompileLog& log, UrdfServos servos = UrdfServos::kNone);

// Returns the body of the part that is attached: the only child of its world, or the one that
// contains the given `root_body` (null for parts without such a field). Null, with a problem in the
// log, if there is no such body. A warning reports the rest of the part's world (other bodies,
// geoms, sites and cameras); a note reports its lights, because the scene has its own.
mjsBody* ChooseRoot(const Part& part, const std::optional<std::string>& root_body, CompileLog& log);

// Replaces the names of the files that a model refers to by absolute paths. Missing files give one
// entry in the log, and false.
bool MakeAssetPathsAbsolute(mjSpec* spec, const std::string& file, const std::string& place,
                            const std::string& field, CompileLog& log);

// Attaches with AttachBody, and reports elements that the engine left out because they refer to
// something that is not below `root`.
void AttachPart(mjsBody* parent, const Part& part, mjsBody* root, const class Pose& pose,
                const std::string& prefix, CompileLog& log);

// Renames default classes of a part that is attached without a prefix, if `parent` has classes of
// the same name. An attachment with an empty prefix would leave two classes of one name, which the
// engine saves to an XML file that it cannot read. Classes matter only for saving; elements keep
// their values.
void MakeClassNamesUnique(const Part& part, const mjSpec* parent);

}  // namespace robocell::internal
