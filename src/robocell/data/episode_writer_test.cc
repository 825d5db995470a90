#include "robocell/data/episode_writer.h"

#include <malloc.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <thread>
#include <nlohmann/json.hpp>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/dataset.h"
#include "robocell/data/episode_reader.h"
#include "robocell/data/testing/sample_episode.h"
#include "robocell/data/verify.h"
#include "robocell/media/video_writer.h"
#include "robocell/media/warm_program.h"
#include "robocell/testing/count_allocations.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

void ExpectEmpty(const TempDir& folder) { EXPECT_TRUE(fs::is_empty(folder.path())); }

// Decoders that wait for the next read frame are children of this process too.
void ExpectNoChildLeft() {
  ReleaseIdleFiles();
  EXPECT_EQ(waitpid(-1, nullptr, WNOHANG), -1);
  EXPECT_EQ(errno, ECHILD);
}

// Runs `body` in a process of its own, which ends with exit() like any program; returns its exit
// code.
int InOwnProcess(const std::function<int()>& body) {
  const pid_t pid = fork();
  if (pid == 0) exit(body());
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

int CountDescriptors() {
  return static_cast<int>(
      std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator()));
}

// Removes the `run` block, which contains times and the host.
Json WithoutRun(const fs::path& episode) {
  Json json = Json::parse(ReadFile(episode / "episode.json"));
  json.erase("run");
  return json;
}

void ExpectSameBytes(const fs::path& a, const fs::path& b) {
  EXPECT_EQ(ReadFile(a / "steps.h5"), ReadFile(b / "steps.h5"));
  EXPECT_EQ(ReadFile(a / "wrist.mp4"), ReadFile(b / "wrist.mp4"));
  EXPECT_EQ(WithoutRun(a).dump(), WithoutRun(b).dump());
}

TEST(EpisodeWriter, ReadsBackTheWrittenRows) {
  TempDir folder;
  const SampleEpisode sample(5);
  const Episode episode(sample.Write(folder.path(), "pick-000", 100));
  EXPECT_EQ(episode.id(), "pick-000");
  EXPECT_TRUE(episode.success());
  EXPECT_FALSE(episode.truncated());
  EXPECT_THAT(episode.warnings(), ElementsAre("contact buffer full"));
  EXPECT_EQ(episode.rows(), 100);
  EXPECT_EQ(episode.rows("control"), 300);
  const auto qpos = episode.Read<double>("robots/arm/qpos");
  ASSERT_EQ(qpos.size(), 300u);
  for (int row = 0; row < 100; ++row) {
    for (int joint = 0; joint < 3; ++joint)
      EXPECT_EQ(qpos[3 * row + joint], sample.Qpos(row, joint));
  }
  EXPECT_THAT(episode.Read<int32_t>("phase", {.first = 4, .count = 3}), ElementsAre(1, 2, 0));
  EXPECT_THAT(episode.Read<uint8_t>("success", {.first = 10, .count = 2}), ElementsAre(0, 1));
  EXPECT_THAT(episode.Read<double>("control/ctrl", {.first = 299}), ElementsAre(299, -299));
  EXPECT_THAT(episode.Read<double>("cameras/wrist/intrinsics"),
              ElementsAre(60, 0, 31.5, 0, 60, 23.5, 0, 0, 1));
}

TEST(EpisodeWriter, AttributesContainUnitsFramesAndNames) {
  TempDir folder;
  const Episode episode(SampleEpisode().Write(folder.path(), "pick-000"));
  const ColumnInfo& pose = episode.column("objects/cube/pose");
  EXPECT_EQ(pose.spec.type, ColumnType::kFloat32);
  EXPECT_EQ(pose.spec.units, "m, 1");
  EXPECT_EQ(pose.spec.frame, "world");
  EXPECT_THAT(pose.spec.names, ElementsAre("x", "y", "z", "qx", "qy", "qz", "qw"));
  EXPECT_EQ(pose.table, "steps");
  EXPECT_THAT(episode.column("phase").spec.values, ElementsAre("open", "grasp", "lift"));
  EXPECT_EQ(episode.column("control/ctrl").table, "control");
}

TEST(EpisodeWriter, FramesBelongToTheirRows) {
  TempDir folder;
  const Episode episode(SampleEpisode(0).Write(folder.path(), "pick-000", 15));
  VideoReader video = episode.Video("wrist");
  EXPECT_EQ(video.info().frames, 15);
  std::vector<uint8_t> rgb(video.frame_bytes());
  video.Read(9, rgb);
  EXPECT_GT(Psnr(rgb, TestFrame(64, 48, 9)), 3 + Psnr(rgb, TestFrame(64, 48, 8)));
  EXPECT_GT(Psnr(rgb, TestFrame(64, 48, 9)), 3 + Psnr(rgb, TestFrame(64, 48, 10)));
}

