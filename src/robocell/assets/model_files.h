// The files that models are made from, found in their text, without the engine: the file itself,
// what it includes, meshes, textures, height fields, other models. Names are read and looked for as
// the engine does (XML of any suffix; asset folders wherever they are written), in every place
// where it might look.
//
//   const FileSet arm = ModelFileSet("/menagerie/ufactory_xarm7/xarm7.xml");
//   const ModelFiles found = FindModelFiles(stored);   // also what is named and not there
//   RequireOnlyFiles(model);                           // before the engine opens what it names
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robocell/base/file_set.h"

namespace robocell::internal {

// A name that no file has. The engine reports it when the model is compiled.
struct MissingFile {
  std::filesystem::path document;  // that names it
  std::string name;                // as written; "" when the document itself cannot be read
  std::string reason;
};

struct ModelFiles {
  std::vector<std::filesystem::path> files;  // absolute, sorted, with the model
  std::vector<MissingFile> missing;
  std::vector<MissingFile> no_files;  // there is a pipe, a socket or a device, which may never end
};

// IoError when `model` cannot be read.
ModelFiles FindModelFiles(const std::filesystem::path& model);

// Raises SpecError if `model`, or a file that it includes, names a pipe, a socket or a device: the
// engine would open it and wait for ever. The engine reports files that cannot be read.
void RequireOnlyFiles(const std::filesystem::path& model);

// Those that are there, known by what they hold.
FileSet ModelFileSet(const std::filesystem::path& model, const Hashing& hashing = {});

}  // namespace robocell::internal
