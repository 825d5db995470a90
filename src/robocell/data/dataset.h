// A dataset: a folder of committed episodes. The episodes on the disk are the dataset; dataset.json
// describes the run that made it and is never used to count episodes. A packed dataset (`robocell
// pack`) is read like any other; its index counts.
//
//   for (const Episode& episode : Dataset("out/pick_v1")) Use(episode.Read<double>("reward"));
//
// IoError names the folder. Ids are in byte order, so zero-padded numbers are in numerical order. A
// Dataset is a snapshot: it shows episodes committed later after Refresh(). A selection of its
// episodes is also a Dataset, of those only:
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
  // Throws IoError if the folder does not exist, and ArgumentError, with the nearest dataset, for a
  // folder that is not a dataset. Misnamed folders are logged.
  explicit Dataset(std::filesystem::path folder);

  const std::filesystem::path& folder() const { return folder_; }
  const std::vector<std::string>& ids() const { return ids_; }
  size_t size() const { return ids_.size(); }
  // Returns folders with an episode's name that are or were one and have no episode.json: an
  // incomplete copy, a lost file. They do not count; Repair (verify.h) moves them aside.
  const std::vector<std::string>& broken() const { return broken_; }
  // Returns folders whose episode.json belongs to an episode of another name, with that name: they
  // were copied or renamed. They do not count either.
  const std::map<std::string, std::string>& misnamed() const { return misnamed_; }
  bool Contains(std::string_view id) const;
  // Throws NotFoundError with the nearest ids.
  Episode Open(const std::string& id) const;
  // Returns the episode of ids()[index].
  Episode At(size_t index) const { return Episode(folder_ / ids_.at(index)); }
  // Returns these of its episodes, in this order. Throws NotFoundError for one that it lacks.
  Dataset Select(std::vector<std::string> ids) const;
  bool is_selection() const { return is_selection_; }
  // Reads the folder again; a selection loses episodes that no longer exist.
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

// Writes dataset.json: a JSON object as text, stored with a hash of itself (base/checked_json.h) and
// replaced in one step. Throws ArgumentError if the text is not a JSON object.
void WriteManifest(const std::filesystem::path& dataset, const std::string& json);
// Returns the text with its hash. Unset if there is none; throws IoError if it was changed after
// writing.
std::optional<std::string> ReadManifest(const std::filesystem::path& dataset);

}  // namespace robocell
