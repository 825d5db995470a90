#include "robocell/rollout/env_of_episode.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>
#include <nlohmann/json.hpp>

#include "robocell/base/checked_json.h"
#include "robocell/base/error.h"
#include "robocell/base/hash.h"
#include "robocell/base/units.h"
#include "robocell/data/dataset.h"
#include "robocell/data/episode_files.h"
#include "robocell/data/episode_writer.h"
#include "robocell/data/hdf5.h"
#include "robocell/env/arm_target.h"
#include "robocell/env/env_scene.h"
#include "robocell/env/testing/envs.h"
#include "robocell/media/png.h"
#include "robocell/rollout/env_recorder.h"
#include "robocell/spec/randomize_config.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

const Pose kElsewhere = Pose::FromRpy({1, -1, 0.3}, {0, 0, 2});

EnvStep StepTo(Env& env, const Eigen::Vector3d& tcp, double gripper) {
  std::vector<double> action(8);
  internal::PutTquat(Pose::FromRpy(tcp, {internal::kPi, 0, 0}), action);
  action[7] = gripper;
  return env.Step(action);
}

class EnvOfEpisodeTest : public ::testing::Test {
 protected:
  // Records three steps above the cube.
  Episode Record(const EnvConfig& config) const {
    Env env(config);
    EnvRecorder recorder(env, folder.path());
    env.Reset({.seed = 5});
    for (const double z : {0.3, 0.2, 0.1}) StepTo(env, {0.45, 0, z}, 1);
    recorder.Close();
    return Dataset(folder.path()).Open(recorder.episodes().front());
  }
  // Returns the same episode with one number of a column changed.
  Episode Changed(const Episode& from, const std::string& column, size_t number, double by) const {
    EpisodeSchema schema;
    std::vector<std::pair<ColumnId, std::vector<double>>> doubles;
    for (const ColumnInfo& info : from.columns()) {
      if (info.table.empty()) {
        schema.AddConstant(info.spec, from.Read<double>(info.spec.name));
      } else if (info.table == "steps" && info.spec.type == ColumnType::kFloat64) {
        doubles.emplace_back(schema.AddColumn(info.spec), from.Read<double>(info.spec.name));
        if (info.spec.name == column) doubles.back().second[number] += by;
      }
    }
    const ColumnId tick = schema.AddColumn(from.column(std::string(kControlTickColumn)).spec);
    const TableId control = schema.AddTable("control");
    const ColumnId time = schema.AddColumn({.name = "time", .units = "s"}, control);
    EpisodeWriter writer(folder.path(), "changed" + std::to_string(++count), schema,
                         {.metadata_json = from.metadata_json(), .features = from.features()});
    const auto ticks = from.Read<int64_t>(std::string(kControlTickColumn));
    for (size_t row = 0; row < ticks.size(); ++row) {
      for (const auto& [id, values] : doubles) {
        const size_t width = values.size() / ticks.size();
        writer.Put(id, std::span(values).subspan(row * width, width));
      }
      writer.Put(tick, ticks[row]);
      writer.EndRow();
    }
    for (const double t : from.Read<double>("control/time")) {
      writer.Put(time, t);
      writer.EndRow(control);
    }
    return Episode(
        writer.Commit({.end_reason = from.end_reason(), .results_json = from.results_json()}));
  }

  // Returns the same episode with another episode.json, whose hash is correct.
  template <class F>
  Episode Edited(const Episode& from, F&& edit) const {
    const std::filesystem::path to = folder / ("edited" + std::to_string(++count));
    std::filesystem::copy(from.folder(), to, std::filesystem::copy_options::recursive);
    auto json = nlohmann::ordered_json::parse(from.json());
    edit(json);
    json["run"][kJsonHash] = kHashPlaceholder;
    std::ofstream(to / kEpisodeFile) << InsertSelfHash(json.dump(2));
    return Episode(to);
  }