TEST(EpisodeWriter, SameRowsGiveSameBytesInAnyProcessAndThread) {
  TempDir folder;
  const SampleEpisode sample(1);
  // Uses the same id in different datasets, like two runs.
  for (const char* run : {"a", "b", "c", "other"}) fs::create_directory(folder / run);
  std::thread thread([&] {
    mallopt(M_PERTURB, 0x5a);  // fills freed memory, which must not affect the output
    sample.Write(folder / "b", "pick-000", 150);
  });
  sample.Write(folder / "a", "pick-000", 150);
  thread.join();
  EXPECT_EQ(InOwnProcess([&] {
              sample.Write(folder / "other", "pick-001", 3);  // history
              sample.Write(folder / "c", "pick-000", 150);
              return 0;
            }),
            0);
  ExpectSameBytes(folder / "a" / "pick-000", folder / "b" / "pick-000");
  ExpectSameBytes(folder / "a" / "pick-000", folder / "c" / "pick-000");
}

TEST(EpisodeWriter, NoEpisodeExistsBeforeCommitOrAfterAbort) {
  TempDir folder;
  const SampleEpisode sample;
  {
    EpisodeWriter episode(folder.path(), "pick-000", sample.schema);
    sample.PutRows(episode, 5);
    EXPECT_EQ(Dataset(folder.path()).size(), 0u);
    episode.Abort();
    ExpectEmpty(folder);
    ExpectThrow<ClosedError>([&] { episode.EndRow(); },
                             "episode 'pick-000': EndRow() after it was aborted");
  }
  {
    EpisodeWriter episode(folder.path(), "pick-000", sample.schema);
    sample.PutRows(episode, 5);
  }
  ExpectEmpty(folder);
  ExpectNoChildLeft();
}

TEST(EpisodeWriter, NamesInvalidPutsWhichCanBeCorrected) {
  TempDir folder;
  const SampleEpisode sample(0, false);
  EpisodeWriter episode(folder.path(), "pick-000", sample.schema);
  ExpectThrow<ArgumentError>(
      [&] { episode.Put(sample.qpos, 1.0); },
      "episode 'pick-000': column 'robots/arm/qpos' expects 3 values of shape (3), got 1");
  ExpectThrow<ArgumentError>([&] { episode.Put(sample.phase, 1.0); },
                             "column 'phase' holds int32, got float64");
  ExpectThrow<ArgumentError>(
      [&] {
        episode.Put(ColumnId{0, 99}, 1.0);
      },
      "table 'steps' has no column number 99");
  episode.Put(sample.time, 0.0);
  ExpectThrow<ArgumentError>([&] { episode.Put(sample.time, 0.0); },
                             "column 'time' was put twice in row 0");
  ExpectThrow<ArgumentError>(
      [&] { episode.EndRow(); },
      "row 0 of table 'steps' is not complete, missing: robots/arm/qpos, objects/cube/pose");
  ExpectThrow<ArgumentError>([&] { episode.Commit({}); }, "episode 'pick-000': it has no row");
  ExpectThrow<ArgumentError>([&] { episode.WriteFrame({0}, {}); },
                             "there is no camera number 0; it has 0");
  episode.Abort();
  EpisodeWriter again(folder.path(), "pick-000", sample.schema);
  sample.PutRow(again, 0);
  again.Put(sample.time, 0.0);
  ExpectThrow<ArgumentError>([&] { again.Commit({}); },
                             "row 1 of table 'steps' was begun (time) but not ended");
}

TEST(EpisodeWriter, EveryRowNeedsItsFrame) {
  TempDir folder;
  const SampleEpisode sample;
  EpisodeWriter episode(folder.path(), "pick-000", sample.schema);
  sample.PutRows(episode, 3);
  sample.PutRow(episode, 3);
  ExpectThrow<ArgumentError>(
      [&] { episode.Commit({}); },
      "camera 'wrist' has 3 frames for the 4 rows of table 'steps'; each row needs one");
  episode.WriteFrame(sample.wrist, TestFrame(64, 48, 3));
  episode.Commit({});
  EXPECT_EQ(Episode(folder / "pick-000").rows(), 4);
  ExpectThrow<ClosedError>([&] { episode.Commit({}); }, "Commit() after it was committed");
}

