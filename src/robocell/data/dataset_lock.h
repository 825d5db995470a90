// Keeps two runs, or a run and a repair, from working on the same dataset: lock files in its
// folder. The whole plan is locked exclusively; the shards of a plan share the folder and lock
// themselves. Shards of different counts make the same episodes: beside one another count is
// refused, and of two that start at once one begins. Who only adds episodes may do so beside a run,
// but not while somebody moves things about.
//
//   DatasetLock lock("out/pick_v1");         // IoError names the owner when it is taken
//   DatasetLock shard("out/pick_v1", 0, 8);  // shard 0 of 8
//
// The system frees the locks of a process that is killed. Programs of your own that write into a
// dataset while others may do so too should hold one as well.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robocell/data/file_lock.h"

namespace robocell {

class DatasetLock {
 public:
  // `dataset` must exist. Of the whole plan when `count` is 1. IoError when it is taken, or when
  // the folder cannot be written.
  explicit DatasetLock(const std::filesystem::path& dataset, int shard = 0, int count = 1);
  // Of somebody who writes episodes, such as a Runner: any number may, beside runs.
  static DatasetLock Writing(const std::filesystem::path& dataset);
  // Of a writer that numbers its episodes "<prefix>-000017" and so on: no other has that prefix.
  // IoError names the owner when one has.
  static DatasetLock Numbering(const std::filesystem::path& dataset, const std::string& prefix);
  // Of somebody who changes what is there (repair, beginning anew): neither runs nor writers.
  static DatasetLock Alone(const std::filesystem::path& dataset);
  DatasetLock(DatasetLock&&) = default;
  DatasetLock& operator=(DatasetLock&&) = default;

 private:
  DatasetLock() = default;
  std::vector<FileLock> held_;
};

}  // namespace robocell
