#include "robocell/data/model_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>
#include <thread>
#include <vector>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/data/leftovers.h"
#include "robocell/data/verify.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell::internal {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

class ModelStoreTest : public ::testing::Test {
 protected:
  ModelStoreTest() {
    fs::create_directories(temp / "arm/assets");
    fs::create_directories(dataset);
    AtomicWrite(temp / "arm/arm.xml", "model");
    AtomicWrite(temp / "arm/assets/a.stl", "mesh");
    arm = MakeFileSet(temp / "arm/arm.xml", {temp / "arm/arm.xml", temp / "arm/assets/a.stl"});
  }
  TempDir temp;
  fs::path dataset = temp / "out";
  FileSet arm;

  std::map<std::string, std::string> Damage() const {
    return DamageOfStoredModel(dataset, StoredModelPath(arm));
  }
};

TEST_F(ModelStoreTest, KeepsAModelOnceWithItsFiles) {
  for (int i = 0; i < 2; ++i) StoreModel(dataset, arm);
  const std::string folder = "models/arm-" + arm.hash.substr(0, 16);
  EXPECT_EQ(StoredModelPath(arm), folder + "/arm.xml");
  EXPECT_THAT(StoredModels(dataset), ElementsAre(folder));
  EXPECT_EQ(ReadFile(dataset / folder / "assets/a.stl"), "mesh");
  EXPECT_THAT(Damage(), IsEmpty());
  EXPECT_TRUE(Verify(dataset).ok());
}

TEST_F(ModelStoreTest, ListsChangedRemovedAndAddedFiles) {
  StoreModel(dataset, arm);
  const fs::path folder = dataset / StoredModels(dataset)[0];
  const fs::path mesh = folder / "assets/a.stl", sums = folder / "SHA256SUMS";
  AtomicWrite(folder / "more", "");
  EXPECT_THAT(Damage(), ElementsAre(Pair("more", "it does not belong to the model")));
  fs::remove(folder / "more");
  EXPECT_THAT(Damage(), IsEmpty());
  AtomicWrite(mesh, "hsem");
  EXPECT_THAT(Damage(), ElementsAre(Pair("assets/a.stl", HasSubstr("its hash does not match"))));
  fs::remove(mesh);
  EXPECT_THAT(Damage(), ElementsAre(Pair("assets/a.stl", "it is missing")));
  AtomicWrite(mesh, "mesh");
  AtomicWrite(sums, "");
  EXPECT_THAT(Damage(), IsEmpty()) << "the folder's name says that the files are right";
  AtomicWrite(mesh, "hsem");
  EXPECT_THAT(Damage(), ElementsAre(Pair("", "its files differ from the stored ones")));
  fs::remove_all(folder);
  EXPECT_THROW(Damage(), IoError);
}

TEST_F(ModelStoreTest, ReportsAndRestoresAMissingOrDamagedList) {
  StoreModel(dataset, arm);
  const std::string name = StoredModels(dataset)[0];
  const fs::path sums = dataset / name / "SHA256SUMS";
  const std::string listed = ReadFile(sums);
  for (const bool missing : {true, false}) {
    if (missing)
      fs::remove(sums);
    else
      AtomicWrite(sums, listed + "x");
    const VerifyResult result = Verify(dataset);
    EXPECT_FALSE(result.ok());
    EXPECT_THAT(result.Text(),
                HasSubstr(name + "/SHA256SUMS: it is missing or damaged; the model's files are "
                                 "intact, and `robocell verify --repair` lists them again"));
    const RepairResult repaired = Repair(dataset);
    EXPECT_EQ(repaired.moved,
              missing ? std::vector<std::string>() : std::vector{sums.filename().string()});
    EXPECT_THAT(repaired.remaining, IsEmpty());
    EXPECT_EQ(ReadFile(sums), listed);
    EXPECT_TRUE(Verify(dataset).ok());
  }
  EXPECT_EQ(ReadFile(dataset / ".quarantine" / "SHA256SUMS"), listed + "x");
}

// A repair was killed while it wrote the list.
TEST_F(ModelStoreTest, IgnoresAnUnfinishedList) {
  StoreModel(dataset, arm);
  const std::string name = StoredModels(dataset)[0], left = name + "/.SHA256SUMS.7.1.partial";
  fs::rename(dataset / name / "SHA256SUMS", dataset / left);
  EXPECT_THAT(Damage(), IsEmpty());
  EXPECT_THAT(Verify(dataset).leftovers, ElementsAre(left));
  EXPECT_THAT(Repair(dataset).moved, ElementsAre(".SHA256SUMS.7.1.partial"));
  EXPECT_TRUE(Verify(dataset).ok());
}

