#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "mapping/base/files.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;

/// Tests run at the same time, each in a process of its own.
fs::path temporary(const std::string& name) {
  return fs::temp_directory_path() / ("loci_" + std::to_string(::getpid()) + "_" + name);
}

int generate(const std::string& arguments) {
  return std::system((std::string(LOCI_GENERATE_TYPES) + " " + arguments + " 2>/dev/null").c_str());
}

TEST(TypeGenerator, ThePageOfTypesIsUpToDate) {
  const fs::path page = temporary("types.md");
  std::string files;
  for (const char* name : {"core", "ros", "tf", "cv", "pcl", "hypothesis", "annotation", "scene", "belief"})
    files += fmt::format(" {}/perception/types/{}.xml", LOCI_SOURCE_DIR, name);
  ASSERT_EQ(generate("docs " + page.string() + files), 0);
  EXPECT_EQ(read_file(page), read_file(LOCI_SOURCE_DIR "/docs/type-system.md"))
      << "run ninja -C build/release type_system_docs";
  fs::remove(page);
}

TEST(TypeGenerator, LeavesAnEqualHeaderAlone) {
  const fs::path folder = temporary("generated");
  fs::remove_all(folder);
  const std::string arguments =
      "proxies some::space some/room " + folder.string() + " " + LOCI_SOURCE_DIR + "/tests/data/climate.xml";
  ASSERT_EQ(generate(arguments), 0);
  const fs::path header = folder / "some" / "room" / "generated.h";
  EXPECT_THAT(read_file(header),
              testing::HasSubstr("class Temperature : public loci::perception::types::Annotation"));
  const auto written = fs::last_write_time(header);
  ASSERT_EQ(generate(arguments), 0);
  EXPECT_EQ(fs::last_write_time(header), written);
  fs::remove_all(folder);
}

TEST(TypeGenerator, RefusesTwoTypesThatWouldBeOneClass) {
  const fs::path folder = temporary("generated");
  make_folder(folder);
  const std::string type = "<typeDescription><name>a.X</name></typeDescription>";
  write_file_atomically(folder / "twice.xml", "<typeSystemDescription><types>" + type +
                                                  "<typeDescription><name>b.X</name></typeDescription>"
                                                  "</types></typeSystemDescription>");
  EXPECT_NE(generate("proxies n room " + folder.string() + " " + (folder / "twice.xml").string()), 0);
  EXPECT_NE(generate("proxies"), 0);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace loci::perception
