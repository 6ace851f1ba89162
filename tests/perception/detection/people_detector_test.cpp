#include "perception/detection/people_detector.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/drawn_person.h"
#include "tests/support/pedestrians.h"

namespace loci::perception {
namespace {

size_t faces_in(const cv::Mat& image, PeopleDetector& detector) {
  PeopleFrame frame;
  frame.color = image;
  return static_cast<size_t>(
      std::ranges::count_if(detector.detect(frame), [](const Person& person) { return person.has_face; }));
}

TEST(PeopleDetector, FindsWhoLooksAtTheCamera) {
  PeopleDetector detector;
  for (const double z : {1.0, 1.6, 2.5}) {
    const std::vector<Person> people = detector.detect(frame_with_person(z));
    ASSERT_EQ(people.size(), 1U) << z;
    EXPECT_TRUE(people[0].has_face);
    EXPECT_TRUE(people[0].head.contains({300, 150}));
    EXPECT_GT(people[0].body.height, 3 * people[0].head.height / 2) << "the trunk is part of the person";
    const double area = static_cast<double>(people[0].pixels.size()) * z * z / (585 * 585);
    EXPECT_GT(area, 0.15) << "square metres at " << z;
    EXPECT_LT(area, 0.7) << "square metres at " << z;
  }
}

TEST(PeopleDetector, PicturesAndDollsAreNoPeople) {
  PeopleDetector detector;
  EXPECT_TRUE(detector.detect(frame_with_person(1.0, 0.3)).empty()) << "a doll";
  PeopleFrame poster = frame_with_person();
  for (int i = 0; i < static_cast<int>(poster.points.total()); ++i)
    poster.points.ptr<cv::Vec3f>()[i][2] = 1.6F;
  EXPECT_TRUE(detector.detect(poster).empty()) << "a poster on a wall";
  PeopleFrame known = frame_with_person();
  known.explained = cv::Mat(known.points.size(), CV_8U, cv::Scalar(255));
  EXPECT_TRUE(detector.detect(known).empty()) << "a statue of the map";
  EXPECT_TRUE(detector.detect(frame_with_person(1.6, 1, false)).empty()) << "a dress form";
  EXPECT_TRUE(detector.detect({}).empty()) << "no image";
}

TEST(PeopleDetector, AnonymisedFacesAreNotFound) {
  PeopleDetector detector;
  for (const double z : {1.0, 1.6, 2.5}) {
    PeopleFrame frame = frame_with_person(z);
    ASSERT_EQ(faces_in(frame.color, detector), 1U) << z;
    const std::vector<Person> people = detector.detect(frame);
    ASSERT_EQ(people.size(), 1U) << z;
    const cv::Point offset(people[0].head.x + 5, 40);
    cv::Mat crop = frame.color(cv::Rect(offset, cv::Size(200, 300))).clone();
    anonymise(frame.color, {people[0].head});
    EXPECT_EQ(faces_in(frame.color, detector), 0U) << z;
    anonymise(crop, {people[0].head}, offset);
    EXPECT_EQ(cv::norm(crop(cv::Rect(20, 80, 20, 20)), frame.color(cv::Rect(offset.x + 20, 120, 20, 20)),
                       cv::NORM_INF) < 60,
              true)
        << "a cut image is blurred at the same place";
  }
}

double overlap(const cv::Rect& a, const cv::Rect& b) {
  const double both = (a & b).area();
  return both / (a.area() + b.area() - both);
}

TEST(PeopleDetector, FindsPedestriansByColourAlone) {
  const std::vector<Pedestrians> marked = marked_pedestrians();
  if (marked.empty()) GTEST_SKIP() << "needs the package opencv-doc";
  ASSERT_EQ(marked.size(), 10U);
  PeopleDetector detector;
  size_t all = 0, found = 0, reported = 0;
  for (const Pedestrians& here : marked) {
    PeopleFrame frame;
    frame.color = here.image;
    const std::vector<Person> people = detector.detect(frame);
    all += here.boxes.size();
    reported += people.size();
    for (const cv::Rect& box : here.boxes)
      found +=
          std::ranges::any_of(people, [&](const Person& person) { return overlap(person.body, box) > 0.4; });
  }
  std::printf("vtest.avi: %zu of %zu people found, %zu reported\n", found, all, reported);
  EXPECT_GE(found * 10, all * 8);
  EXPECT_GE(found * 10, reported * 7) << "at most three of ten are none";
}

}  // namespace
}  // namespace loci::perception
