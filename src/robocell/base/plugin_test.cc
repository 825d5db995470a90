#include "robocell/base/plugin.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include "robocell/base/error.h"
#include "robocell/base/files.h"
#include "robocell/testing/expect_throw.h"
#include "robocell/testing/temp_dir.h"

namespace robocell {
namespace {

// tests/integration/test_plugin.py tests the effects of a plugin with one that is built.
TEST(Plugin, NamesAMissingFile) {
  ExpectThrow<IoError>([] { LoadPlugin("no_such_plugin.so"); },
                       "cannot load plugin 'no_such_plugin.so': No such file");
}

TEST(Plugin, NamesAFileThatIsNotALibrary) {
  const TempDir folder;
  AtomicWrite(folder / "text.so", "not a library");
  ExpectThrow<IoError>([&] { LoadPlugin((folder / "text.so").string()); }, "text.so");
}

TEST(Plugin, RejectsALibraryThatRegistersNothing) {
  Dl_info own;
  ASSERT_NE(dladdr(reinterpret_cast<const void*>(&LoadPlugin), &own), 0);
  ExpectThrow<ArgumentError>(
      [&] { LoadPlugin(own.dli_fname); },
      "is not a plugin: none of its source files contains ROBOCELL_PLUGIN(function)");
}

TEST(Plugin, ObjectsOfTheProgramBelongToNoPlugin) {
  const Error error("of this program");
  EXPECT_EQ(PluginOf(error), "");
}

}  // namespace
}  // namespace robocell
