#include "mapping/image/image_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "mapping/base/error.h"
#include "mapping/base/files.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

cv::Mat gradient(int type) {
  cv::Mat image(48, 64, type);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      if (type == CV_16UC1)
        image.at<uint16_t>(v, u) = static_cast<uint16_t>(u * 1000 + v);
      else
        image.at<cv::Vec3b>(v, u) = cv::Vec3b(static_cast<uchar>(u), static_cast<uchar>(v), 200);
    }
  }
  return image;
}

class ImageIo : public testing::Test {
 protected:
  ImageIo() { make_folder(folder_); }
  ~ImageIo() override { fs::remove_all(folder_); }

  std::string message_of(const std::function<void()>& call) {
    try {
      call();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  fs::path folder_ =
      fs::path(testing::TempDir()) /
      (std::string("image_io_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(ImageIo, PngComesBackEqualAndTwiceTheSameBytes) {
  for (const int type : {CV_16UC1, CV_8UC3}) {
    const cv::Mat image = gradient(type);
    write_image(folder_ / "a.png", image);
    write_image(folder_ / "b.png", image);
    EXPECT_EQ(read_file(folder_ / "a.png"), read_file(folder_ / "b.png"));
    const cv::Mat back = type == CV_16UC1 ? read_uint16(folder_ / "a.png") : read_color(folder_ / "a.png");
    EXPECT_EQ(cv::norm(image, back, cv::NORM_INF), 0);
  }
}

TEST_F(ImageIo, HeaderTellsSizeAndKindWithoutDecoding) {
  write_image(folder_ / "d.png", gradient(CV_16UC1));
  write_image(folder_ / "c.jpg", gradient(CV_8UC3));
  const ImageHeader depth = read_image_header(folder_ / "d.png");
  EXPECT_EQ(depth.width, 64);
  EXPECT_EQ(depth.height, 48);
  EXPECT_EQ(depth.channels, 1);
  EXPECT_EQ(depth.bits, 16);
  const ImageHeader color = read_image_header(folder_ / "c.jpg");
  EXPECT_EQ(color.width, 64);
  EXPECT_EQ(color.height, 48);
  EXPECT_EQ(color.channels, 3);
  EXPECT_EQ(color.bits, 8);
}

TEST_F(ImageIo, TruncatedImagesAreRefusedWhereverTheyEnd) {
  for (const char* name : {"a.png", "a.jpg"}) {
    write_image(folder_ / name, gradient(CV_8UC3));
    const std::string whole = read_file(folder_ / name);
    for (const size_t part : {size_t{1}, size_t{20}, whole.size() / 2, whole.size() - 2}) {
      write_file_atomically(folder_ / name, whole.substr(0, part));
      EXPECT_THAT(message_of([&] { read_color(folder_ / name); }), HasSubstr(name)) << part;
      EXPECT_THAT(message_of([&] { read_image_header(folder_ / name); }), HasSubstr(name)) << part;
    }
    write_file_atomically(folder_ / name, whole.substr(0, whole.size() / 2));
    EXPECT_THAT(message_of([&] { read_color(folder_ / name); }), HasSubstr("truncated"));
  }
}

TEST_F(ImageIo, FlippedBitInPngIsFound) {
  write_image(folder_ / "a.png", gradient(CV_16UC1));
  std::string bytes = read_file(folder_ / "a.png");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 4);
  write_file_atomically(folder_ / "a.png", bytes);
  EXPECT_THAT(message_of([&] { read_uint16(folder_ / "a.png"); }), HasSubstr("damaged"));
}

TEST_F(ImageIo, OtherFilesAndOtherKindsAreRefused) {
  write_file_atomically(folder_ / "text.png", "no image");
  EXPECT_THAT(message_of([&] { read_color(folder_ / "text.png"); }), HasSubstr("not a PNG or JPEG"));
  EXPECT_THAT(message_of([&] { read_color(folder_ / "absent.png"); }), HasSubstr("absent.png: no such file"));
  write_image(folder_ / "c.png", gradient(CV_8UC3));
  EXPECT_THAT(message_of([&] { read_uint16(folder_ / "c.png"); }), HasSubstr("16-bit grey"));
  EXPECT_THAT(message_of([&] { write_image(folder_ / "c.bmp", gradient(CV_8UC3)); }),
              HasSubstr(".png or .jpg"));
}

TEST(ImageBytes, EveryTruncationIsRefused) {
  for (const char* ending : {".png", ".jpg"}) {
    const std::vector<unsigned char> whole = encode_image(gradient(CV_8UC3), ending);
    ASSERT_NO_THROW(decode_image(whole, "whole"));
    for (size_t size = 0; size < whole.size(); ++size)
      EXPECT_THROW(decode_image({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}, "part"),
                   Error)
          << ending << " " << size;
  }
}

TEST(ImageBytes, EveryFlippedByteOfAPngIsRefused) {
  const std::vector<unsigned char> whole = encode_image(gradient(CV_16UC1), ".png");
  for (size_t at = 0; at < whole.size(); ++at) {
    std::vector<unsigned char> damaged = whole;
    damaged[at] ^= 0x55;
    EXPECT_THROW(decode_image(damaged, "damaged"), Error) << at;
  }
}

TEST(ImageBytes, AJpegThatIsCutInsideAndEndsProperlyIsRefused) {
  cv::Mat noise(480, 640, CV_8UC3);
  cv::randu(noise, 0, 255);
  const std::vector<unsigned char> whole = encode_image(noise, ".jpg");
  for (const size_t part : {3U, 5U, 8U}) {
    std::vector<unsigned char> cut = whole;
    const auto at = cut.begin() + static_cast<std::ptrdiff_t>(cut.size() * part / 10);
    cut.erase(at, at + static_cast<std::ptrdiff_t>(cut.size() / 20));
    try {
      decode_image(cut, "cut.jpg");
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("cut.jpg: the image is damaged (Corrupt JPEG data"));
    }
  }
}

TEST(ImageBytes, AFewBytesBeforeTheEndOfAJpegAreNoDamage) {
  std::vector<unsigned char> padded = encode_image(gradient(CV_8UC3), ".jpg");
  padded.insert(padded.end() - 2, 8, 0);  // as webcams do
  EXPECT_FALSE(decode_image(padded, "padded.jpg").empty());
}

TEST(ImageBytes, SizesAreCheckedBeforeMemoryIsTaken) {
  // The frame header of a JPEG states its size; there is no check sum.
  std::vector<unsigned char> jpeg = encode_image(gradient(CV_8UC3), ".jpg");
  const std::vector<unsigned char> frame = {0xff, 0xc0};
  const auto size = std::search(jpeg.begin(), jpeg.end(), frame.begin(), frame.end()) + 5;
  for (int i = 0; i < 4; ++i) size[i] = i % 2 == 0 ? 0xff : 0;
  try {
    decode_image(jpeg, "huge.jpg");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("too large: 65280 x 65280"));
  }
}

TEST(ImageBytes, AJpegOfMorePixelsThanDataIsRefused) {
  // Within the limit of pixels, but a progressive decoder would take 1.6 GB for it.
  std::vector<unsigned char> jpeg = encode_image(gradient(CV_8UC3), ".jpg");
  const std::vector<unsigned char> frame = {0xff, 0xc0};
  const auto head = std::search(jpeg.begin(), jpeg.end(), frame.begin(), frame.end());
  for (const int mode : {0xc0, 0xc2}) {
    head[1] = static_cast<unsigned char>(mode);
    for (int i = 0; i < 4; ++i) head[5 + i] = i % 2 == 0 ? 0x20 : 0;
    try {
      decode_color({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()}, "large.jpg");
      FAIL();
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("more pixels than data"));
    }
  }
}