  // Returns the same episode with one row less of a column in steps.h5.
  Episode WithShortColumn(const Episode& from, const std::string& column) const {
    return WithRows(from, from.rows(), [&](const ColumnInfo& info) {
      return info.rows - (info.spec.name == column ? 1 : 0);
    });
  }
  // Returns the same episode with `steps_rows` rows, whose columns have the lengths of `rows_of`.
  template <class F>
  Episode WithRows(const Episode& from, int64_t steps_rows, F&& rows_of) const {
    return Edited(from, [&](nlohmann::ordered_json& json) {
      const std::filesystem::path steps =
          folder / ("edited" + std::to_string(count)) / std::string(kStepsFile);
      std::filesystem::remove(steps);
      internal::hdf5::File file = internal::hdf5::File::Create(steps);
      for (const ColumnInfo& info : from.columns()) {
        const ColumnSpec& spec = info.spec;
        std::vector<std::byte> bytes(from.ValueCount(spec.name) * SizeOf(spec.type));
        from.ReadBytes(spec.name, {}, spec.type, bytes);
        internal::hdf5::H5Dataset dataset =
            info.table.empty() ? file.CreateFixed(spec.name, spec.type, spec.shape)
                               : file.CreateExtendible(spec.name, spec.type, spec.shape, info.rows);
        if (info.table.empty()) {
          dataset.WriteAll(bytes);
        } else {
          dataset.SetText("table", info.table);
          if (const int64_t rows = rows_of(info)) dataset.AppendChunk(rows, bytes);
        }
        dataset.Close();
      }
      file.Close();
      json["tables"]["steps"]["rows"] = steps_rows;
      json["files"][kStepsFile] = {{"bytes", std::filesystem::file_size(steps)},
                                   {"sha256", Sha256File(steps)}};
    });
  }

  TempDir folder;
  mutable int count = 0;
};

// Neither the images of looks that were drawn nor those of pinned ones are in a dataset.
TEST_F(EnvOfEpisodeTest, WithoutImagesNoTextureIsRead) {
  EnvConfig config = Rc7WithCube();
  const TempDir images;
  const std::filesystem::path oak = images / "oak.png", elm = images / "elm.png";
  for (const std::filesystem::path& file : {oak, elm})
    WritePng(file, RgbImage{1, 1, std::vector<uint8_t>{9, 9, 9}});
  RandomizeConfig& randomize = config.randomize.emplace();
  randomize.appearance["cube"].texture = {elm.string()};
  randomize.dynamics["cube"].mass.emplace().uniform = Vec2{0.02, 0.08};
  randomize.pinned["ground/texture"].word = oak.string();
  const Episode episode = Record(config);
  std::filesystem::remove(oak);
  std::filesystem::remove(elm);
  const std::unique_ptr<Env> env = EnvOfEpisode(episode, false);
  EXPECT_TRUE(ReplayActions(*env, episode, {.tolerance = 0}).ok());
  EXPECT_FALSE(env->randomized().contains("ground/texture"));
  EXPECT_TRUE(env->randomized().contains("cube/mass"));
}

TEST_F(EnvOfEpisodeTest, ReproducesAnEpisodeBitwise) {
  const Episode episode = Record(Rc7WithCube());
  Env other(Rc7WithCube());
  const ReplayResult report = ReplayActions(other, episode);
  EXPECT_TRUE(report.ok()) << report.Text();
  EXPECT_EQ(report.rows, 3);
  EXPECT_EQ(report.ticks, static_cast<int64_t>(episode.ValueCount("control/time")));
  other.Reset();
  EXPECT_TRUE(ReplayActions(other, episode).ok());
  const std::unique_ptr<Env> same = EnvOfEpisode(episode);
  EXPECT_TRUE(ReplayActions(*same, episode).ok());
  EXPECT_EQ(same->config().task->kind(), "pick");
}

TEST_F(EnvOfEpisodeTest, ReportsDifferences) {
  const Episode episode = Record(Rc7WithCube());
  Env env(Rc7WithCube());
  ReplayResult report = ReplayActions(env, Changed(episode, "observation/robot/joints", 7 + 3, 1));
  EXPECT_EQ(report.rows, 0);
  ASSERT_TRUE(report.first);
  EXPECT_EQ(report.first->row, 1);
  EXPECT_EQ(report.first->what, "robot.joints[3]");
  EXPECT_EQ(report.first->column, "observation/robot/joints");
  EXPECT_EQ(report.first->recorded, report.first->replayed + 1);
  report = ReplayActions(env, Changed(episode, "action/robot/tquat", 14, 0.01));
  ASSERT_TRUE(report.first);
  EXPECT_EQ(report.first->row, 3) << "what the last action led to";
  EXPECT_GT(report.first->others, 0);
  const Episode paid = Changed(episode, "reward", 0, 0.1);
  report = ReplayActions(env, paid);
  ASSERT_TRUE(report.first);
  EXPECT_EQ(report.first->what, "the reward");
  EXPECT_TRUE(ReplayActions(env, paid, {.tolerance = 0.2}).ok());
  ExpectThrow<ArgumentError>([&] { ReplayActions(env, episode, {.tolerance = -1}); },
                             "tolerance -1 is not at least 0");
}

