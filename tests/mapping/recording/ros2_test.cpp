// Bags of ROS 2 that other programs wrote (../shared/data/ros2), whole, cut off and damaged.

#include <SQLiteCpp/SQLiteCpp.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <zstd.h>

#include <csignal>
#include <fstream>
#include <map>
#include <random>

#include "mapping/base/files.h"
#include "mapping/base/text/csv.h"
#include "mapping/recording/compression.h"
#include "mapping/recording/recording.h"
#include "mapping/recording/ros/bag.h"
#include "mapping/recording/ros/messages.h"
#include "mapping/recording/ros/packed_bag.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;

const fs::path kData = fs::path(LOCI_SHARED_DIR) / "data/ros2";

class Ros2 : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(kData)) GTEST_SKIP() << "no shared data";
    make_folder(root_);
  }
  ~Ros2() override { fs::remove_all(root_); }

  /// A copy of the MCAP that a test may damage.
  fs::path changed_copy(const std::function<void(std::string&)>& change) const {
    std::string bytes = read_file(kData / "redkitchen_ros2/redkitchen_ros2_0.mcap");
    change(bytes);
    write_file_atomically(root_ / "copy.mcap", bytes);
    return root_ / "copy.mcap";
  }

  fs::path root_ = fs::path(testing::TempDir()) /
                   (std::string("ros2_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

std::map<TimeNs, Isometry3d> true_poses() {
  const CsvTable table = CsvTable::read(kData / "poses.csv");
  std::map<TimeNs, Isometry3d> poses;
  for (size_t row = 0; row < table.rows(); ++row) {
    std::array<double, 7> values{};
    for (size_t i = 0; i < 7; ++i) values[i] = table.number(row, i + 1);
    poses[table.integer(row, 0)] = pose_from_values(values);
  }
  return poses;
}

void expect_true_poses(const Recording& recording) {
  const auto poses = true_poses();
  for (size_t i = 0; i < recording.size(); ++i) {
    const RgbdFrame frame = recording.frame(i);
    ASSERT_TRUE(poses.contains(frame.time_ns));
    ASSERT_TRUE(frame.map_from_camera);
    EXPECT_LT((frame.map_from_camera->matrix() - poses.at(frame.time_ns).matrix()).cwiseAbs().maxCoeff(),
              1e-6);
    EXPECT_FALSE(frame.color.empty());
    EXPECT_TRUE(frame.joints.contains("kitchen_drawer_1_joint"));
  }
}

TEST_F(Ros2, PosesOfMcapAndSqliteAreThoseOfTheSource) {
  const auto mcap = open_recording(kData / "redkitchen_ros2");
  EXPECT_EQ(mcap->info().format, "rosbag2");
  EXPECT_EQ(mcap->size(), 24U);
  EXPECT_EQ(mcap->info().map_frame, "map");
  EXPECT_THAT(mcap->info().guesses, Contains(HasSubstr("depth from /camera/depth/image_rect_raw")));
  EXPECT_THAT(mcap->info().guesses, Contains(HasSubstr("not read: depth from /camera/aligned_depth")));
  EXPECT_NEAR(mcap->info().camera.depth_from_color.translation().x(), 0.022, 1e-9);
  EXPECT_DOUBLE_EQ(mcap->info().camera.color.fx, 528);
  EXPECT_TRUE(mcap->info().problems.empty());
  expect_true_poses(*mcap);
  const auto sqlite = open_recording(kData / "redkitchen_ros2_db3");
  EXPECT_EQ(sqlite->size(), 6U);
  expect_true_poses(*sqlite);
}

TEST_F(Ros2, SingleFilesReadLikeTheirFolders) {
  EXPECT_EQ(open_recording(kData / "redkitchen_ros2/redkitchen_ros2_0.mcap")->size(), 24U);
  EXPECT_EQ(open_recording(kData / "redkitchen_ros2_db3/redkitchen_ros2_db3_0.db3")->size(), 6U);
}

TEST_F(Ros2, AFileOfTheCurrentFolderIsReadByItsName) {
  const fs::path before = fs::current_path();
  fs::current_path(kData / "redkitchen_ros2_db3");
  EXPECT_EQ(open_recording("redkitchen_ros2_db3_0.db3")->size(), 6U);
  fs::current_path(before);
}

TEST_F(Ros2, TopicsCanBeChosen) {
  RecordingOptions options;
  options.topics = "/camera/aligned_depth_to_color/image_raw,/camera/color/image_raw";
  const auto recording = open_recording(kData / "redkitchen_ros2", options);
  EXPECT_DOUBLE_EQ(recording->info().camera.depth.fx, 528);
  EXPECT_TRUE(recording->info().camera.depth_from_color.isApprox(Isometry3d::Identity()));
  options.topics = "/camera/depth/none";
  EXPECT_THROW(open_recording(kData / "redkitchen_ros2", options), Error);
}

/// CRC-32 of the pixels as images.csv has it.
uint32_t pixel_crc(const cv::Mat& image) {
  return crc32_of({reinterpret_cast<const char*>(image.data), image.total() * image.elemSize()});
}

/// The raw values of depth in metres.
cv::Mat millimetres(const cv::Mat& depth) {
  cv::Mat raw(depth.size(), CV_16U, cv::Scalar(0));
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u)
      if (const float z = depth.at<float>(v, u); z > 0)
        raw.at<uint16_t>(v, u) = static_cast<uint16_t>(std::lround(z * 1000));
  return raw;
}

TEST_F(Ros2, PixelsAreThoseThatWereRecorded) {
  const CsvTable table = CsvTable::read(kData / "images.csv");
  std::map<std::string, std::unique_ptr<RosBag>> bags;
  std::map<std::string, std::map<std::string, std::map<TimeNs, std::string>>> messages;
  for (const char* name : {"redkitchen_ros2", "redkitchen_ros2_db3"}) {
    RosBag bag(kData / name);
    bag.visit([](const BagTopic& topic) { return topic.type.ends_with("Image"); },
              [&](const BagTopic& topic, size_t, TimeNs, std::string_view bytes) {
                const RosHeader header = read_ros_header({bytes, topic.serialization, topic.name});
                messages[name][topic.name][header.stamp_ns] = bytes;
              });
  }
  size_t different = 0;
  for (size_t row = 0; row < table.rows(); ++row) {
    const std::string& topic = table.cell(row, 2);
    const bool compressed = topic.ends_with("compressedDepth") || topic.ends_with("compressed");
    const std::string& bytes = messages.at(table.cell(row, 0)).at(topic).at(table.integer(row, 3));
    const RosMessage message{bytes, Serialization::cdr, topic};
    cv::Mat pixels;
    if (table.cell(row, 4).starts_with("16UC1")) {
      // 65535 means not measured, too: put it back where the stored image has it.
      pixels = millimetres(read_ros_depth(message, compressed));
    } else if (!compressed) {
      const cv::Mat bgr = read_ros_color(message, false);
      pixels.create(bgr.size(), CV_8UC3);
      const int from_to[] = {0, 2, 1, 1, 2, 0};
      cv::mixChannels(&bgr, 1, &pixels, 1, from_to, 3);
    } else {
      continue;
    }
    const auto expected = static_cast<uint32_t>(std::stoul(table.cell(row, 5), nullptr, 16));
    different += pixel_crc(pixels) == expected ? 0 : 1;
  }
  EXPECT_EQ(different, 0U) << "of " << table.rows();
}

TEST_F(Ros2, TestBagsOfRosbag2AreListedAsTheirOwnToolsDo) {
  const fs::path folder = kData / "rosbag2_resources";
  const CsvTable table = CsvTable::read(folder / "expected.csv");
  for (size_t row = 0; row < table.rows(); ++row) {
    SCOPED_TRACE(table.cell(row, 0) + " " + table.cell(row, 1));
    const RosBag bag(folder / table.cell(row, 0));
    const BagTopic* topic = bag.find(table.cell(row, 1));
    ASSERT_NE(topic, nullptr);
    std::string type = table.cell(row, 2);
    if (const size_t msg = type.find("/msg/"); msg != std::string::npos) type.erase(msg, 4);
    EXPECT_EQ(topic->type, type);
    EXPECT_EQ(topic->messages, static_cast<size_t>(table.integer(row, 4)));
    if (topic->messages == 0) continue;
    EXPECT_EQ(bag.times(topic->name).front(), table.integer(row, 5));
    EXPECT_EQ(bag.times(topic->name).back(), table.integer(row, 6));
    EXPECT_FALSE(bag.message(topic->name, topic->messages - 1).empty());
  }
}

TEST_F(Ros2, SeveralFilesAreOneRecording) {
  const RosBag bag(kData / "rosbag2_resources/rosbag2_py/mcap/wbag");
  for (const BagTopic& topic : bag.topics()) {
    const std::vector<TimeNs> times = bag.times(topic.name);
    EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
    EXPECT_GT(times.size(), 1U);
    EXPECT_FALSE(bag.message(topic.name, times.size() - 1).empty());
  }
}

TEST_F(Ros2, BagsWithoutDepthSayWhatTheyHave) {
  try {
    open_recording(kData / "rosbag2_resources/rosbag2_py/mcap/talker");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no depth images"));
    EXPECT_THAT(error.what(), HasSubstr("std_msgs/String"));
  }
}

TEST_F(Ros2, ATruncatedFileGivesWhatIsWhole) {
  const auto recording =
      open_recording(changed_copy([](std::string& bytes) { bytes.resize(bytes.size() / 2); }));
  EXPECT_GT(recording->size(), 5U);
  EXPECT_LT(recording->size(), 24U);
  ASSERT_EQ(recording->info().problems.size(), 1U);
  EXPECT_THAT(recording->info().problems[0], HasSubstr("truncated or damaged at byte"));
  EXPECT_TRUE(recording->frame(0).map_from_camera);
}

TEST_F(Ros2, ADamagedChunkIsLeftOut) {
  const auto recording =
      open_recording(changed_copy([](std::string& bytes) { bytes[bytes.size() / 2] ^= 0x55; }));
  EXPECT_GE(recording->size(), 22U);
  ASSERT_FALSE(recording->info().problems.empty());
  EXPECT_THAT(recording->info().problems[0], HasSubstr("1 of 47 chunks are damaged"));
}

TEST_F(Ros2, WhatADamagedChunkDeclaredIsStillRead) {
  // Channels are declared in the chunk that uses them first; the summary declares them again.
  const auto recording = open_recording(changed_copy([](std::string& bytes) {
    constexpr size_t kFirstChunk = 400;
    for (size_t i = kFirstChunk; i < 60 * kFirstChunk; i += 100) bytes[i] ^= 0x55;
  }));
  const RecordingInfo& info = recording->info();
  EXPECT_THAT(info.problems, Contains(HasSubstr("1 of 47 chunks are damaged")));
  EXPECT_GE(recording->size(), 23U);
  EXPECT_THAT(info.problems, testing::Not(Contains(HasSubstr("no camera_info"))));
  EXPECT_THAT(info.guesses,
              Contains("depth from /camera/depth/image_rect_raw, colour from /camera/color/image_raw"));
}

TEST_F(Ros2, ADamagedImageCostsItsFrameOnly) {
  std::string bytes = read_file(kData / "redkitchen_ros2_db3/redkitchen_ros2_db3_0.db3");
  const size_t first = bytes.find("IDAT");
  for (size_t i = 0; i < 3000; i += 100) bytes[first + 500 + i] ^= 0x55;
  write_file_atomically(root_ / "copy.db3", bytes);
  const auto recording = open_recording(root_ / "copy.db3");
  size_t damaged = 0, whole = 0;
  for (size_t i = 0; i < recording->size(); ++i) {
    const RgbdFrame frame = recording->frame(i);
    (frame.damage.empty() ? whole : damaged) += 1;
    EXPECT_EQ(has_depth(frame), frame.damage.empty());
  }
  EXPECT_EQ(damaged, 1U);
  EXPECT_EQ(whole, 5U);
}

TEST_F(Ros2, ATruncatedDatabaseGivesWhatIsWhole) {
  const std::string bytes = read_file(kData / "redkitchen_ros2_db3/redkitchen_ros2_db3_0.db3");
  write_file_atomically(root_ / "copy.db3", bytes.substr(0, bytes.size() * 6 / 10));
  const auto recording = open_recording(root_ / "copy.db3");
  EXPECT_GE(recording->size(), 2U);
  EXPECT_THAT(recording->info().problems, Contains(HasSubstr("damaged")));
  EXPECT_TRUE(has_depth(recording->frame(0)));
}

TEST_F(Ros2, WithoutItsIndexAFileReadsTheSame) {
  // The summary and footer are gone, as after a crash of the recorder.
  const auto recording = open_recording(changed_copy([](std::string& bytes) {
    const size_t data_end = bytes.rfind(std::string("\x0f\x04\0\0\0\0\0\0\0", 9));
    bytes.resize(data_end);
  }));
  EXPECT_EQ(recording->size(), 24U);
}

TEST_F(Ros2, DamagedBytesAreOneLineEach) {
  const std::string whole = read_file(kData / "redkitchen_ros2_db3/redkitchen_ros2_db3_0.db3");
  const fs::path file = root_ / "copy.db3";
  for (const double part : {0.9, 0.5, 0.1, 0.01}) {
    write_file_atomically(file, whole.substr(0, static_cast<size_t>(part * double(whole.size()))));
    try {
      const auto recording = open_recording(file);
      EXPECT_FALSE(recording->info().problems.empty()) << part;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
}

TEST_F(Ros2, FlippedBytesNeverDoMoreThanHideMessages) {
  std::mt19937_64 random(7);
  for (const char* name : {"rosbag2_py/mcap/convert_a/rewriter_a_0.mcap", "rosbag2_cpp/bags/only_topics.mcap",
                           "rosbag2_py/sqlite3/talker/talker.db3"}) {
    const std::string whole = read_file(kData / "rosbag2_resources" / name);
    const fs::path file = root_ / fs::path(name).filename();
    for (int round = 0; round < 60; ++round) {
      std::string bytes = whole;
      for (int flips = 0; flips < 4; ++flips) bytes[random() % bytes.size()] = static_cast<char>(random());
      write_file_atomically(file, bytes);
      try {
        const RosBag bag(file);
        bag.visit([](const BagTopic&) { return true; },
                  [](const BagTopic&, size_t, TimeNs, std::string_view) {});
      } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      }
    }
  }
}

// Compressed as a whole
// -----------------------------------------------------------------------------------------

/// Bags that the programs zstd, gzip and bzip2 packed.
class PackedBags : public testing::Test {
 protected:
  PackedBags() {
    fs::remove_all(root_);
    make_folder(root_);
    make_folder(temporary_);
    setenv("TMPDIR", temporary_.c_str(), 1);
  }
  ~PackedBags() override {
    unsetenv("TMPDIR");
    fs::remove_all(root_);
  }

  fs::path write(const std::string& name, const std::string& bytes) const {
    make_folder((root_ / name).parent_path());
    write_file_atomically(root_ / name, bytes);
    return root_ / name;
  }
  static std::string refusal(const fs::path& path) {
    try {
      open_recording(path);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  const fs::path seeds_ = fs::path(LOCI_SOURCE_DIR) / "tests/data/fuzz/bag";
  fs::path root_ = fs::path(testing::TempDir()) /
                   (std::string("packed_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  fs::path temporary_ = root_ / "tmp";
};

TEST_F(PackedBags, ReadAsTheBagsThatTheyHold) {
  const std::map<std::string, std::string> plain_of = {{"seed_cdr.mcap.zstd", "seed_cdr.mcap"},
                                                       {"seed.db3.zst", "seed.db3"},
                                                       {"seed.bag.gz", "seed.bag"},
                                                       {"seed.bag.bz2", "seed.bag"}};
  for (const auto& [packed, plain] : plain_of) {
    const auto a = open_recording(seeds_ / plain), b = open_recording(seeds_ / packed);
    EXPECT_TRUE(fs::is_empty(temporary_)) << "nothing is left there, even while the bag is open";
    EXPECT_EQ(a->info().format, b->info().format) << packed;
    EXPECT_EQ(a->info().problems, b->info().problems) << packed;
    ASSERT_EQ(a->size(), b->size()) << packed;
    for (size_t i = 0; i < a->size(); ++i) {
      EXPECT_EQ(a->time_of(i), b->time_of(i));
      EXPECT_EQ(cv::norm(a->frame(i).color, b->frame(i).color, cv::NORM_INF), 0) << packed;
    }
  }
}

TEST_F(PackedBags, SeveralStreamsBehindEachOtherAreOneFile) {
  const std::string plain = read_file(seeds_ / "seed.bag");
  for (const char* ending : {".gz", ".bz2"}) {
    // The bag twice: what stands behind its end is not looked at, but has to be unpacked.
    const std::string packed = read_file(seeds_ / (std::string("seed.bag") + ending));
    NoProgress progress;
    const UnpackedBag bag(write(std::string("twice.bag") + ending, packed + packed), progress);
    EXPECT_EQ(bag.problem(), "");
    EXPECT_EQ(read_file(bag.path()), plain + plain) << ending;
  }
  const std::string packed = read_file(seeds_ / "seed_cdr.mcap.zstd");
  NoProgress progress;
  const UnpackedBag bag(write("twice.mcap.zstd", packed + packed), progress);
  const std::string mcap = read_file(seeds_ / "seed_cdr.mcap");
  EXPECT_EQ(read_file(bag.path()), mcap + mcap);
}

TEST_F(PackedBags, FoldersOfRosbag2AreReadWithTheirMetadata) {
  write("bag/a_0.mcap.zstd", read_file(seeds_ / "seed_cdr.mcap.zstd"));
  write("bag/metadata.yaml",
        "rosbag2_bagfile_information:\n  compression_format: zstd\n  compression_mode: FILE\n"
        "  relative_file_paths: [a_0.mcap.zstd]\n");
  const auto alone = open_recording(seeds_ / "seed_cdr.mcap");
  const auto folder = open_recording(root_ / "bag");
  EXPECT_EQ(folder->size(), alone->size());
  EXPECT_EQ(folder->info().format, "rosbag2");
  EXPECT_EQ(folder->info().problems, alone->info().problems);
  // Unpacked beside it, each message is still there once.
  write("bag/a_0.mcap", read_file(seeds_ / "seed_cdr.mcap"));
  EXPECT_EQ(open_recording(root_ / "bag")->size(), alone->size());
  write("bag/metadata.yaml", "rosbag2_bagfile_information:\n  relative_file_paths: [b_1.mcap.zstd]\n");
  EXPECT_THAT(open_recording(root_ / "bag")->info().problems, Contains(HasSubstr("b_1.mcap.zstd, which")));
}

TEST_F(PackedBags, MessagesOfADatabaseMayBePackedEach) {
  make_folder(root_ / "bag");
  fs::copy_file(seeds_ / "seed.db3", root_ / "bag/a_0.db3");
  {
    SQLite::Database database((root_ / "bag/a_0.db3").string(), SQLite::OPEN_READWRITE);
    std::map<int64_t, std::string> packed;
    SQLite::Statement query(database, "SELECT id, data FROM messages");
    while (query.executeStep()) {
      const SQLite::Column data = query.getColumn(1);
      std::string bytes(ZSTD_compressBound(static_cast<size_t>(data.getBytes())), '\0');
      bytes.resize(
          ZSTD_compress(bytes.data(), bytes.size(), data.getBlob(), static_cast<size_t>(data.getBytes()), 1));
      packed[query.getColumn(0).getInt64()] = bytes;
    }
    query.reset();
    for (const auto& [id, bytes] : packed) {
      SQLite::Statement update(database, "UPDATE messages SET data = ? WHERE id = ?");
      update.bind(1, bytes.data(), static_cast<int>(bytes.size()));
      update.bind(2, id);
      update.exec();
    }
  }
  write("bag/metadata.yaml",
        "rosbag2_bagfile_information:\n  compression_format: zstd\n  compression_mode: MESSAGE\n"
        "  relative_file_paths: [a_0.db3]\n");
  const auto a = open_recording(seeds_ / "seed.db3"), b = open_recording(root_ / "bag");
  ASSERT_EQ(a->size(), b->size());
  EXPECT_EQ(cv::norm(a->frame(0).color, b->frame(0).color, cv::NORM_INF), 0);
}

TEST_F(PackedBags, TruncatedAndDamagedGiveWhatIsWholeOrOneLine) {
  for (const char* name : {"seed_cdr.mcap.zstd", "seed.db3.zst", "seed.bag.gz", "seed.bag.bz2"}) {
    const std::string whole = read_file(seeds_ / name);
    for (const size_t part : {1U, 5U, 9U}) {
      const std::string text = refusal(write(name, whole.substr(0, whole.size() * part / 10)));
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
      EXPECT_EQ(text.find(temporary_.string()), std::string::npos) << text;
    }
    std::string damaged = whole;
    for (size_t at = 20; at < damaged.size(); at += 50) damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    EXPECT_NE(refusal(write(name, damaged)), "no error");
    EXPECT_TRUE(fs::is_empty(temporary_));
  }
  NoProgress progress;
  const UnpackedBag cut(
      write("cut.bag.gz",
            read_file(seeds_ / "seed.bag.gz").substr(0, fs::file_size(seeds_ / "seed.bag.gz") - 20)),
      progress);
  EXPECT_THAT(cut.problem(), HasSubstr("cut.bag.gz: damaged or truncated behind"));
}

TEST_F(PackedBags, UnpackingReportsHowFarItIsAndCanBeStopped) {
  class Unpacking : public Progress {
   public:
    bool update(double fraction, std::string_view text) override {
      EXPECT_THAT(std::string(text), HasSubstr("unpacking seed"));
      fractions_.push_back(fraction);
      return go_on_;
    }
    std::vector<double> fractions_;
    bool go_on_ = true;
  };
  for (const char* name : {"seed.bag.gz", "seed.bag.bz2", "seed_cdr.mcap.zstd"}) {
    Unpacking progress;
    const RosBag bag(seeds_ / name, &progress);
    ASSERT_FALSE(progress.fractions_.empty()) << name;
    EXPECT_EQ(progress.fractions_.front(), 0) << name;
    EXPECT_GT(progress.fractions_.back(), 0.5) << name;
    progress.go_on_ = false;
    EXPECT_THROW(RosBag(seeds_ / name, &progress), Interrupted) << name;
  }
}

TEST_F(PackedBags, ABombIsRefusedWithItsLimit) {
  const std::string bomb = read_file(seeds_ / "bomb.mcap.zstd");  // 100 MB of zeros in 3 kB
  EXPECT_THAT(refusal(write("bomb.mcap.zstd", bomb)),
              HasSubstr("the bag unpacks to more than " + std::to_string((1U << 24) + 1000 * bomb.size()) +
                        " bytes, as many as are allowed for its size; if that is right, unpack it: zstd -d"));
  EXPECT_TRUE(fs::is_empty(temporary_));
  EXPECT_THAT(refusal(write("none.mcap.zstd", "\x28\xb5\x2f\xfd")),
              HasSubstr("the bag cannot be unpacked: damaged or truncated"));
}

TEST_F(PackedBags, AFolderWithoutRoomIsNamed) {
  setenv("TMPDIR", "/dev/full", 1);
  EXPECT_THAT(refusal(seeds_ / "seed_cdr.mcap.zstd"), HasSubstr("name a folder with room in TMPDIR"));
  setenv("TMPDIR", temporary_.c_str(), 1);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{1000, before.rlim_max};
  std::signal(SIGXFSZ, SIG_IGN);  // Writing fails as on a full disk.
  setrlimit(RLIMIT_FSIZE, &small);
  const std::string text = refusal(seeds_ / "seed_cdr.mcap.zstd");
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_THAT(text, HasSubstr("seed_cdr.mcap.zstd: the bag cannot be unpacked into " + temporary_.string() +
                              ": File too large; name a folder with room in TMPDIR, or unpack it: zstd -d"));
  EXPECT_TRUE(fs::is_empty(temporary_));
}

TEST(Compression, LiesAboutSizesAndDamageAreRefused) {
  EXPECT_THROW(decompress("zstd", "hello", 1000), Error);
  EXPECT_THROW(decompress("lz4", "hello", 1000), Error);
  EXPECT_THROW(decompress("brotli", "hello", 1000), Error);
  EXPECT_EQ(decompress("", "hello", 1000), "hello");
}

TEST(Cdr, AMessageThatClaimsMoreThanItHasIsRefused) {
  // Header, then a joint state with 4 billion names.
  std::string bytes("\0\1\0\0\1\0\0\0\2\0\0\0\2\0\0\0a\0\0\0\xff\xff\xff\xff", 24);
  EXPECT_THROW(read_ros_joints({bytes, Serialization::cdr, "joints"}), Error);
  // Big endian: a header of 1 s 2 ns in frame "a".
  bytes = std::string("\0\0\0\0\0\0\0\1\0\0\0\2\0\0\0\2a\0", 18);
  const RosHeader header = read_ros_header({bytes, Serialization::cdr, "header"});
  EXPECT_EQ(header.stamp_ns, kSecond + 2);
  EXPECT_EQ(header.frame, "a");
}

}  // namespace
}  // namespace loci::mapping
