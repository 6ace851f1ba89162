// loci-browse as a program: images with and without a screen, and what it says when it cannot.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <QImage>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>

#include "mapping/base/files.h"
#include "tests/gui/sample_memory.h"

namespace loci::gui {
namespace {

struct Ran {
  int code = 0;
  std::string error;
};

class BrowseProgram : public testing::Test {
 protected:
  BrowseProgram()
      : folder(std::filesystem::temp_directory_path() / ("loci_browse_" + std::to_string(getpid()))) {
    make_folder(folder);
    memory = test::write_sample_memory(folder / "sample.loci").path.string();
  }
  ~BrowseProgram() override { std::filesystem::remove_all(folder); }

  Ran run(const std::string& arguments,
          const std::string& environment = "env -u DISPLAY -u WAYLAND_DISPLAY") {
    const std::string stderr_file = (folder / "stderr").string();
    const int status = std::system((environment + " " + LOCI_BIN_DIR + "/loci-browse " + arguments + " 2> " +
                                    stderr_file + " > /dev/null")
                                       .c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(stderr_file)};
  }
  QImage written_image(const std::string& name) {
    return QImage(QString::fromStdString((folder / name).string()));
  }
  std::string out(const std::string& name) { return (folder / name).string(); }

  static size_t colors_in_the_middle(const QImage& image) {
    std::set<QRgb> colors;
    for (int y = image.height() / 4; y < image.height() / 2; ++y)
      for (int x = image.width() * 2 / 5; x < image.width() * 3 / 5; ++x) colors.insert(image.pixel(x, y));
    return colors.size();
  }

  std::filesystem::path folder;
  std::string memory;
};

TEST_F(BrowseProgram, DrawsTheImageWithoutAnyScreen) {
  const Ran ran = run(memory + " --screenshot " + out("a.png"));
  EXPECT_EQ(ran.code, 0) << ran.error;
  const QImage image = written_image("a.png");
  EXPECT_EQ(image.size(), QSize(1280, 800));
  EXPECT_GT(colors_in_the_middle(image), 100U);
}

TEST_F(BrowseProgram, DrawsTheImageUnderAnXServer) {
  const Ran ran = run(memory + " --screenshot " + out("a.png"), "env");
  EXPECT_EQ(ran.code, 0) << ran.error;
  EXPECT_GT(colors_in_the_middle(written_image("a.png")), 100U);
}

TEST_F(BrowseProgram, TimeAndSelectionChangeTheImage) {
  EXPECT_EQ(run(memory + " --screenshot " + out("a.png") + " --at 07:00").code, 0);
  EXPECT_EQ(run(memory + " --screenshot " + out("b.png") + " --at 07:00 --select object_2").code, 0);
  EXPECT_EQ(run(memory + " --screenshot " + out("c.png") + " --at 07:00 --size 1000x700").code, 0);
  EXPECT_NE(written_image("a.png"), written_image("b.png"));
  EXPECT_EQ(written_image("c.png").size(), QSize(1000, 700));
}

TEST_F(BrowseProgram, OnAScreenWithSmallPixelsEverythingHasTwiceAsMany) {
  EXPECT_EQ(run(memory + " --screenshot " + out("a.png"), "env -u DISPLAY QT_SCALE_FACTOR=2").code, 0);
  EXPECT_EQ(written_image("a.png").size(), QSize(2560, 1600));
}

TEST_F(BrowseProgram, TwoMapsAndActionsOfTheMenusAreInTheImageWhenWished) {
  EXPECT_EQ(run(memory + " --screenshot " + out("a.png")).code, 0);
  EXPECT_EQ(run(memory + " --screenshot " + out("b.png") + " --beside 07:00").code, 0);
  EXPECT_EQ(run(memory + " --screenshot " + out("c.png") + " --beside " + memory).code, 0);
  EXPECT_EQ(run(memory + " --screenshot " + out("d.png") + " --run 'Depth image'").code, 0);
  for (const char* name : {"b.png", "c.png", "d.png"}) {
    EXPECT_NE(written_image(name), written_image("a.png")) << name;
    EXPECT_EQ(written_image(name).size(), QSize(1280, 800)) << name;
  }
  EXPECT_EQ(run(memory + " --screenshot " + out("e.png") + " --run 'Make tea'").code, 1);
}

TEST_F(BrowseProgram, ViewpointsOfTheMenusAreInTheImage) {
  const std::string map = memory + " --select object_2 --view map --screenshot ";
  EXPECT_EQ(run(map + out("a.png")).code, 0);
  EXPECT_EQ(run(map + out("b.png") + " --run Overview").code, 0);
  EXPECT_EQ(written_image("b.png"), written_image("a.png")) << "it is where the map is looked at from first";
  for (const char* action : {"Top", "Front", "Left", "Frame"}) {
    EXPECT_EQ(run(map + out("b.png") + " --run " + action).code, 0);
    EXPECT_NE(written_image("b.png"), written_image("a.png")) << action;
  }
}

TEST_F(BrowseProgram, SizesThatDoNotGoAreRefused) {
  const auto refused = [&](const std::string& options) {
    const Ran ran = run(memory + " --screenshot " + out("a.png") + " " + options);
    EXPECT_EQ(ran.code, 1) << options;
    EXPECT_FALSE(std::filesystem::exists(out("a.png"))) << options;
    return ran.error;
  };
  EXPECT_NE(refused("--size 200x150").find("too small for the window"), std::string::npos);
  EXPECT_NE(refused("--size 30000x20000").find("too large"), std::string::npos);
  EXPECT_NE(refused("--beside none.loci").find("no such memory"), std::string::npos);
}

TEST_F(BrowseProgram, AnImageOfTheMapHasTheWishedSize) {
  for (const QSize& size : {QSize(1600, 1000), QSize(400, 300), QSize(200, 120)}) {
    const std::string wished = std::to_string(size.width()) + "x" + std::to_string(size.height());
    EXPECT_EQ(run(memory + " --view map --screenshot " + out("a.png") + " --size " + wished).code, 0);
    EXPECT_EQ(written_image("a.png").size(), size);
  }
}

TEST_F(BrowseProgram, SameMemorySameImage) {
  run(memory + " --screenshot " + out("a.png"));
  run(memory + " --screenshot " + out("b.png"));
  EXPECT_EQ(read_file(out("a.png")), read_file(out("b.png")));
}

TEST_F(BrowseProgram, SaysInOneLineWhyItCannot) {
  write_file_atomically(out("broken.loci"), "this is no memory");
  const std::string truncated = read_file(memory).substr(0, 5000);
  write_file_atomically(out("truncated.loci"), truncated);
  for (const std::string& arguments :
       {out("broken.loci"), out("truncated.loci"), out("missing.loci"), memory + " --select object_99",
        memory + " --at someday", memory + " --size huge"}) {
    const Ran ran = run(arguments + " --screenshot " + out("no.png"));
    EXPECT_EQ(ran.code, 1) << arguments;
    EXPECT_EQ(std::count(ran.error.begin(), ran.error.end(), '\n'), 1) << ran.error;
    EXPECT_FALSE(std::filesystem::exists(out("no.png"))) << arguments;
  }
}

TEST_F(BrowseProgram, WithoutAScreenTheWindowIsRefusedWithAHint) {
  const Ran ran = run(memory);
  EXPECT_EQ(ran.code, 1);
  EXPECT_NE(ran.error.find("--screenshot"), std::string::npos) << ran.error;
}

TEST_F(BrowseProgram, UsageErrorsExitTwo) {
  EXPECT_EQ(run("--no-such-option").code, 2);
}

}  // namespace
}  // namespace loci::gui