TEST_F(EnvOfEpisodeTest, ReplaysAtAnotherRootPose) {
  const Episode episode = Record(Rc7WithCube());
  Env there(Rc7WithCube(kElsewhere));
  const ReplayResult report =
      ReplayActions(there, episode, {.frame = StateFrame::kRoot, .tolerance = 1e-6});
  EXPECT_TRUE(report.ok()) << report.Text();
  const ReplayResult world = ReplayActions(there, episode, {.tolerance = 1e-6});
  ASSERT_TRUE(world.first);
  EXPECT_EQ(world.first->row, 0);
  EXPECT_EQ(world.first->column, "observation/objects/cube/tquat");
}

TEST_F(EnvOfEpisodeTest, EndsWhenThePollThrows) {
  struct Enough {};
  const Episode episode = Record(Rc7WithCube());
  Env env(Rc7WithCube());
  int calls = 0, last = 0;
  const auto poll = [&] {
    if (++calls == last) throw Enough();
  };
  EXPECT_TRUE(ReplayActions(env, episode, {.poll = poll}).ok());
  last = calls / 2;
  EXPECT_GT(last, 3) << "after each step of the engine";
  calls = 0;
  EXPECT_THROW(ReplayActions(env, episode, {.poll = poll}), Enough);
  EXPECT_EQ(calls, last);
  ExpectThrow<Error>([&] { StepTo(env, {0.45, 0, 0.3}, 1); }, "call reset to go on");
  EXPECT_TRUE(ReplayActions(env, episode).ok());
}

TEST_F(EnvOfEpisodeTest, RejectsOtherConfigurationsAndEpisodes) {
  const Episode episode = Record(Rc7WithCube());
  Env env(Rc7Env());
  ExpectThrow<ArgumentError>([&] { ReplayActions(env, episode); },
                             "is of another configuration: feature 'observation/objects/cube/tquat'"
                             " is recorded and not here");
  EnvConfig more = Rc7WithCube();
  more.root_frame_objects["ball"] = {.offset = Pose(Eigen::Vector3d(0.6, 0.3, 0.03)),
                                     .shape = Shape::kSphere,
                                     .size = Vec3{0.03, 0, 0},
                                     .mass = 0.05};
  Env loose(more);
  ExpectThrow<ArgumentError>([&] { ReplayActions(loose, episode); },
                             "the state is of another environment");
  EpisodeSchema schema;
  const ColumnId time = schema.AddColumn({.name = "time"});
  EpisodeWriter writer(folder.path(), "foreign", schema);
  writer.Put(time, 0.0);
  writer.EndRow();
  const Episode foreign(writer.Commit({}));
  ExpectThrow<ArgumentError>([&] { EnvOfEpisode(foreign); }, "was not recorded in an environment");
  ExpectThrow<ArgumentError>([&] { ReplayActions(env, foreign); },
                             "was not recorded in an environment");
}

TEST_F(EnvOfEpisodeTest, ColumnsHaveARowForEachStep) {
  const Episode episode = Record(Rc7WithCube());
  Env env(Rc7WithCube());
  // 1e15 rows are not allocated before they are compared.
  for (const int64_t rows : {int64_t{0}, int64_t{2}, int64_t{1000000000000000}}) {
    const Episode edited =
        Edited(episode, [&](auto& json) { json["tables"]["steps"]["rows"] = rows; });
    const std::string problem = "has 3 rows in 'steps.h5', where 'episode.json' says " +
                                std::to_string(rows) + "; `robocell verify ";
    ExpectThrow<IoError>([&] { ReplayActions(env, edited); }, problem);
    ExpectThrow<IoError>([&] { VerifyReplay(edited); }, problem);
  }
  for (const auto& rows : {nlohmann::ordered_json(-1), nlohmann::ordered_json(5e81),
                           nlohmann::ordered_json("three")}) {
    ExpectThrow<IoError>(
        [&] { Edited(episode, [&](auto& json) { json["tables"]["steps"]["rows"] = rows; }); },
        "it does not describe an episode");
  }
}

TEST_F(EnvOfEpisodeTest, NamesColumnsOfAnotherLength) {
  const Episode episode = Record(Rc7WithCube());
  Env env(Rc7WithCube());
  for (const char* column : {"reward", "time", "observation/robot/joints", "action/robot/tquat"}) {
    ExpectThrow<IoError>([&] { ReplayActions(env, WithShortColumn(episode, column)); },
                         "column '" + std::string(column) + "' has 2 rows in 'steps.h5'");
  }
  ExpectThrow<IoError>(
      [&] { ReplayActions(env, WithShortColumn(episode, std::string(kControlTickColumn))); },
      "column 'control_tick' has 2 rows");
}

TEST_F(EnvOfEpisodeTest, RejectsAnEpisodeWithoutRows) {
  const Episode episode = Record(Rc7WithCube());
  Env env(Rc7WithCube());
  const Episode empty = WithRows(
      episode, 0, [](const ColumnInfo& info) { return info.table == "steps" ? 0 : info.rows; });
  ExpectThrow<IoError>([&] { ReplayActions(env, empty); },
                       "has no row: there is nothing to repeat");
}

