#include "mapping/exchange/model_view.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "mapping/base/files.h"
#include "mapping/exchange/formats/gltf.h"
#include "mapping/exchange/map_colors.h"
#include "mapping/image/image_io.h"
#include "tests/mapping/exchange/photographed_map.h"

namespace loci::mapping::test {
namespace {

namespace fs = std::filesystem;

/// Pixels of a hue (strong channels high, the others low) and the middle of them.
struct Patch {
  int pixels = 0;
  cv::Point2d middle;
};

Patch patch_of(const cv::Mat& image, bool blue, bool green, bool red) {
  const auto bound = [&](int off, int on) {
    return cv::Scalar(blue ? on : off, green ? on : off, red ? on : off);
  };
  cv::Mat mask;
  cv::inRange(image, bound(0, 120), bound(70, 255), mask);
  const cv::Moments moments = cv::moments(mask, true);
  return {static_cast<int>(moments.m00), {moments.m10 / moments.m00, moments.m01 / moments.m00}};
}

/// The 3-D view of the photographed map in a headless browser, with its joints open to a share.
class ModelView : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v chromium >/dev/null") != 0) GTEST_SKIP() << "needs chromium";
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "textures");
    const cv::Mat cleared = screenshot(
        "<canvas width=100 height=100></canvas><script>"
        "const gl = document.querySelector('canvas').getContext('webgl2');"
        "gl.clearColor(1, 0, 0, 1); gl.clear(gl.COLOR_BUFFER_BIT)</script>");
    if (cleared.empty() || patch_of(cleared, false, false, true).pixels != 100 * 100)
      GTEST_SKIP() << "needs a chromium that draws WebGL 2";
    InterpretedMap map = photographed_map();
    for (const auto& [name, bytes] : add_textures(map)) write_file_atomically(folder_ / name, bytes);
    Warnings warnings;
    page_ = model_section(glb_bytes(map.world, {{}, folder_}, warnings));
    ASSERT_TRUE(warnings.empty()) << warnings.texts().front();
  }

  cv::Mat drawn(const std::string& open) {
    const std::string closed = "step=\"0.01\" value=\"0\"";
    std::string page = page_;
    page.replace(page.find(closed), closed.size(), "step=\"0.01\" value=\"" + open + "\"");
    return screenshot("<style>body { margin: 0 } h2, p { display: none }</style>" + page);
  }

  /// Empty where the browser fails.
  cv::Mat screenshot(const std::string& page) {
    const fs::path path = folder_ / "page.html", image = folder_ / "page.png";
    write_file_atomically(path, page);
    fs::remove(image);
    const std::string command =
        "timeout 120 chromium --headless --no-sandbox --disable-dev-shm-usage --use-angle=swiftshader"
        " --enable-unsafe-swiftshader --virtual-time-budget=20000 --window-size=1000,600"
        " --user-data-dir=" +
        (folder_ / "profile").string() + " --screenshot=" + image.string() + " file://" + path.string() +
        " >/dev/null 2>&1";
    return std::system(command.c_str()) == 0 && fs::exists(image) ? read_color(image) : cv::Mat();
  }

  fs::path folder_ = fs::path(testing::TempDir()) / "loci_model_view";
  std::string page_;
};

TEST_F(ModelView, ShowsTexturedFrontsThatOpen) {
  const cv::Mat closed = drawn("0"), open = drawn("1");
  ASSERT_FALSE(closed.empty());
  ASSERT_EQ(closed.size(), open.size());
  const Patch red = patch_of(closed, false, false, true), blue = patch_of(closed, true, false, false);
  const Patch drawer = patch_of(closed, false, true, true), pulled = patch_of(open, false, true, true);
  ASSERT_GT(std::min({red.pixels, blue.pixels, drawer.pixels, pulled.pixels}), 300);
  EXPECT_LT(red.middle.x, blue.middle.x);
  EXPECT_LT(drawer.middle.x, red.middle.x) << "the drawer is to the left of the door";
  EXPECT_GT(pulled.middle.y, drawer.middle.y + 5) << "it comes towards the viewer";
  EXPECT_LT(patch_of(open, false, false, true).pixels, red.pixels / 2) << "the door shows its back";
}

}  // namespace
}  // namespace loci::mapping::test
