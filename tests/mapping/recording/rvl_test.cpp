#include "mapping/recording/ros/rvl.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/base/math/random.h"
#include "mapping/recording/ros/message_writers.h"
#include "mapping/recording/ros/messages.h"

namespace loci::mapping {
namespace {

using testing::HasSubstr;

/// The other direction, as the paper has it.
class RvlEncoder {
 public:
  static std::string encoded(const cv::Mat& depth) {
    RvlEncoder encoder;
    encoder.add(static_cast<uint32_t>(depth.cols));
    encoder.add(static_cast<uint32_t>(depth.rows));
    const auto *pixel = depth.ptr<uint16_t>(), *end = pixel + depth.total();
    int before = 0;
    while (pixel != end) {
      const auto* measured = std::find_if(pixel, end, [](uint16_t value) { return value != 0; });
      const auto* next = std::find(measured, end, uint16_t{0});
      encoder.number(static_cast<uint32_t>(measured - pixel));
      encoder.number(static_cast<uint32_t>(next - measured));
      for (pixel = measured; pixel != next; ++pixel) {
        const int difference = *pixel - before;
        encoder.number(static_cast<uint32_t>(difference << 1 ^ difference >> 31));
        before = *pixel;
      }
    }
    while (encoder.groups_ != 0) encoder.group(0);
    return encoder.bytes_;
  }

 private:
  void add(uint32_t word) { bytes_.append(reinterpret_cast<const char*>(&word), sizeof word); }
  void group(uint32_t bits) {
    word_ = word_ << 4 | bits;
    if (++groups_ < 8) return;
    add(word_);
    groups_ = 0;
  }
  void number(uint32_t value) {
    for (; value > 7; value >>= 3) group(8 | (value & 7));
    group(value);
  }

  std::string bytes_;
  uint32_t word_ = 0;
  int groups_ = 0;
};

/// Surfaces with holes, and the largest steps.
cv::Mat depth_image() {
  cv::Mat depth(48, 64, CV_16UC1);
  Random random(3);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u) {
      const bool hole = (u / 7 + v / 5) % 4 == 0;
      depth.at<uint16_t>(v, u) =
          hole ? uint16_t{0} : static_cast<uint16_t>(900 + 3 * u + v + random.index(4));
    }
  depth.at<uint16_t>(20, 20) = 65535;
  depth.at<uint16_t>(20, 21) = 1;
  return depth;
}

std::string refusal_of(const std::string& bytes) {
  try {
    decode_rvl(bytes, {"depth", 0, {}});
  } catch (const Error& error) {
    return error.what();
  }
  return "read";
}

TEST(Rvl, GivesThePixelsThatWereEncoded) {
  for (const cv::Mat& depth :
       {depth_image(), cv::Mat(3, 5, CV_16UC1, cv::Scalar(0)), cv::Mat(1, 1, CV_16UC1, cv::Scalar(7))}) {
    const cv::Mat decoded = decode_rvl(RvlEncoder::encoded(depth), {"depth", 0, {}});
    ASSERT_EQ(decoded.size(), depth.size());
    EXPECT_EQ(cv::countNonZero(decoded != depth), 0);
  }
}

TEST(Rvl, IsReadByHand) {
  // One pixel without, three with: 9, 8, 10, whose differences 9, -1, 2 are 18, 1, 4: groups 1 | 3 | 2+8, 2 |
  // 1 | 4.
  const std::string bytes("\x02\0\0\0\x02\0\0\0\x00\x14\xa2\x13", 12);
  const cv::Mat decoded = decode_rvl(bytes, {"depth", 0, {}});
  EXPECT_EQ(decoded.at<uint16_t>(0, 0), 0);
  EXPECT_EQ(decoded.at<uint16_t>(0, 1), 9);
  EXPECT_EQ(decoded.at<uint16_t>(1, 0), 8);
  EXPECT_EQ(decoded.at<uint16_t>(1, 1), 10);
}

TEST(Rvl, LiesAndDamageAreRefused) {
  const std::string whole = RvlEncoder::encoded(depth_image());
  for (const size_t size : {size_t{0}, size_t{7}, size_t{8}, size_t{40}, whole.size() - 4})
    EXPECT_THAT(refusal_of(whole.substr(0, size)), HasSubstr("RVL ends before")) << size;
  EXPECT_THAT(refusal_of(std::string(8, '\xff')), HasSubstr("is not read"));
  EXPECT_THAT(refusal_of(std::string(12, '\0')), HasSubstr("is not read"));
  std::string smaller = whole;
  smaller[0] = 63;  // The last run of a column too many.
  EXPECT_THAT(refusal_of(smaller), HasSubstr("beyond the image"));
  EXPECT_THAT(refusal_of(whole.substr(0, 8) + std::string(64, '\xff')), HasSubstr("more than 32 bits"));
  EXPECT_THAT(refusal_of(std::string("\x02\0\0\0\x02\0\0\0\0\0\x10\x01", 12)),
              HasSubstr("more than 16 bits"));
}

TEST(Rvl, DepthOfMessagesIsInMetres) {
  const cv::Mat raw = depth_image();
  const auto message = [&](const std::string& format, float a, float b) {
    std::string data(4, '\0');
    data.append(reinterpret_cast<const char*>(&a), 4).append(reinterpret_cast<const char*>(&b), 4);
    CdrWriter cdr;
    cdr.header(kSecond, "camera").text(format + "; compressedDepth rvl");
    return cdr.data(data + RvlEncoder::encoded(raw)).bytes();
  };
  const std::string plain = message("16UC1", 0, 0), quantised = message("32FC1", 4000, -10);
  const cv::Mat millimetres = read_ros_depth({plain, Serialization::cdr, "depth"}, true);
  EXPECT_FLOAT_EQ(millimetres.at<float>(40, 40), 0.001F * raw.at<uint16_t>(40, 40));
  EXPECT_TRUE(std::isnan(millimetres.at<float>(20, 20)));
  const cv::Mat metres = read_ros_depth({quantised, Serialization::cdr, "depth"}, true);
  EXPECT_FLOAT_EQ(metres.at<float>(40, 40), 4000.F / (static_cast<float>(raw.at<uint16_t>(40, 40)) + 10.F));
}

}  // namespace
}  // namespace loci::mapping
