// The threads that draw one image, and how they divide it: into bands of rows of blocks. Internal
// to render/.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "robocell/base/worker_threads.h"
#include "robocell/render/soft_frame.h"

namespace robocell::internal {

class SoftThreads {
 public:
  // 0: as many as the machine has cores.
  explicit SoftThreads(int count);

  int count() const { return static_cast<int>(scratches_.size()); }

  // Calls work(rows, number) for bands that make up the rows 0 to `rows` - 1, on all threads, and
  // returns when all is done. There is one band a thread, with numbers from 0 on.
  template <class Work>
  void InBands(int rows, const Work& work) {
    if (!workers_) return work(SoftRows{0, rows}, 0);
    const int bands = std::min(count(), rows);
    const auto band = [&](int i) { work(SoftRows{rows * i / bands, rows * (i + 1) / bands}, i); };
    workers_->Run(bands, std::cref(band));
  }

  SoftScratch* scratch(int band) { return &scratches_[static_cast<size_t>(band)]; }

 private:
  std::unique_ptr<WorkerThreads> workers_;  // null: the caller's thread alone
  std::vector<SoftScratch> scratches_;
};

}  // namespace robocell::internal
