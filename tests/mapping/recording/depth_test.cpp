// Depth images that NumPy and OpenCV wrote (tests/data/fuzz/make_depth.py), whole, damaged and lying.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "mapping/recording/convert.h"
#include "mapping/recording/depth_image.h"
#include "mapping/recording/recording.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

const fs::path kDepthFiles = fs::path(LOCI_SOURCE_DIR) / "tests/data/fuzz/depth";
constexpr int kColumns = 8, kRows = 6;

std::vector<fs::path> files_named(const std::string& begin) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(kDepthFiles))
    if (entry.path().filename().string().starts_with(begin)) files.push_back(entry.path());
  return files;
}

/// What the files show at a pixel, in metres; the first four have none.
float metres_at(int v, int u) {
  return 1 + 0.01F * static_cast<float>(kColumns * v + u);
}

std::string refusal(const fs::path& path, bool header_too = true) {
  std::string text = "no error";
  try {
    read_depth_image(path);
  } catch (const Error& error) {
    text = error.what();
  }
  EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  if (header_too) {
    EXPECT_THROW(read_depth_header(path), Error) << path << ": " << text;
  }
  return text;
}

class Depth : public testing::Test {
 protected:
  Depth() {
    fs::remove_all(root_);
    make_folder(root_);
  }
  ~Depth() override { fs::remove_all(root_); }

  fs::path write(const std::string& name, const std::string& bytes) const {
    make_folder((root_ / name).parent_path());
    write_file_atomically(root_ / name, bytes);
    return root_ / name;
  }
  void copy(const std::string& source, const std::string& name) const {
    make_folder((root_ / name).parent_path());
    fs::copy_file(kDepthFiles / source, root_ / name, fs::copy_options::overwrite_existing);
  }
  void write_color(const std::string& name) const {
    make_folder((root_ / name).parent_path());
    write_image(root_ / name, cv::Mat(kRows, kColumns, CV_8UC3, cv::Scalar(10, 20, 30)));
  }
  static std::unique_ptr<Recording> open(const fs::path& path) {
    RecordingOptions options;
    options.up = "keep";
    return open_recording(path, options);
  }
  /// The first frame has the depth that the files show.
  static void expect_depth(const Recording& recording, const std::string& what, float tolerance = 1e-6F) {
    const RgbdFrame frame = recording.frame(0);
    ASSERT_EQ(frame.damage, "") << what;
    for (int v = 0; v < kRows; ++v)
      for (int u = 0; u < kColumns; ++u) {
        const float z = frame.depth.at<float>(v, u);
        if (v == 0 && u < 4) {
          EXPECT_TRUE(std::isnan(z)) << what << " " << u << ": " << z;
        } else {
          EXPECT_NEAR(z, metres_at(v, u), tolerance) << what << " " << v << " " << u;
        }
      }
  }

