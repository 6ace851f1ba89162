#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "mapping/base/text/json.h"
#include "memory/identity/vector_file.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

void expect_near(const Json& found, const Json& expected, double tolerance, const std::string& where) {
  if (expected.is_array()) {
    ASSERT_EQ(found.size(), expected.size()) << where;
    for (size_t i = 0; i < expected.size(); ++i)
      expect_near(found[i], expected[i], tolerance, where + "[" + std::to_string(i) + "]");
  } else {
    EXPECT_NEAR(found.get<double>(), expected.get<double>(), tolerance) << where;
  }
}

void expect_matching(const Json& found, const Json& expected, double tolerance, bool compare_pairs) {
  EXPECT_NEAR(found["log_weight"].get<double>(), expected["log_weight"].get<double>(), tolerance);
  EXPECT_NEAR(found["log_probability"].get<double>(), expected["log_probability"].get<double>(), tolerance);
  if (compare_pairs) {
    EXPECT_EQ(found["pairs"], expected["pairs"]);
  }
}

void check(const fs::path& path) {
  SCOPED_TRACE(path.filename());
  const Json file = read_json(path);
  if (file.contains("expect_error")) {
    try {
      identity_vector_from_json(file, path.string());
      ADD_FAILURE() << "was accepted";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(file["expect_error"].get<std::string>()));
    }
    return;
  }
  const IdentityVector vector = identity_vector_from_json(file, path.string());
  const Json found = to_json(solve(vector.problem, vector.options));
  const double tolerance = file["tolerance"].get<double>();
  for (const auto& [key, value] : file["expect"].items())
    if (key != "map" && key != "best") expect_near(found[key], value, tolerance, key);
  const Json& map = file["expect"]["map"];
  EXPECT_EQ(found["map"]["unique"], map["unique"]);
  expect_matching(found["map"], map, tolerance, map["unique"].get<bool>());
  if (!file["expect"].contains("best")) return;
  const Json& best = file["expect"]["best"];
  ASSERT_GE(found["best"].size(), best.size());
  for (size_t i = 0; i < best.size(); ++i) expect_matching(found["best"][i], best[i], tolerance, false);
}

void check_folder(const fs::path& folder) {
  size_t count = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".json" || entry.path().stem() == "index") continue;
    check(entry.path());
    ++count;
  }
  EXPECT_GT(count, 0U);
}

TEST(IdentityVectors, OwnVectorsAreMetToTheirTolerance) {
  check_folder(fs::path(LOCI_SOURCE_DIR) / "tests/data/identity");
}

TEST(IdentityVectors, SharedVectorsAreMetToTheirTolerance) {
  const fs::path folder = fs::path(LOCI_SHARED_DIR) / "identity/vectors";
  if (!fs::exists(folder)) GTEST_SKIP() << "no shared vectors here";
  check_folder(folder);
}

TEST(IdentityVectors, MalformedFilesAreRefusedWithTheEntry) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      identity_vector_from_json(parse_json(text, "x.json"), "x.json");
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(message("{"), testing::HasSubstr("x.json:1: not valid JSON"));
  EXPECT_THAT(message("[]"), testing::HasSubstr("invalid_shape"));
  EXPECT_THAT(message("{}"), testing::HasSubstr("old: invalid_shape: missing"));
  EXPECT_THAT(message(R"({"old":-1})"), testing::HasSubstr("old: invalid_shape"));
  EXPECT_THAT(message(R"({"old":1000000000,"new":1,"similar":[[0]],"proximity":[[0]],"out_of_view":[0]})"),
              testing::HasSubstr("similar: invalid_shape: 1 entries instead of 1000000000"));
  EXPECT_THAT(message(R"({"old":1,"new":1,"similar":[["x"]],"proximity":[[0]],"out_of_view":[0]})"),
              testing::HasSubstr("similar[0][0]: invalid_value: not a number"));
  EXPECT_THAT(message(R"({"old":1,"new":1,"similar":[7],"proximity":[[0]],"out_of_view":[0]})"),
              testing::HasSubstr("similar[0]: invalid_shape"));
  EXPECT_THAT(message(R"({"old":1,"new":1,"similar":[[0]],"proximity":[[0]],"out_of_view":[0],"params":3})"),
              testing::HasSubstr("invalid_shape"));
  EXPECT_THAT(
      message(R"({"old":1,"new":1,"similar":[[0]],"proximity":[[0]],"out_of_view":[0],"params":{"eps":0}})"),
      testing::HasSubstr("params.eps: invalid_value"));
}

}  // namespace
}  // namespace loci::memory