TEST(ImageBytes, ACallerMayAllowFewerPixels) {
  for (const char* ending : {".png", ".jpg"}) {
    const std::vector<unsigned char> bytes = encode_image(gradient(CV_8UC3), ending);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const cv::Mat image = decode_color(text, "image");
    EXPECT_EQ(image.type(), CV_8UC3);
    EXPECT_THROW(decode_color(text, "image", image.total() - 1), Error) << ending;
  }
}

TEST(ImageBytes, OtherKindsAreNotEncoded) {
  EXPECT_THROW(encode_image(cv::Mat(4, 4, CV_32FC1, cv::Scalar(1)), ".png"), Error);
  EXPECT_THROW(encode_image(cv::Mat(4, 4, CV_16UC1, cv::Scalar(1)), ".jpg"), Error);
  EXPECT_THROW(encode_image(cv::Mat(), ".png"), Error);
}

TEST(ImageBytes, ChannelsAndDepthComeBack) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4}) {
    cv::Mat image(7, 9, type);
    cv::randu(image, 0, 255);
    const cv::Mat part = image(cv::Rect(2, 1, 5, 6));  // Rows are not next to each other.
    const cv::Mat back = decode_image(encode_image(part, ".png"), "blob");
    ASSERT_EQ(back.type(), type);
    EXPECT_EQ(cv::norm(part, back, cv::NORM_INF), 0);
  }
}

TEST(ImageBytes, EncodeAndDecodeInMemory) {
  const cv::Mat image = gradient(CV_16UC1);
  EXPECT_EQ(cv::norm(image, decode_image(encode_image(image, ".png"), "blob"), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace loci::mapping