  fs::path root_ = fs::path(testing::TempDir()) /
                   (std::string("depth_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(Depth, OfEachKindIsReadAsNumpyAndOpenCvWroteIt) {
  const std::vector<fs::path> files = files_named("seed");
  EXPECT_EQ(files.size(), 11U);
  for (const fs::path& file : files) {
    const std::string name = file.filename().string();
    const bool is_float = name.find("u2") == name.npos && name.find("deflate") == name.npos;
    const DepthHeader header = read_depth_header(file);
    EXPECT_EQ(header.width, kColumns) << name;
    EXPECT_EQ(header.height, kRows) << name;
    EXPECT_EQ(header.is_float, is_float) << name;
    const cv::Mat image = read_depth_image(file);
    ASSERT_EQ(image.type(), is_float ? CV_32FC1 : CV_16UC1) << name;
    const float tolerance = name.find("f2") != name.npos || name.find("half") != name.npos ? 1e-3F : 1e-6F;
    for (int p = 4; p < kColumns * kRows; ++p) {
      const int v = p / kColumns, u = p % kColumns;
      if (is_float) {
        EXPECT_NEAR(image.at<float>(v, u), metres_at(v, u), tolerance) << name;
      } else {
        EXPECT_EQ(image.at<uint16_t>(v, u), std::lround(1000 * metres_at(v, u))) << name;
      }
    }
  }
}

TEST_F(Depth, OfOtherKindsIsRefusedWithWhatToWrite) {
  const std::vector<std::pair<const char*, const char*>> table = {
      {"bad_fortran.npy", "Fortran order is not read; write depth in metres"},
      {"bad_big_endian.npy", "type '>f4' is not read"},
      {"bad_int32.npy", "type '<i4' is not read"},
      {"bad_objects.npy", "type '|O' is not read"},
      {"bad_fields.npy", "type 'of several fields' is not read"},
      {"bad_rgb.npy", "shape (6, 8, 3) is no depth image"},
      {"bad_row.npy", "shape (48) is no depth image"},
      {"bad_8_bit.tiff", "1 channels of 8 bits (unsigned) is not read"},
      {"bad_color.tiff", "3 channels of 16 bits"},
      {"bad_color.exr", "which of the 3 channels"}};
  EXPECT_EQ(table.size(), files_named("bad").size());
  for (const auto& [name, text] : table) EXPECT_THAT(refusal(kDepthFiles / name), HasSubstr(text));
}

TEST_F(Depth, TruncatedAnywhereIsRefused) {
  for (const fs::path& file : files_named("seed")) {
    const std::string bytes = read_file(file);
    // The last bytes of a TIFF say that no other image follows; a line of an OpenEXR image is known to be cut
    // when it is decoded.
    for (size_t size = 1; size + 8 < bytes.size(); size += 7)
      EXPECT_NE(refusal(write("cut" + file.extension().string(), bytes.substr(0, size)),
                        file.extension() != ".exr"),
                "no error")
          << file << " at " << size;
  }
}

TEST_F(Depth, LiesAboutSizesCostNothing) {
  const auto changed = [&](const std::string& name, const std::string& what, const std::string& by) {
    std::string bytes = read_file(kDepthFiles / name);
    const size_t at = bytes.find(what);
    EXPECT_NE(at, std::string::npos) << name;
    bytes.replace(at, what.size(), by);
    return write(name, bytes);
  };
  const std::string blanks(30, ' ');
  const auto shape = [&](const std::string& text) {
    return changed("seed_f4.npy", "(6, 8), }" + blanks, (text + ", }" + blanks + blanks).substr(0, 39));
  };
  EXPECT_THAT(refusal(shape("(60000, 80000)")), HasSubstr("80000 x 60000 pixels is not read"));
  EXPECT_THAT(refusal(shape("(4294967296, 4294967296)")), HasSubstr("pixels is not read"));
  EXPECT_THAT(refusal(shape("(99999999999999999999, 1)")), HasSubstr("head of this NumPy array is damaged"));
  EXPECT_THAT(refusal(shape("(-6, 8)")), HasSubstr("head of this NumPy array is damaged"));
  EXPECT_THAT(refusal(shape("(0, 8)")), HasSubstr("8 x 0 pixels is not read"));
  EXPECT_THAT(refusal(shape("()")), HasSubstr("shape () is no depth image"));
  EXPECT_THAT(refusal(shape("(6, 7)")), HasSubstr("more data than"));
  EXPECT_THAT(refusal(shape("(6, 9)")), HasSubstr("truncated"));
  EXPECT_THAT(refusal(changed("seed_f4.npy", std::string("\x76\0", 2), "\xff\xff")), HasSubstr("too long"));
  EXPECT_THAT(refusal(changed("seed_f4.npy", "False", "Maybe")), HasSubstr("damaged"));
  // The width (tag 256) of a TIFF, a short that becomes a long.
  std::string tiff = read_file(kDepthFiles / "seed_plain.tif");
  const size_t width = tiff.find(std::string("\0\1\3\0\1\0\0\0", 8));
  ASSERT_NE(width, std::string::npos);
  tiff[width + 2] = 4;
  std::memcpy(tiff.data() + width + 8, "\xff\xff\xff\x7f", 4);
  EXPECT_THAT(refusal(write("a.tif", tiff)), HasSubstr("2147483647 x 6 pixels is not read"));
  // The data window of an OpenEXR image.
  std::string exr = read_file(kDepthFiles / "seed_f4.exr");
  for (const char* name : {"dataWindow", "displayWindow"}) {
    const size_t at = exr.find(name) + std::strlen(name) + 1 + 6 + 4 + 8;
    std::memcpy(exr.data() + at, "\x00\x00\xff\x3f\x00\x00\xff\x3f", 8);
  }
  EXPECT_NE(refusal(write("a.exr", exr)), "no error");
}

TEST_F(Depth, FlippedBytesNeverDoMoreThanSpoilTheImage) {
  for (const fs::path& file : files_named("seed")) {
    const std::string bytes = read_file(file);
    for (size_t at = 0; at < bytes.size(); ++at)
      for (const int flip : {0x01, 0xff}) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ flip);
        const fs::path target = root_ / ("flipped" + file.extension().string());
        std::ofstream(target, std::ios::binary) << changed;
        refusal(target, false);
      }
  }
}

