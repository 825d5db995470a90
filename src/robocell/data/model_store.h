// The models that the episodes of a dataset were made in: each is kept once, by its content, in
// <dataset>/models/<name>-<hash>, with its meshes and textures. Ordinary model files: a viewer
// opens them. They are what makes an episode replayable where its models are not installed. Beside
// them SHA256SUMS lists their hashes (`sha256sum --check` reads it); the folder's name has its own.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/base/file_set.h"

namespace robocell {

// The list of a stored model's files.
inline constexpr std::string_view kModelListFile = "SHA256SUMS";

// Where a model is kept, within the dataset: "models/rc7-0123456789abcdef/rc7.xml".
std::string StoredModelPath(const FileSet& model);

// Copies the model into the dataset unless it is there. Complete or absent, like an episode; any
// number of processes may store the same. IoError.
void StoreModel(const std::filesystem::path& dataset, const FileSet& model);

// Whether a text is such a path, and leads nowhere else.
bool IsStoredModelPath(const std::string& path);

// The part of such a path that names the model: "models/rc7-0123456789abcdef".
std::string StoredModelFolder(const std::string& path);

// What is wrong with the files of a stored model (a path or folder as above), by their names within
// it: "assets/a.stl" -> "it is missing"; nothing when they are what was stored. That the list is
// missing or damaged is none: the folder's name says whether the files are right. IoError when the
// model is not there.
std::map<std::string, std::string> DamageOfStoredModel(const std::filesystem::path& dataset,
                                                       const std::string& path);

// Its files as they were stored, or, when their list is lost, as they are.
FileSums SumsOfStoredModel(const std::filesystem::path& dataset, const std::string& path);

// Whether the list of a stored model, which has a path or folder as above, is there and whole.
bool HasModelList(const std::filesystem::path& dataset, const std::string& path);

// Writes the list of an undamaged model that has none. IoError.
void WriteModelList(const std::filesystem::path& dataset, const std::string& path);

// Whether the folder of a model, which has a path or folder as above, is there.
bool IsStored(const std::filesystem::path& dataset, const std::string& path);

// The folders of models in the dataset: "models/rc7-0123456789abcdef", sorted. IoError when the
// folder that they are in cannot be looked into.
std::vector<std::string> StoredModels(const std::filesystem::path& dataset);

// What else is in the folder of models, but for what somebody is writing: names as above, sorted.
struct StrayModels {
  std::vector<std::string> in_the_way;  // files and links that have the name of a model
  std::vector<std::string> others;
};
StrayModels StrayModelsIn(const std::filesystem::path& dataset);

}  // namespace robocell
