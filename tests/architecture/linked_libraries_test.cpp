// What programs load at their start, directly or through others: no program but loci-browse links Qt or VTK,
// and none links OpenCV's image codecs, which bring GDAL, HDF5 and a hundred more libraries.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>

#include "tests/architecture/tree.h"

namespace {

class ProgramLibraries : public testing::TestWithParam<const char*> {};

TEST_P(ProgramLibraries, HaveNoQtNoVtkAndNoCodecs) {
  const std::string program = std::string(LOCI_BIN_DIR "/") + GetParam();
  ASSERT_TRUE(std::filesystem::exists(program)) << "build all programs first";
  const std::string libraries = output_of("ldd " + program);
  ASSERT_NE(libraries.find("libc.so"), std::string::npos) << libraries;
  EXPECT_EQ(libraries.find("libvtk"), std::string::npos);
  EXPECT_EQ(libraries.find("libQt"), std::string::npos);
  for (const char* heavy : {"opencv_imgcodecs", "libgdal", "libhdf5", "libpq.", "librosbag"})
    EXPECT_EQ(libraries.find(heavy), std::string::npos) << heavy;
}

// Half of the time of a short question is loading libraries.
TEST(LinkedLibraries, OfTheMemoryAreFew) {
  const std::string libraries = output_of("ldd " LOCI_BIN_DIR "/loci-memory | grep -v 'lib[a-z]*san.so'");
  for (const char* unwanted : {"libtesseract", "libpcl", "libopencv_features2d", "libopencv_ml"})
    EXPECT_EQ(libraries.find(unwanted), std::string::npos) << unwanted;
  EXPECT_LE(std::count(libraries.begin(), libraries.end(), '\n'), 62) << libraries;
}

INSTANTIATE_TEST_SUITE_P(Programs, ProgramLibraries,
                         testing::Values("loci-map", "loci-perceive", "loci-memory", "loci-simulate",
                                         "loci-evaluate"));

}  // namespace
