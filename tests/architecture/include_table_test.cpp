// Checks every #include line against the table in docs/architecture.md, both columns.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>

#include "tests/architecture/tree.h"

namespace {

namespace fs = std::filesystem;

struct Row {
  std::set<std::string> folders;
  std::set<std::string> libraries;
};

/// Outside libraries by how their headers begin. What is not listed here is refused.
const std::vector<std::pair<std::string, std::string>> kLibraries = {{"fmt/", "fmt"},
                                                                     {"yaml-cpp/", "yaml-cpp"},
                                                                     {"nlohmann/", "nlohmann-json"},
                                                                     {"Eigen/", "Eigen"},
                                                                     {"opencv2/", "OpenCV"},
                                                                     {"tbb/", "TBB"},
                                                                     {"date/", "date"},
                                                                     {"openssl/", "OpenSSL"},
                                                                     {"gumbo.h", "libgumbo"},
                                                                     {"png.h", "libpng"},
                                                                     {"jpeglib.h", "libjpeg"},
                                                                     {"jerror.h", "libjpeg"},
                                                                     {"tiffio.h", "libtiff"},
                                                                     {"Imf", "OpenEXR"},
                                                                     {"urdf_parser/", "urdfdom"},
                                                                     {"urdf_model/", "urdfdom"},
                                                                     {"urdf_world/", "urdfdom"},
                                                                     {"console_bridge/", "console-bridge"},
                                                                     {"assimp/", "assimp"},
                                                                     {"tinyxml2.h", "tinyxml2"},
                                                                     {"pcl/", "PCL"},
                                                                     {"SQLiteCpp/", "SQLiteCpp"},
                                                                     {"sqlite3.h", "SQLiteCpp"},
                                                                     {"zstd.h", "zstd"},
                                                                     {"libpq-fe.h", "libpq"},
                                                                     {"lz4frame.h", "lz4"},
                                                                     {"zlib.h", "zlib"},
                                                                     {"zbar.h", "ZBar"},
                                                                     {"ZXing/", "ZXing"},
                                                                     {"tesseract/", "Tesseract"},
                                                                     {"google/protobuf/", "protobuf"},
                                                                     {"httplib.h", "cpp-httplib"},
                                                                     {"boost/", "Boost"},
                                                                     {"rosbag/", "librosbag-storage"},
                                                                     {"bzlib.h", "bzip2"},
                                                                     {"ros/", "librosbag-storage"},
                                                                     {"CLI/", "CLI11"},
                                                                     {"gtest/", "GoogleTest"},
                                                                     {"gmock/", "GoogleTest"},
                                                                     {"vtk", "VTK"},
                                                                     {"QVTK", "VTK"},
                                                                     {"EGL/", "VTK"},
                                                                     {"GL/", "VTK"},
                                                                     {"embree3/", "Embree"},
                                                                     {"open3d/", "Open3D"},
                                                                     {"tiny_gltf.h", "tinygltf"},
                                                                     {"octomap/", "OctoMap"},
                                                                     {"ceres/", "Ceres"},
                                                                     {"sdf/", "sdformat"},
                                                                     {"bullet/", "Bullet"},
                                                                     {"BulletDynamics/", "Bullet"},
                                                                     {"btBullet", "Bullet"},
                                                                     {"mujoco/", "MuJoCo"},
                                                                     {"pybind11/", "pybind11"}};
const std::set<std::string> kBaseLibraries = {"fmt", "yaml-cpp", "nlohmann-json", "Eigen"};

std::string trimmed(std::string text) {
  const auto is_space = [](unsigned char c) { return std::isspace(c) != 0; };
  text.erase(text.begin(), std::find_if_not(text.begin(), text.end(), is_space));
  text.erase(std::find_if_not(text.rbegin(), text.rend(), is_space).base(), text.end());
  return text;
}

/// Splits at commas outside braces: "perception/{cas, types}, mapping/base".
std::vector<std::string> split_list(const std::string& text) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : text) {
    depth += c == '{' ? 1 : c == '}' ? -1 : 0;
    if (c == ',' && depth == 0)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  for (std::string& part : parts) part = trimmed(part);
  std::erase_if(parts, [](const std::string& part) { return part.empty() || part == "–"; });
  return parts;
}

std::set<std::string> expand_folders(const std::string& cell, const std::string& wing) {
  std::set<std::string> folders;
  for (const std::string& part : split_list(cell)) {
    const size_t brace = part.find('{');
    if (brace != std::string::npos) {
      const std::string inside = part.substr(brace + 1, part.find('}') - brace - 1);
      for (const std::string& name : split_list(inside)) folders.insert(part.substr(0, brace) + name);
    } else if (part == "everything" || part.find('/') != std::string::npos) {
      folders.insert(part);
    } else {
      folders.insert(wing + "/" + part);
    }
  }
  return folders;
}

std::map<std::string, Row> read_table() {
  std::ifstream file(kRoot / "docs/architecture.md");
  std::map<std::string, Row> table;
  bool inside = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("| folder |")) inside = true;
    if (!inside || line.starts_with("|---") || line.starts_with("| folder |")) continue;
    if (!line.starts_with("|")) {
      inside = false;
      continue;
    }
    std::vector<std::string> cells;
    std::stringstream stream(line.substr(1));
    for (std::string cell; std::getline(stream, cell, '|');) cells.push_back(trimmed(cell));
    const std::string& folder = cells.at(0);
    const auto libraries = split_list(cells.at(2));
    table[folder] = {expand_folders(cells.at(1), folder.substr(0, folder.find('/'))),
                     {libraries.begin(), libraries.end()}};
  }
  return table;
}