TEST(EpisodeWriter, AFinishedVideoIsCopied) {
  TempDir folder;
  const SampleEpisode sample;
  const fs::path video = sample.Write(folder.path(), "first", 3) / "wrist.mp4";
  EpisodeWriter episode(folder.path(), "second", sample.schema);
  for (int row = 0; row < 3; ++row) sample.PutRow(episode, row);
  sample.PutControl(episode, 0);
  fs::permissions(video, fs::perms::owner_read);
  episode.AddVideo(sample.wrist, video);
  EXPECT_EQ(episode.frames(sample.wrist), 3);
  ExpectThrow<ArgumentError>([&] { episode.WriteFrame(sample.wrist, TestFrame(64, 48, 3)); },
                             "episode 'second': camera 'wrist' has a video already");
  ExpectThrow<ArgumentError>([&] { episode.AddVideo(sample.wrist, video); },
                             "has frames already; it takes one video, or single frames");
  const fs::path copied = episode.Commit({.success = true});
  EXPECT_EQ(ReadFile(copied / "wrist.mp4"), ReadFile(video));
  EXPECT_EQ(fs::status(copied / "wrist.mp4").permissions(),
            fs::status(copied / "steps.h5").permissions());
  EXPECT_EQ(WithoutRun(copied)["versions"]["encoder"],
            WithoutRun(video.parent_path())["versions"]["encoder"]);
  EXPECT_TRUE(Verify(folder.path()).ok());
}

TEST(EpisodeWriter, RejectsVideosOfAnotherCamera) {
  TempDir folder;
  const SampleEpisode sample;
  const fs::path video = sample.Write(folder.path(), "first", 3) / "wrist.mp4";
  EpisodeSchema schema;
  const ColumnId time = schema.AddColumn({.name = "time"});
  const CameraId slow = schema.AddCamera({.name = "slow", .width = 64, .height = 48});
  const CameraId large = schema.AddCamera(
      {.name = "large", .width = 128, .height = 96, .fps_num = 1000, .fps_den = 66});
  const CameraId same =
      schema.AddCamera({.name = "same", .width = 64, .height = 48, .fps_num = 1000, .fps_den = 66});
  EpisodeWriter episode(folder.path(), "second", schema);
  ExpectThrow<ArgumentError>([&] { episode.AddVideo(slow, video); },
                             "is a video of 64x48 px at 500/33 fps; the camera was declared with "
                             "colour, 64x48 px and 30/1");
  ExpectThrow<ArgumentError>([&] { episode.AddVideo(large, video); }, "128x96 px and 1000/66");
  ExpectThrow<ArgumentError>([&] { episode.AddVideo(same, folder.path() / "none.mp4"); },
                             "episode 'second': camera 'same': ");
  for (int row = 0; row < 2; ++row) {
    episode.Put(time, 0.1 * row);
    episode.EndRow();
    episode.WriteFrame(slow, TestFrame(64, 48, row));
    episode.WriteFrame(large, TestFrame(128, 96, row));
  }
  episode.AddVideo(same, video);
  ExpectThrow<ArgumentError>([&] { episode.Commit({}); },
                             "camera 'same' has 3 frames for the 2 rows of table 'steps'");
}

TEST(EpisodeWriter, DepthRoundTripsBitwise) {
  TempDir folder;
  const Episode episode(SampleEpisode(5, true, true).Write(folder.path(), "pick-000", 12));
  EXPECT_EQ(episode.camera("wrist").depth_file, "wrist.depth.mov");
  VideoReader video = episode.DepthVideo("wrist");
  EXPECT_EQ(video.info().frames, 12);
  std::vector<uint16_t> depth(64 * 48);
  for (const int row : {9, 0, 11, 4}) {
    video.Read(row, depth);
    EXPECT_EQ(depth, TestDepth(64, 48, row + 5)) << row;
  }
  const Json json = Json::parse(episode.json());
  EXPECT_EQ(json["cameras"]["wrist"]["depth"],
            Json({{"file", "wrist.depth.mov"}, {"frames", 12}, {"units", "mm"}}));
  EXPECT_TRUE(json["files"].contains("wrist.depth.mov"));
}

