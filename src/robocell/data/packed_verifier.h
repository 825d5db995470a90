// Checks what a packed dataset has beside its episodes: the shards' sizes and tables, and all other
// files. Private to data.
#pragma once

#include <exception>
#include <filesystem>
#include <functional>
#include <string>

#include "robocell/base/packed_index.h"

namespace robocell::internal {

// Receives a problem; `error` is the exception if the file could not be read.
using PackReport = std::function<void(const std::string& file, const std::string& reason,
                                      const std::exception* error)>;
void VerifyPack(const std::filesystem::path& dataset, const PackedIndex& index,
                const PackReport& report);

}  // namespace robocell::internal