/// The row that is responsible for a file: the longest folder that it lies in.
std::optional<std::string> room_of(const std::string& path, const std::map<std::string, Row>& table) {
  std::optional<std::string> best;
  for (const auto& [folder, row] : table)
    if (path.starts_with(folder + "/") && (!best || folder.size() > best->size())) best = folder;
  return best;
}

bool may_include(const Row& row, const std::string& own, const std::string& target) {
  if (target == own || row.folders.contains("everything") || row.folders.contains(target)) return true;
  return row.folders.contains(target.substr(0, target.find('/')) + "/*");
}

std::optional<std::string> library_of(const std::string& header) {
  for (const auto& [prefix, library] : kLibraries)
    if (header.starts_with(prefix)) return library;
  if (header.size() > 1 && header[0] == 'Q' && std::isupper(static_cast<unsigned char>(header[1])) != 0)
    return "Qt";
  if (header.starts_with("Qt")) return "Qt";
  return std::nullopt;
}

bool is_standard_or_system(const std::string& header) {
  static const std::set<std::string> kSystem = {
      "malloc.h",   "stdio_ext.h", "poll.h",       "unistd.h",    "fcntl.h",      "sys/file.h",
      "sys/stat.h", "sys/wait.h",  "signal.h",     "fnmatch.h",   "sys/types.h",  "sys/resource.h",
      "dlfcn.h",    "regex.h",     "sys/socket.h", "sys/xattr.h", "netinet/in.h", "arpa/inet.h"};
  return kSystem.contains(header) || header.find_first_of("./") == std::string::npos;
}

std::vector<fs::path> sources() {
  std::vector<fs::path> files;
  for (const char* wing : {"mapping", "nbv", "perception", "memory", "gui", "apps", "python", "tests"}) {
    if (!fs::exists(kRoot / wing)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / wing)) {
      const auto ending = entry.path().extension();
      if (ending == ".h" || ending == ".cpp") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string problem_with(const std::string& path, const std::string& header,
                         const std::map<std::string, Row>& table) {
  const auto own = room_of(path, table);
  if (!own) return "lies in a folder that the table does not know";
  const Row& row = table.at(*own);
  if (const auto target = room_of(header, table)) {
    if (target->starts_with("gui/") && !own->starts_with("gui/") && !path.starts_with("apps/browse/") &&
        !path.starts_with("tests/gui/"))
      return "may not include gui";
    return may_include(row, *own, *target) ? "" : "may not include " + *target;
  }
  const auto library = library_of(header);
  if (!library)
    return is_standard_or_system(header) ? "" : "includes '" + header + "', which the table does not know";
  if (kBaseLibraries.contains(*library) || row.libraries.contains(*library)) return "";
  return "may not use " + *library;
}

TEST(IncludeTable, EveryIncludeIsAllowedByTheTable) {
  const auto table = read_table();
  ASSERT_GT(table.size(), 20U);
  const std::regex include(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  for (const fs::path& file : sources()) {
    const std::string path = fs::relative(file, kRoot).string();
    std::ifstream stream(file);
    int number = 0;
    for (std::string line; std::getline(stream, line);) {
      ++number;
      std::smatch match;
      if (line.find("include") == std::string::npos || !std::regex_search(line, match, include)) continue;
      EXPECT_EQ(problem_with(path, match[1], table), "") << path << ":" << number << ": " << line;
    }
  }
}

TEST(IncludeTable, RefusesWhatItShouldRefuse) {
  const auto table = read_table();
  EXPECT_NE(problem_with("mapping/base/x.cpp", "mapping/world/world.h", table), "");
  EXPECT_NE(problem_with("mapping/world/x.cpp", "pcl/point_types.h", table), "");
  EXPECT_NE(problem_with("apps/map/x.cpp", "gui/window/main_window.h", table), "");
  EXPECT_NE(problem_with("memory/store/x.cpp", "QWidget", table), "");
  EXPECT_NE(problem_with("memory/store/x.cpp", "boost/any.hpp", table), "");
  EXPECT_EQ(problem_with("memory/annotators/x.cpp", "mapping/render/render.h", table), "");
}

TEST(SourceTree, TopLevelHoldsOnlyWhatTheDesignLists) {
  const std::set<std::string> allowed = {"CMakeLists.txt",
                                         "CMakePresets.json",
                                         "README.md",
                                         "CHANGELOG.md",
                                         "CONTRIBUTING.md",
                                         "CITATION.cff",
                                         "LICENSE",
                                         "setup",
                                         "demo",
                                         "test",
                                         ".ci",
                                         "cmake",
                                         "docs",
                                         "mapping",
                                         "nbv",
                                         "perception",
                                         "memory",
                                         "gui",
                                         "apps",
                                         "python",
                                         "tests",
                                         ".git",
                                         ".gitignore",
                                         ".clang-format",
                                         ".clang-tidy",
                                         "build",
                                         "demo-output",
                                         ".cache"};
  for (const auto& entry : fs::directory_iterator(kRoot))
    EXPECT_TRUE(allowed.contains(entry.path().filename().string())) << entry.path();
}

}  // namespace