// Layouts
// -------------------------------------------------------------------------------------------------------

TEST_F(Depth, OfEachKindIsReadInEachLayout) {
  const std::string camera = "depth: {width: 8, height: 6, fx: 8, fy: 8, cx: 3.5, cy: 2.5}\n";
  write("cameras.yaml", camera);
  for (const fs::path& file : files_named("seed")) {
    const std::string source = file.filename().string(), ending = file.extension().string();
    const float tolerance =
        source.find("f2") != source.npos || source.find("half") != source.npos ? 1e-3F : 1e-6F;
    const auto expect = [&](const char* format) {
      const auto recording = open(root_ / "rec");
      EXPECT_EQ(recording->info().format, format) << source;
      expect_depth(*recording, format + (" " + source), tolerance);
      fs::remove_all(root_ / "rec");
    };
    copy(source, "rec/000012.depth" + ending);
    write_color("rec/000012.color.png");
    expect("7-scenes");

    copy(source, "rec/depth/1.5" + ending);
    write("rec/depth.txt", "1.5 depth/1.5" + ending + "\n");
    write("rec/rgb.txt", "");
    write("rec/cameras.yaml",
          "depth: {width: 8, height: 6, fx: 8, fy: 8, cx: 3.5, cy: 2.5, unit_m: 0.001}\n");
    expect("tum");

    copy(source, "rec/depth/000001" + ending);
    write_color("rec/color/000001.png");
    expect("redwood");

    copy(source, "rec/results/depth000001" + ending);
    write_color("rec/results/frame000001.png");
    write("rec/traj.txt", "1 0 0 3 0 1 0 0 0 0 1 0 0 0 0 1\n");
    write("rec/cam_params.json",
          R"({"camera": {"w": 8, "h": 6, "fx": 8, "fy": 8, "cx": 3, "cy": 2, "scale": 1000}})");
    expect("replica");

    copy(source, "rec/images/a" + ending);
    write("rec/recording.yaml", "cameras: {" + camera.substr(0, camera.size() - 1) + "}\n");
    write("rec/frames.csv", "index,time_ns,color,depth\n0,5,,images/a" + ending + "\n");
    expect("loci");
  }
}

TEST_F(Depth, OfNerfstudioIsScaledWhateverItsKind) {
  write_color("images/1.png");
  const auto open_with = [&](const std::string& file, const std::string& scale) {
    copy(file, "depth/" + file);
    write("transforms.json", R"({"fl_x": 8, "fl_y": 8, "cx": 4, "cy": 3, "w": 8, "h": 6, )" + scale +
                                 R"("frames": [{"file_path": "images/1.png", "depth_file_path": "depth/)" +
                                 file +
                                 R"(", "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]}]})");
    return open(root_);
  };
  expect_depth(*open_with("seed_u2.tiff", ""), "u2.tiff");
  expect_depth(*open_with("seed_f4.npy", R"("depth_unit_scale_factor": 1.0, )"), "f4.npy");
  EXPECT_NEAR(open_with("seed_f4.npy", "")->frame(0).depth.at<float>(5, 7), 0.001F * metres_at(5, 7), 1e-8F);
}

