// No program but loci-browse may link Qt or VTK, directly or through others.

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <string>

namespace {

std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return text;
  char buffer[4096];
  while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) text += buffer;
  pclose(pipe);
  return text;
}

class LinkedLibraries : public testing::TestWithParam<const char*> {};

TEST_P(LinkedLibraries, HaveNoQtAndNoVtk) {
  const std::string program = std::string(LOCI_BIN_DIR) + "/" + GetParam();
  ASSERT_TRUE(std::filesystem::exists(program)) << "build all programs first";
  const std::string libraries = output_of("ldd " + program);
  ASSERT_NE(libraries.find("libc.so"), std::string::npos) << libraries;
  EXPECT_EQ(libraries.find("libvtk"), std::string::npos);
  EXPECT_EQ(libraries.find("libQt"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Programs, LinkedLibraries,
                         testing::Values("loci-map", "loci-perceive", "loci-memory", "loci-simulate",
                                         "loci-evaluate"));

}  // namespace
