// Private to scene: a model file that becomes part of a scene. Loading makes it safe to attach:
// asset paths absolute (several folders can meet in one scene), keyframes read and dropped (the
// scene writes its own), global settings reported and dropped (the scene sets its own).
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
  // A tool that became part of it, and what its names begin with there.
  struct Tool {
    std::string prefix, file;
  };
  std::string place;  // "robot 'left'", for messages
  std::string field;  // of its spec: the one that names the file
  std::string file;
  SpecPtr spec;
  PartKeys keys;
  std::string other_keys = {};  // what to say of keyframes that are called otherwise; may be empty
  std::vector<Tool> tools = {};
};

// Absolute path of a model file that `field` names. Null and an entry in the log when it is not
// found.
std::optional<std::string> FindModel(const std::string& name, const std::string& directory,
                                     const std::string& place, const std::string& field,
                                     CompileLog& log);

// The model of `place`, which names it as `name` in `field`; null and an entry in the log when
// it is not found or files are missing that it refers to. `options` are the scene's; what the part
// asks for instead is reported as a warning. Unnamed elements are labelled (label_unnamed.h) when
// there is a `root_label`.
std::optional<Part> LoadPart(const std::string& name, const std::string& directory,
                             const std::string& place, const std::string& field,
                             const SimOptions& options, const std::string& root_label,
                             CompileLog& log);

// The body that the part hangs on when it is attached: the only child of its world, or the one that
// holds `root_body` when that is given; null for what has no such field. A problem in the log
// and null when there is no such body. What stays behind (other bodies, geoms, sites and cameras of
// the part's world) is a warning; lights, which the scene has its own of, are a note.
mjsBody* ChooseRoot(const Part& part, const std::optional<std::string>& root_body, CompileLog& log);

// Replaces the names of the files that a model refers to by absolute paths. Those that do not exist
// are one entry in the log; false then.
bool MakeAssetPathsAbsolute(mjSpec* spec, const std::string& file, const std::string& place,
                            const std::string& field, CompileLog& log);

// Attaches with AttachBody, and reports what the engine left out because it refers to something
// that is not below `root`.
void AttachPart(mjsBody* parent, const Part& part, mjsBody* root, const class Pose& pose,
                const std::string& prefix, CompileLog& log);

// For parts that are attached without a prefix. Gives the part's default classes other names where `parent` has classes of the same name: an
// attachment with an empty prefix would leave two classes of one name, which the engine saves to an
// XML file that it cannot read. Classes matter only for saving; elements keep their values.
void MakeClassNamesUnique(const Part& part, const mjSpec* parent);

}  // namespace robocell::internal
