// Fuzzes changed datasets: no byte can change unnoticed, and opening one gives an episode or an
// Error.
//
// The first byte selects the change: edits of one of the files, each a position and a value, or an
// episode.json from the fuzzer without its last field, `run`, and last brace; its hash is correct,
// so that it is parsed.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/dataset.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_reader.h"
#include "robocell/data/testing/sample_episode.h"
#include "robocell/data/verify.h"
#include "robocell/testing/temp_dir.h"

namespace fs = std::filesystem;

namespace {

// One good episode, written once.
struct Sample {
  robocell::TempDir dataset;
  fs::path episode = robocell::SampleEpisode(0, false).Write(dataset.path(), "e0");
  std::vector<fs::path> files;
  std::vector<std::string> contents;

  Sample() {
    for (const auto& entry : fs::directory_iterator(episode)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) contents.push_back(robocell::ReadFile(file));
  }
};

void Write(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

// Opens and reads everything that can be opened. Files do not stay open: the next input overwrites
// them.
void Use(const fs::path& episode) {
  robocell::ReleaseIdleFiles();
  try {
    const robocell::Episode opened(episode);
    for (const robocell::ColumnInfo& column : opened.columns()) (void)column.rows;
  } catch (const robocell::Error&) {
    return;  // a rejection is fine
  }
}

// Each edit has three bytes of position and one of value.
std::string Edited(std::string bytes, const uint8_t* edits, size_t size) {
  for (; size >= 4 && !bytes.empty(); edits += 4, size -= 4) {
    const size_t at = (edits[0] | edits[1] << 8 | edits[2] << 16) % (bytes.size() + 1);
    if (at == bytes.size()) {
      bytes.resize(bytes.size() * edits[3] / 256);  // cut off
    } else {
      bytes[at] = static_cast<char>(edits[3]);
    }
  }
  return bytes;
}

void Damage(Sample& sample, size_t which, const uint8_t* edits, size_t size) {
  const std::string bytes = Edited(sample.contents[which], edits, size);
  const bool changed = bytes != sample.contents[which];
  Write(sample.files[which], bytes);
  if (robocell::Verify(sample.dataset.path()).ok() == changed) std::abort();
  // Damaged numbers are for Verify to find; they never reach the HDF5 library.
  if (sample.files[which].filename() == robocell::kEpisodeFile) Use(sample.episode);
  Write(sample.files[which], sample.contents[which]);
}

void Forge(Sample& sample, std::string text) {
  const auto file =
      std::find_if(sample.files.begin(), sample.files.end(),
                   [](const fs::path& path) { return path.filename() == robocell::kEpisodeFile; });
  text += ", \"run\": {\"json_sha256\": \"" + std::string(robocell::kHashPlaceholder) + "\"}}";
  Write(*file, robocell::InsertSelfHash(text));
  (void)robocell::Verify(sample.dataset.path());
  Use(sample.episode);
  Write(*file, sample.contents[static_cast<size_t>(file - sample.files.begin())]);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static auto* sample = new Sample;
  if (size == 0) return 0;
  const size_t which = data[0] % (sample->files.size() + 1);
  if (which < sample->files.size()) {
    Damage(*sample, which, data + 1, size - 1);
  } else {
    Forge(*sample, std::string(reinterpret_cast<const char*>(data) + 1, size - 1));
  }
  return 0;
}
