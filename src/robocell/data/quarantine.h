// Moves damaged files of a dataset to its quarantine folder. Nothing is deleted.
#pragma once

#include <filesystem>
#include <string>

namespace robocell {

// Moves something of the dataset ("s0000_e0017", "models/rc7-0123456789abcdef") into its folder
// .quarantine, under a name that is free there, and returns that name. IoError.
std::string Quarantine(const std::filesystem::path& dataset, const std::string& name);

}  // namespace robocell