TEST_F(EnvOfEpisodeTest, NamesAnInvalidField) {
  const Episode episode = Record(Rc7WithCube());
  Env env(Rc7WithCube());
  const auto edited = [&](const char* pointer, const nlohmann::ordered_json& value) {
    return Edited(episode, [&](nlohmann::ordered_json& json) {
      json[nlohmann::ordered_json::json_pointer(pointer)] = value;
    });
  };
  ExpectThrow<IoError>([&] { EnvOfEpisode(edited("/metadata/environment/config", 7)); },
                       "episode.json': 'metadata.environment.config' is 7, not a text; the "
                       "episode was edited or comes from another program");
  ExpectThrow<IoError>([&] { EnvOfEpisode(edited("/metadata/environment/config", "robots: 3")); },
                       "'metadata.environment.config' is \"robots: 3\", not what robocell writes");
  ExpectThrow<IoError>([&] { EnvOfEpisode(edited("/metadata/scene_spec", false)); },
                       "'metadata.scene_spec' is false, not a text");
  ExpectThrow<IoError>([&] { EnvOfEpisode(edited("/metadata/environment/saved_scene", "no")); },
                       "'metadata.environment.saved_scene' is \"no\", not true or false");
  ExpectThrow<IoError>([&] { ReplayActions(env, edited("/metadata/environment/code", 1)); },
                       "'metadata.environment.code' is 1, not a list");
  ExpectThrow<IoError>(
      [&] {
        ReplayActions(env, edited("/metadata/environment/code", {{{"file", "a.py"}}}));
      },
      "'metadata.environment.code[0]' has no field 'sha256'");
  ExpectThrow<IoError>([&] { VerifyReplay(edited("/metadata/environment/variations", 2)); },
                       "'metadata.environment.variations' is 2, not a text");
  ExpectThrow<IoError>([&] { VerifyReplay(edited("/versions/mujoco", 4)); },
                       "'versions.mujoco' is 4, not a text");
  for (const nlohmann::ordered_json& rate :
       {nlohmann::ordered_json(0), nlohmann::ordered_json("2")})
    ExpectThrow<IoError>(
        [&] { VerifyReplay(edited("/metadata/rates/sim_ms", rate)); },
        "'metadata.rates.sim_ms' is " + rate.dump() + ", not a number of milliseconds above 0");
  const std::string final = "/results/final_observation";
  ExpectThrow<IoError>([&] { ReplayActions(env, edited(final.c_str(), 1)); },
                       "'results.final_observation' is 1, not an object");
  const std::string joints = final + "/observation~1robot~1joints";
  ExpectThrow<IoError>(
      [&] {
        ReplayActions(env, edited(joints.c_str(), {1, 2}));
      },
      "'results.final_observation.observation/robot/joints' is [1,2], not a list "
      "of 7 numbers");
  ExpectThrow<IoError>(
      [&] {
        ReplayActions(env, edited(joints.c_str(), {1, "b"}));
      },
      "is [1,\"b\"], not a list of numbers");
}

TEST_F(EnvOfEpisodeTest, RequiresTheFileOfASavedScene) {
  EnvConfig config = Rc7WithCube();
  Env(config).scene().SaveXml(folder / "cell.xml");
  config.saved_scene = (folder / "cell.xml").string();
  TempDir other;
  Env env(config);
  EnvRecorder recorder(env, other.path());
  env.Reset({.seed = 5});
  StepTo(env, {0.45, 0, 0.3}, 1);
  recorder.Close();
  const Episode episode = Dataset(other.path()).At(0);
  Env again(config);
  EXPECT_TRUE(ReplayActions(again, episode).ok());
  ExpectThrow<ArgumentError>([&] { EnvOfEpisode(episode); },
                             "its scene was a saved file (saved_scene), which the dataset does not "
                             "keep; replay it in an environment of that file");
  ExpectThrow<ArgumentError>([&] { VerifyReplay(episode); }, "its scene was a saved file");
}

TEST_F(EnvOfEpisodeTest, RecordsPortableModelNames) {
  const Episode episode = Record(Rc7WithCube());
  const std::string config = nlohmann::json::parse(episode.metadata_json())
                                 .at("environment")
                                 .at("config")
                                 .get<std::string>();
  EXPECT_THAT(config, ::testing::HasSubstr("model: rc7"));
  EXPECT_THAT(config, ::testing::Not(::testing::HasSubstr(".xml")));
}

}  // namespace
}  // namespace robocell
