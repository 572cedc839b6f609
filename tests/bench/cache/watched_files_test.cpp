// Files that change while they are used.
#include "bench/cache/watched_files.h"

#include <gtest/gtest.h>

#include <fstream>

#include "base/user_error.h"
#include "tests/support/folder_test.h"

namespace wobblebench::bench {
namespace {

class Watched : public testing_support::FolderTest {
 protected:
  std::filesystem::path put(const std::string& name, const std::string& text) const {
    std::ofstream(file(name)) << text;
    return file(name);
  }
};

TEST_F(Watched, AreTheSameWhileTheirBytesAre) {
  const auto mesh = put("a.obj", "v 1 2 3"), points = put("b.csv", "x_mm");
  WatchedFiles files({mesh, points});
  EXPECT_FALSE(files.changed());
  put("a.obj", "v 1 2 3");
  EXPECT_FALSE(files.changed()) << "written anew with the same bytes";
  put("c.obj", "v 1 2 3");
  std::filesystem::rename(file("c.obj"), mesh);
  EXPECT_FALSE(files.changed()) << "replaced by an equal file";
}

TEST_F(Watched, AreRefusedWhereOneChangesOrIsGone) {
  const auto mesh = put("a.obj", "v 1 2 3"), points = put("b.csv", "x_mm");
  WatchedFiles changed({mesh, points}), gone({mesh, points});
  put("b.csv", "y_mm");
  EXPECT_TRUE(changed.changed());
  EXPECT_THROW(changed.refuse_changed("accuracy"), UserError);
  std::filesystem::remove(mesh);
  EXPECT_TRUE(gone.changed());
}

TEST_F(Watched, AreTheFilesOfAPhantom) {
  Scene scene;
  EXPECT_TRUE(phantom_files(scene).empty());
  scene.phantom.file = put("a.obj", "v 1 2 3");
  scene.phantom.scatterers = put("b.csv", "x_mm");
  EXPECT_EQ(phantom_files(scene),
            (std::vector<std::filesystem::path>{file("a.obj"), file("b.csv")}));
}

}  // namespace
}  // namespace wobblebench::bench
