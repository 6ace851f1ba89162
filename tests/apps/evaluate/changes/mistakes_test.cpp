#include "apps/evaluate/changes/mistakes.h"

#include <gtest/gtest.h>

namespace loci::apps::changes {
namespace {

constexpr const char* kHostile = "<script>alert('cup')</script>";

/// Two grey frames.
class TwoFrames : public mapping::Recording {
 public:
  TwoFrames() { info_.path = "kitchen/<b>day</b>"; }
  const mapping::RecordingInfo& info() const override { return info_; }
  size_t size() const override { return 2; }
  mapping::RgbdFrame frame(size_t i) const override {
    mapping::RgbdFrame frame;
    frame.index = index_of(i);
    frame.color = cv::Mat(480, 640, CV_8UC3, cv::Scalar(90, 90, 90));
    return frame;
  }
  TimeNs time_of(size_t i) const override { return static_cast<TimeNs>(i) * 60 * kSecond; }
  int64_t index_of(size_t i) const override { return static_cast<int64_t>(i); }

 private:
  mapping::RecordingInfo info_;
};

/// A cup is pushed aside and taken for a new object; a bowl stands still. Both are 2 m before the camera.
struct Mistakes : testing::Test {
  Mistakes() {
    for (const int64_t frame : {0, 1}) {
      add(frame, kHostile, Vector3d(frame == 0 ? 0.0 : 0.3, 0, 2));
      add(frame, "bowl", Vector3d(-0.4, 0.2, 2));
    }
    truth.transitions = {{0, 1, kHostile, "moved"}, {0, 1, "bowl", "unchanged"}};
    story[0] = {{{10, 1}, {20, 2}}, {{1, {"appeared"}}, {2, {"appeared"}}}};
    story[1] = {{{11, 3}, {21, 2}}, {{1, {"gone"}}, {3, {"appeared"}}}};
    using memory::Explanation;
    for (const auto& [object, explanation, probability] :
         {std::tuple{memory::Id(3), Explanation::appear, 0.7},
          std::tuple{memory::Id(1), Explanation::move, 0.3}}) {
      memory::AssociationRow row;
      row.observation = 11;
      row.object = object;
      row.explanation = explanation;
      row.probability = probability;
      row.chosen = object == 3;
      story[1].alternatives.push_back(row);
    }
  }

  void add(int64_t frame, const std::string& name, const Vector3d& centre) {
    const memory::Id observation = (name == "bowl" ? 20 : 10) + frame;
    truth.visible[frame].push_back({name, centre, Vector3d(0.1, 0.1, 0.1), std::nullopt});
    truth.handled[frame][name] = static_cast<int>(frame);
    Sight sight{observation, centre, std::nullopt, {}};
    sight.evidence.box = {centre, Vector3d(0.1, 0.1, 0.1)};
    moments[frame].sights.push_back(sight);
  }

  std::vector<Mistake> worst() const {
    return worst_mistakes(compare("loci", truth, moments, story), truth, moments, story, TwoFrames());
  }

  Truth truth;
  Moments moments;
  Story story;
};

size_t count_of(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST_F(Mistakes, AreWrongTransitionsWithWhatWasStatedAndWhatCompeted) {
  const std::vector<Mistake> mistakes = worst();
  ASSERT_EQ(mistakes.size(), 1U);
  EXPECT_EQ(mistakes[0].transition.said, "identity lost");
  EXPECT_DOUBLE_EQ(mistakes[0].stated, 0.7);
  ASSERT_EQ(mistakes[0].competitors.size(), 2U);
  EXPECT_EQ(mistakes[0].competitors[0].name, "object_3 (new)");
  EXPECT_EQ(mistakes[0].competitors[1].name, "object_1");
  EXPECT_FALSE(mistakes[0].before.image.empty());
  EXPECT_FALSE(mistakes[0].after.image.empty());
}

TEST_F(Mistakes, ArePutOnOnePageAndNamesAreEscaped) {
  const std::string page = mistakes_page(worst());
  EXPECT_EQ(count_of(page, "<section id=\"mistake_"), 1U);
  EXPECT_EQ(count_of(page, "<img"), 2U) << "before and after";
  EXPECT_EQ(page.find(kHostile), std::string::npos);
  EXPECT_EQ(page.find("<b>day</b>"), std::string::npos);
  EXPECT_NE(page.find("&lt;script&gt;alert"), std::string::npos);
}

TEST_F(Mistakes, OfManyTheTenThatWereStatedMostSurelyAreShown) {
  std::vector<Mistake> many(14, worst().front());
  for (size_t i = 0; i < many.size(); ++i) many[i].stated = 0.05 * static_cast<double>(i);
  const std::string page = mistakes_page(many);
  EXPECT_EQ(count_of(page, "<section id=\"mistake_"), kShownMistakes);
  EXPECT_LT(page.find("0.650"), page.find("0.600"));
  EXPECT_EQ(page.find("0.150"), std::string::npos);
}

}  // namespace
}  // namespace loci::apps::changes