TEST_F(ModelStoreTest, ReadsModelsWithoutAList) {
  StoreModel(dataset, arm);
  const fs::path folder = dataset / StoredModels(dataset)[0];
  fs::remove(folder / "SHA256SUMS");
  EXPECT_THAT(Damage(), IsEmpty());
  AtomicWrite(folder / "assets/a.stl", "hsem");
  EXPECT_THAT(Damage(), ElementsAre(Pair("", "its files differ from the stored ones")));
}

TEST_F(ModelStoreTest, LeavesNothingIfAFileIsUnreadable) {
  fs::remove(temp / "arm/assets/a.stl");
  EXPECT_THROW(StoreModel(dataset, arm), IoError);
  EXPECT_TRUE(fs::is_empty(dataset / "models"));
}

TEST_F(ModelStoreTest, RejectsAFileThatChangesMeanwhile) {
  AtomicWrite(temp / "arm/arm.xml", "other");
  EXPECT_THROW(StoreModel(dataset, arm), IoError);
  EXPECT_THAT(StoredModels(dataset), IsEmpty());
}

TEST_F(ModelStoreTest, SupportsConcurrentStores) {
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) threads.emplace_back([&] { StoreModel(dataset, arm); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(StoredModels(dataset).size(), 1u);
  EXPECT_THAT(Damage(), IsEmpty());
  EXPECT_EQ(std::distance(fs::directory_iterator(dataset / "models"), {}), 1);
}

TEST_F(ModelStoreTest, AFileNamedLikeAModelIsForeign) {
  StoreModel(dataset, arm);
  const std::string stored = StoredModels(dataset)[0];
  const std::string file = "models/foo-0123456789abcdef", link = "models/goo-0123456789abcdef";
  AtomicWrite(dataset / file, "");
  fs::create_symlink("/nowhere", dataset / link);
  AtomicWrite(dataset / "models/notes.txt", "");
  EXPECT_THAT(StoredModels(dataset), ElementsAre(stored));
  EXPECT_THAT(UnfinishedIn(dataset), IsEmpty());
  const VerifyResult result = Verify(dataset);
  EXPECT_THAT(result.foreign, ElementsAre(file, link));
  EXPECT_THAT(result.others, ElementsAre("models/notes.txt"));
  EXPECT_THAT(result.Text(),
              HasSubstr(file + ": it has the name of a model and is a file\n" + link +
                        ": it has the name of a model and is a link to '/nowhere'"));
  EXPECT_THAT(Repair(dataset).moved, ElementsAre("foo-0123456789abcdef", "goo-0123456789abcdef"));
  EXPECT_TRUE(Verify(dataset).ok());
}

TEST_F(ModelStoreTest, RejectsAFileAtTheTargetPath) {
  fs::create_directory(dataset / "models");
  const std::string folder = StoredModelFolder(StoredModelPath(arm));
  AtomicWrite(dataset / folder, "");
  EXPECT_FALSE(IsStored(dataset, folder));
  ExpectThrow<IoError>([&] { StoreModel(dataset, arm); }, (dataset / folder).string());
  fs::remove(dataset / folder);
  StoreModel(dataset, arm);
  EXPECT_TRUE(IsStored(dataset, StoredModelPath(arm)));
}

TEST_F(ModelStoreTest, RejectsPathsOutsideTheStore) {
  EXPECT_TRUE(IsStoredModelPath("models/rc7-0123456789abcdef/rc7.xml"));
  for (const char* path :
       {"", "models", "models/rc7-0123456789abcdef", "other/rc7-0123456789abcdef/rc7.xml",
        "/models/rc7-0123456789abcdef/rc7.xml", "models/rc7/rc7.xml",
        "models/rc7-0123456789abcdef/../../../etc/passwd"}) {
    EXPECT_FALSE(IsStoredModelPath(path)) << path;
  }
}

TEST_F(ModelStoreTest, RejectsLinkedFoldersAndAcceptsLinkedFiles) {
  fs::create_directory(temp / "elsewhere");
  fs::create_directory_symlink(temp / "elsewhere", dataset / "models");
  EXPECT_THROW(StoreModel(dataset, arm), IoError);
  EXPECT_TRUE(fs::is_empty(temp / "elsewhere"));
  fs::remove(dataset / "models");
  StoreModel(dataset, arm);
  const fs::path mesh = dataset / StoredModels(dataset)[0] / "assets/a.stl";
  fs::remove(mesh);
  fs::create_symlink(temp / "arm/assets/a.stl", mesh);
  EXPECT_THAT(Damage(), IsEmpty());
  fs::remove(mesh);
  fs::create_symlink("/dev/zero", mesh);
  EXPECT_THROW(Damage(), IoError);
  EXPECT_THAT(Verify(dataset).Text(), HasSubstr("a.stl': it is a link to '/dev/zero'"));
}

}  // namespace
}  // namespace robocell::internal
