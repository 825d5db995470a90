// Stored grasps: generated once for each hand and object, or brought by the user.
//
//   GraspSet grasps = GraspsOf(robot, "mug");                        // a library's, else generated
//   RegisterGraspLibrary("mine", "/data/grasps");                    // .../mug/panda/grasps.npz
//   SaveGrasps("mug/panda/grasps.npz", grasps.grasps);
//
// Files are NumPy's .npz (base/npz.h): `transforms` (N, 4, 4) are poses of the TCP in the frame of
// the object's root body, the best first; in joint_grasps_<joint>.npz in the frame of the body that
// the joint moves. Files of robocell have more arrays, which a file may lack: `kinds`, `openings`,
// `widths`, `asides`, `approaches` (N, 3), `approach_lengths`, `scores`. Without them the hand opens
// fully and comes along its own approach direction; the kind is kSuction for a cup, kHandle for the
// body of a joint, else the one of the direction.
//
// A library is a folder with <object>/<robot>/grasps.npz, <object>/grasps.npz or
// <object>/<object>_grasps_filtered.npz, and for joints joint_grasps_<joint>.npz or
// <joint>_grasps_filtered.npz there. <object> is the object's name in the scene, or the name of its
// model's file or folder; <robot> is the name in its configuration; <joint> is the joint's full name
// or its name in the model.
//
// Errors: IoError with path and row for files that are no grasps. Any thread may register libraries.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robocell/robot/robot.h"
#include "robocell/task/grasp.h"
#include "robocell/task/grasp_generator.h"

namespace robocell {

// Reads a file with grasps of a body by a robot's hand, best first, and fills in what it lacks. Throws
// NotFoundError for a body that the scene does not have.
GraspSet LoadGrasps(const std::filesystem::path& path, const Robot& robot, const std::string& body);
// Writes all arrays; creates the folder.
void SaveGrasps(const std::filesystem::path& path, const std::vector<Grasp>& grasps);

// Adds a library, or replaces the one of that name; the latest is looked at first. Throws
// NotFoundError for a folder that does not exist, ArgumentError for an empty name.
void RegisterGraspLibrary(const std::string& name, const std::filesystem::path& folder);
// Throws NotFoundError with the names.
void UnregisterGraspLibrary(const std::string& name);
std::vector<std::string> GraspLibraryNames();

// Returns ROBOCELL_CACHE_DIR, else the user's cache folder and "robocell"; in it "grasps".
std::filesystem::path GraspCacheFolder();
// Returns the key of generated grasps: hexadecimal digits, the same for the same version of
// robocell, geometry of hand and object, and options, wherever the object is.
std::string GraspKey(const Robot& robot, const std::string& body, const GraspOptions& options = {});

// Returns a body's grasps: of the latest library that has grasps of the kinds for it, else of the
// cache, else generated and stored there. Without `kinds`, pushes and hooks of a library are left out,
// as are kinds that the hand cannot do; `geoms` and `samples` say nothing about its files. A cache
// that cannot be written costs a warning in the log. Without `stored` libraries count, and the memory
// of this process, but no file of the cache.
GraspSet GraspsOf(const Robot& robot, const std::string& body, const GraspOptions& options = {},
                  bool stored = true);

}  // namespace robocell
