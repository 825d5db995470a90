// The metadata of a house, `<house>_metadata.json`: its objects by their bodies, with categories,
// assets, rooms, and what stands on or in what.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace robocell::internal {

struct HouseObject {
  std::string category = {};  // "RemoteControl"
  std::string asset = {};     // the id of its asset
  std::string id = {};        // the id of the object in the house
  std::string parent = {};    // the object that it is on or in; "" for none
  std::vector<std::string> children = {};
  std::vector<std::string> words = {};  // descriptions; of houses that robocell made
  std::optional<int> room = {};
  bool is_static = false;
  // Names in the model (the keys) by their names in the asset.
  std::map<std::string, std::string> bodies = {}, joints = {}, sites = {};
};

struct HouseMetadata {
  std::map<std::string, HouseObject> objects = {};  // by the name of the body
};

// Reads it. Entries of another type than expected are left out and counted in `ignored`, so that
// other versions of the format can be read. Throws IoError for a file that is not such JSON.
HouseMetadata ReadHouseMetadata(const std::filesystem::path& path, int* ignored = nullptr);
// Returns the text of the file, the same for the same metadata.
std::string HouseMetadataText(const HouseMetadata& metadata);

// Returns the words of a category: "RemoteControl" -> "remote control", "coffee_machine" -> "coffee
// machine".
std::string WordsOfCategory(const std::string& category);

}  // namespace robocell::internal