TEST(EpisodeWriter, EveryRowNeedsItsDepth) {
  TempDir folder;
  const SampleEpisode sample(0, true, true);
  EpisodeWriter episode(folder.path(), "pick-000", sample.schema);
  sample.PutRows(episode, 3);
  sample.PutRow(episode, 3);
  episode.WriteFrame(sample.wrist, TestFrame(64, 48, 3));
  ExpectThrow<ArgumentError>([&] { episode.Commit({}); },
                             "camera 'wrist' has 3 depth frames for the 4 rows of table 'steps'");
  EXPECT_EQ(episode.depth_frames(sample.wrist), 3);
  ExpectThrow<ArgumentError>([&] { episode.WriteDepth(sample.wrist, std::vector<uint16_t>(5)); },
                             "expected a 16-bit frame of 48x64x2 = 6144 bytes, got 10");
  episode.WriteDepth(sample.wrist, TestDepth(64, 48, 3));
  episode.Commit({});
  EXPECT_EQ(Episode(folder / "pick-000").rows(), 4);
}

TEST(EpisodeWriter, ACameraWithoutDepthHasNone) {
  TempDir folder;
  const SampleEpisode sample;
  EpisodeWriter episode(folder.path(), "pick-000", sample.schema);
  ExpectThrow<ArgumentError>([&] { episode.WriteDepth(sample.wrist, TestDepth(64, 48, 0)); },
                             "camera 'wrist' was declared without depth");
  sample.PutRows(episode, 2);
  episode.Commit({});
  const Episode read(folder / "pick-000");
  EXPECT_EQ(read.camera("wrist").depth_file, "");
  ExpectThrow<NotFoundError>([&] { read.DepthVideo("wrist"); },
                             "camera 'wrist' has no depth. Cameras with depth: none");
}

TEST(EpisodeWriter, RejectsInvalidOptionsAtOnce) {
  TempDir folder;
  const SampleEpisode sample;
  auto open = [&](const std::string& id, EpisodeOptions options = {}) {
    EpisodeWriter(folder.path(), id, sample.schema, options);
  };
  ExpectThrow<ArgumentError>([&] { open("../x"); }, "'../x' cannot be an episode's id");
  for (const char* id : {".x", "models", "dataset.json", "report.json", "report-0-of-2.json"})
    ExpectThrow<ArgumentError>([&] { open(id); }, "cannot be an episode's id");
  ExpectThrow<ArgumentError>([&] { open("x", {.metadata_json = "{\"seed\": }"}); },
                             "metadata_json is not JSON");
  ExpectThrow<ArgumentError>([&] { open("x", {.versions_json = "[]"}); },
                             "versions_json must be a JSON object, got array");
  ExpectThrow<IoError>([&] { EpisodeWriter(folder / "no", "x", sample.schema); },
                       "No such file or directory");
  ExpectEmpty(folder);
}

TEST(EpisodeWriter, AddedFilesCannotUseReservedNames) {
  TempDir folder;
  const SampleEpisode sample;
  EpisodeWriter episode(folder.path(), "pick-000", sample.schema);
  for (const char* name : {"steps.h5", "wrist.mp4", "episode.json", ".hidden", "../x"}) {
    EXPECT_THROW(episode.AddFile(name, "x"), ArgumentError) << name;
  }
  episode.AddFile("scene.mjb", "x");
  EXPECT_THROW(episode.AddFile("scene.mjb", "y"), ArgumentError);
}

TEST(EpisodeWriter, KeepsNan) {
  TempDir folder;
  EpisodeSchema schema;
  const ColumnId target = schema.AddColumn({.name = "target"});
  EpisodeWriter episode(folder.path(), "a", schema);
  episode.Put(target, std::numeric_limits<double>::quiet_NaN());
  episode.EndRow();
  episode.Commit({});
  EXPECT_TRUE(std::isnan(Episode(folder / "a").Read<double>("target")[0]));
}

TEST(EpisodeWriter, ADeadEncoderEndsTheEpisode) {
  TempDir folder;
  const SampleEpisode sample;
  ReleaseIdleFiles();
  EpisodeWriter episode(folder.path(), "pick-000", sample.schema);
  sample.PutRows(episode, 2);
  // The only child of this process is the encoder, but for what waits to become the next one.
  std::ifstream children("/proc/self/task/" + std::to_string(getpid()) + "/children");
  int encoder = 0;
  while (children >> encoder && encoder == internal::WarmProgramPid()) {
  }
  ASSERT_GT(encoder, 0);
  kill(encoder, SIGKILL);
  const std::string message = ExpectThrow<EncoderDied>(
      [&] {
        sample.PutRows(episode, 200);
        episode.Commit({});
      },
      "episode 'pick-000': video ");
  EXPECT_THAT(message, HasSubstr("killed by signal 9"));
  EXPECT_EQ(ExpectThrow<IoError>([&] { episode.Commit({}); }, ""), message);
  ExpectEmpty(folder);
  ExpectNoChildLeft();
}

