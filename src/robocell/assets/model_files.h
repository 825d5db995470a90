// The files that models are made from, found in their text, without the engine: the file itself,
// what it includes, meshes, textures, height fields, other models. A name that no file has is
// skipped: the engine reports it when the model is compiled.
//
//   for (const auto& [name, path] : ModelFiles("/menagerie/ufactory_xarm7/xarm7.xml")) ...
//   // "ufactory_xarm7/assets/link1.stl" -> its absolute path
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "robocell/base/file_set.h"

namespace robocell {

// Names begin with the folder of the model, so they are the same on every machine. IoError when
// `model` cannot be read.
std::map<std::string, std::filesystem::path> ModelFiles(const std::filesystem::path& model);

// The same files, known by what they hold.
FileSet ModelFileSet(const std::filesystem::path& model);

}  // namespace robocell
