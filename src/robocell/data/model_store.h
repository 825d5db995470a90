// The models that the episodes of a dataset were made in: each is stored once, by its content, in
// <dataset>/models/<name>-<hash>, with its meshes and textures. They are ordinary model files that
// a viewer opens, and make an episode replayable where its models are not installed. SHA256SUMS
// beside them lists their hashes (`sha256sum --check` reads it); the folder's name has the list's
// own hash.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/base/file_set.h"

namespace robocell::internal {

// The list of a stored model's files.
inline constexpr std::string_view kModelListFile = "SHA256SUMS";

// Returns the path of a model within the dataset: "models/rc7-0123456789abcdef/rc7.xml".
std::string StoredModelPath(const FileSet& model);

// Copies the model into the dataset unless it is there. It is complete or absent, like an episode;
// any number of processes may store the same model. Throws IoError.
void StoreModel(const std::filesystem::path& dataset, const FileSet& model);

// Returns true if a text is such a path and does not lead elsewhere.
bool IsStoredModelPath(const std::string& path);

// Returns the part of such a path that names the model: "models/rc7-0123456789abcdef".
std::string StoredModelFolder(const std::string& path);

// Returns the damage of a stored model (a path or folder as above), by the names of its files:
// "assets/a.stl" -> "it is missing"; empty if they are as stored. A missing or damaged list is no
// damage, because the folder's name contains the hash of the files. Throws IoError if the model
// does not exist.
std::map<std::string, std::string> DamageOfStoredModel(const std::filesystem::path& dataset,
                                                       const std::string& path);

// Returns its files as they were stored, or, if their list is lost, as they are.
FileSums SumsOfStoredModel(const std::filesystem::path& dataset, const std::string& path);

// Returns true if the list of a stored model (a path or folder as above) exists and is intact.
bool HasModelList(const std::filesystem::path& dataset, const std::string& path);

// Writes the list of an undamaged model that has none. Throws IoError.
void WriteModelList(const std::filesystem::path& dataset, const std::string& path);

// Returns true if the folder of a model (a path or folder as above) exists.
bool IsStored(const std::filesystem::path& dataset, const std::string& path);

// Returns the folders of models in the dataset: "models/rc7-0123456789abcdef", sorted. Throws
// IoError if the folder that contains them cannot be read.
std::vector<std::string> StoredModels(const std::filesystem::path& dataset);

// Other entries in the folder of models, except those being written: names as above, sorted.
struct StrayModels {
  std::vector<std::string> blocking;  // files and links with the name of a model
  std::vector<std::string> others;
};
StrayModels StrayModelsIn(const std::filesystem::path& dataset);

// Returns stored models that differ from those that the dataset's run was begun with: their files
// were changed during the run, or they came with episodes of another dataset. dataset.json has the
// hashes of all files of the run's models (`files`).
//
// The result maps the folder of the model in the dataset ("models/rc7-0123456789abcdef") to the
// file that differs ("rc7.xml"). A file is identified by its name and content, not by the place of
// the run's models. Models that the run does not list, from a user's own sampler, are accepted.
// Empty without a readable dataset.json.
std::map<std::string, std::string> ChangedModels(const std::filesystem::path& dataset);

// Returns true if a stored model ("models/rc7-0123456789abcdef/rc7.xml") exists and has exactly the
// files that dataset.json lists. False without a readable dataset.json.
bool IsModelOfRun(const std::filesystem::path& dataset, const std::string& path);

}  // namespace robocell::internal