TEST_F(Depth, OfOldVersionsOfStrayScannerIsRead) {
  copy("seed_u2.npy", "depth/000000.npy");
  write("camera_matrix.csv", "1600.0,0.0,960.0\n0.0,1600.0,720.0\n0.0,0.0,1.0\n");
  write("odometry.csv",
        "timestamp, frame, x, y, z, qx, qy, qz, qw\n 75.5, 000000, 0.1, 1.4, 0.3, 0, 0, 0, 1\n");
  expect_depth(*open(root_), "stray");
}

TEST_F(Depth, UnitsOfFloatsCanBeGiven) {
  copy("seed_f4.exr", "depth/1.exr");
  write_color("color/1.png");
  const auto open_with = [&](const std::string& unit) {
    write("cameras.yaml", "depth: {width: 8, height: 6, fx: 8, fy: 8, cx: 3.5, cy: 2.5" + unit + "}\n");
    return open(root_);
  };
  EXPECT_THAT(open_with("")->info().guesses, Contains("floating-point depth is taken as metres"));
  const auto half = open_with(", float_unit_m: 0.5");
  EXPECT_THAT(half->info().guesses, Contains("floating-point depth is taken in units of 0.5 m"));
  EXPECT_NEAR(half->frame(0).depth.at<float>(5, 7), metres_at(5, 7) / 2, 1e-6F);
  EXPECT_THROW(open_with(", float_unit_m: 0"), Error);
  EXPECT_THROW(open_with(", float_unit_m: 1000"), Error);
}

TEST_F(Depth, OfSeveralKindsTheOneThatMatchesColourIsTaken) {
  write("cameras.yaml", "depth: {width: 8, height: 6, fx: 8, fy: 8, cx: 3.5, cy: 2.5}\n");
  for (const char* number : {"1", "2"}) {
    copy("seed_f4.npy", std::string("depth/") + number + ".npy");
    write_color(std::string("depth/") + number + ".png");  // a drawing of it
    write_color(std::string("color/") + number + ".png");
  }
  expect_depth(*open(root_), "npy beside png");
  fs::remove(root_ / "depth/2.npy");
  try {
    open(root_);  // There are two PNG for two colour images, and one array.
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("16-bit grey PNG"));
  }
}

TEST_F(Depth, ADamagedImageCostsItsFrameOnly) {
  write("cameras.yaml", "depth: {width: 8, height: 6, fx: 8, fy: 8, cx: 3.5, cy: 2.5}\n");
  for (const char* number : {"1", "2", "3"}) {
    copy("seed_f4.tiff", std::string("depth/") + number + ".tiff");
    write_color(std::string("color/") + number + ".png");
  }
  write("depth/2.tiff", read_file(kDepthFiles / "seed_f4.tiff").substr(0, 100));
  const auto recording = open(root_);
  EXPECT_THAT(recording->info().problems,
              Contains(HasSubstr("1 of 3 frames have images that cannot be read")));
  EXPECT_THAT(recording->frame(1).damage, HasSubstr("2.tiff"));
  EXPECT_FALSE(has_depth(recording->frame(1)));
  expect_depth(*recording, "the first");
}

TEST_F(Depth, FloatsAreConvertedToMillimetres) {
  write("cameras.yaml", "depth: {width: 8, height: 6, fx: 8, fy: 8, cx: 3.5, cy: 2.5}\n");
  copy("seed_f4.npy", "rec/depth/1.npy");
  write_color("rec/color/1.png");
  NoProgress progress;
  convert_recording(*open(root_ / "rec"), root_ / "out", {.format = RecordingFormat::loci, .inputs = {}},
                    progress);
  expect_depth(*open(root_ / "out"), "converted", 5e-4F);
}

}  // namespace
}  // namespace loci::mapping
