// A dataset: a folder of committed episodes. What counts is what is on the disk; dataset.json
// describes the run that made it and is never asked how many episodes there are.
//
//   for (const Episode& episode : Dataset("out/pick_v1")) Use(episode.Read<double>("reward"));
//
// IoError names the folder. Ids are in byte order, so zero-padded numbers are in the order of their
// numbers. A Dataset is a snapshot: episodes committed later are seen after Refresh(). A selection of
// its episodes is a Dataset too, of those only:
//
//   const Dataset all("out/pick_v1"), held_out = all.Select({"s0000_e0007", "s0000_e0019"});
#pragma once

#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robocell/data/episode_reader.h"

namespace robocell {

class Dataset {
 public:
  // Raises IoError if the folder does not exist, and ArgumentError for a folder that is not a
  // dataset, with the nearest dataset. Misnamed folders are logged.
  explicit Dataset(std::filesystem::path folder);

  const std::filesystem::path& folder() const { return folder_; }
  const std::vector<std::string>& ids() const { return ids_; }
  size_t size() const { return ids_.size(); }
  // Folders with an episode's name that are or were one and have no episode.json: a careless copy,
  // a lost file. They do not count; Repair (verify.h) moves them aside.
  const std::vector<std::string>& broken() const { return broken_; }
  // Folders whose episode.json is of an episode of another name, with that: somebody copied or
  // renamed them. They do not count either.
  const std::map<std::string, std::string>& misnamed() const { return misnamed_; }
  bool Contains(std::string_view id) const;
  // NotFoundError with the nearest ids.
  Episode Open(const std::string& id) const;
  // The episode of ids()[index].
  Episode At(size_t index) const { return Episode(folder_ / ids_.at(index)); }
  // These of its episodes, in this order. NotFoundError for one that it has not.
  Dataset Select(std::vector<std::string> ids) const;
  bool is_selection() const { return is_selection_; }
  // Looks at the folder again; a selection loses those of its episodes that are gone.
  void Refresh();

  // Restores a dataset from the lists of another process, without reading the folder.
  static Dataset Restore(std::filesystem::path folder, std::vector<std::string> ids,
                         bool is_selection);

  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = Episode;
    using difference_type = std::ptrdiff_t;
    using pointer = const Episode*;
    using reference = Episode;
    Episode operator*() const { return dataset_->At(index_); }
    Iterator& operator++() {
      ++index_;
      return *this;
    }
    bool operator!=(const Iterator& other) const { return index_ != other.index_; }

   private:
    friend class Dataset;
    Iterator(const Dataset* dataset, size_t index) : dataset_(dataset), index_(index) {}
    const Dataset* dataset_;
    size_t index_;
  };
  Iterator begin() const { return {this, 0}; }
  Iterator end() const { return {this, size()}; }

 private:
  Dataset() = default;
  void RequireId(const std::string& id) const;

  std::filesystem::path folder_;
  bool is_selection_ = false;
  std::vector<std::string> ids_, broken_;
  std::map<std::string, std::string> misnamed_;
};

// dataset.json: a JSON object as text, kept with a hash of itself (checked_json.h) and replaced in
// one step. ArgumentError if the text is no JSON object.
void WriteManifest(const std::filesystem::path& dataset, const std::string& json);
// With its hash. Unset if there is none; IoError if it is not what was written.
std::optional<std::string> ReadManifest(const std::filesystem::path& dataset);

}  // namespace robocell