// Simulates a disk that is full after `bytes` per file. ffmpeg dies of SIGXFSZ, HDF5 gets EFBIG.
int WriteWithSpace(const SampleEpisode& sample, const fs::path& dataset, rlim_t bytes) {
  signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_FSIZE, &limit);
  try {
    sample.Write(dataset, "pick-000", 300);
    return 0;
  } catch (const IoError& error) {
    return std::string(error.what()).find("pick-000") == std::string::npos ? 2 : 1;
  } catch (...) {
    return 3;
  }
}

TEST(EpisodeWriter, AFullDiskIsAnErrorAtEveryPoint) {
  TempDir folder;
  const SampleEpisode sample(0, false);
  const auto size = fs::file_size(sample.Write(folder.path(), "whole", 300) / "steps.h5");
  for (rlim_t space = 0; space < size; space += size / 60) {
    EXPECT_EQ(InOwnProcess([&] { return WriteWithSpace(sample, folder.path(), space); }), 1)
        << space << " bytes";
    EXPECT_EQ(Dataset(folder.path()).size(), 1u) << space << " bytes";
  }
  EXPECT_EQ(InOwnProcess([&] { return WriteWithSpace(sample, folder.path(), 2 * size); }), 0);
  EXPECT_TRUE(Verify(folder.path()).ok());
}

TEST(EpisodeWriter, FailedEpisodesKeepNoDescriptorsOpen) {
  TempDir folder;
  const SampleEpisode sample(0, false);
  EXPECT_EQ(InOwnProcess([&] {
              WriteWithSpace(sample, folder.path(), 9000);
              const int before = CountDescriptors();
              for (int i = 0; i < 10; ++i) WriteWithSpace(sample, folder.path(), 9000);
              return CountDescriptors() - before;
            }),
            0);
}

TEST(EpisodeWriter, AFullDiskWithVideosIsAnError) {
  TempDir folder;
  const SampleEpisode sample;
  for (const rlim_t space : {0, 5000, 20000}) {
    EXPECT_EQ(InOwnProcess([&] { return WriteWithSpace(sample, folder.path(), space); }), 1)
        << space << " bytes";
  }
  EXPECT_EQ(Dataset(folder.path()).size(), 0u);
}

int64_t ResidentBytes() {
  std::ifstream statm("/proc/self/statm");
  int64_t all = 0;
  int64_t resident = 0;
  statm >> all >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

TEST(EpisodeWriter, MemoryDoesNotGrowWithTheEpisode) {
  TempDir folder;
  EpisodeSchema schema;
  const ColumnId wide = schema.AddColumn({.name = "wide", .shape = {64}});
  EpisodeWriter episode(folder.path(), "long", schema);
  const std::vector<double> row(64, 0.5);
  auto put = [&](int rows) {
    for (int i = 0; i < rows; ++i) {
      episode.Put(wide, row);
      episode.EndRow();
    }
  };
  put(2000);
  const int64_t before = ResidentBytes();
  put(60000);  // 30 MB
  EXPECT_LT(ResidentBytes() - before, 3 << 20);
}

TEST(EpisodeWriter, FillingARowAllocatesNothing) {
  TempDir folder;
  const SampleEpisode sample(0, false);
  EpisodeWriter episode(folder.path(), "a", sample.schema);
  sample.PutRow(episode, 0);
  const AllocationCount count;
  for (int row = 1; row < 60; ++row) sample.PutRow(episode, row);  // within one chunk
  EXPECT_EQ(count.allocations(), 0);
}

TEST(EpisodeWriter, ManyEpisodesLeaveNoDescriptorsOpen) {
  TempDir folder;
  const SampleEpisode sample(0, false);
  sample.Write(folder.path(), "first");
  ReleaseIdleFiles();  // readers' cached files do not count here
  const auto before = CountDescriptors();
  for (int i = 0; i < 20; ++i) {
    sample.Write(folder.path(), "e" + std::to_string(i));
    EpisodeWriter(folder.path(), "aborted", sample.schema);
    Episode(folder / "first").Read<double>("time");
  }
  ReleaseIdleFiles();
  EXPECT_EQ(CountDescriptors(), before);
}

TEST(EpisodeWriter, SeveralThreadsWriteIndependentEpisodes) {
  TempDir folder;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&folder, t] {
      for (int i = 0; i < 3; ++i) {
        SampleEpisode(t, false).Write(folder.path(),
                                      "t" + std::to_string(t) + "-" + std::to_string(i), 100);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  const VerifyResult result = Verify(folder.path());
  EXPECT_TRUE(result.ok()) << result.Text();
  EXPECT_EQ(result.good.size(), 12u);
}

}  // namespace
}  // namespace robocell
