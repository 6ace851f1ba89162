#include "apps/evaluate/description/distractors.h"

#include <fmt/format.h>

#include <opencv2/imgproc.hpp>

#include "mapping/image/image_io.h"

namespace loci::apps::description_evaluation {
namespace {

constexpr int kSide = 198;

int any_int(Random& random, int low, int high) {
  return low + static_cast<int>(random.index(static_cast<uint64_t>(high - low + 1)));
}

cv::Scalar any_color(Random& random) {
  return {random.uniform(0, 255), random.uniform(0, 255), random.uniform(0, 255)};
}

cv::Point any_point(Random& random) {
  return {any_int(random, 0, kSide), any_int(random, 0, kSide)};
}

std::string any_word(Random& random, int least, int most) {
  std::string word(static_cast<size_t>(any_int(random, least, most)), ' ');
  const char first = random.uniform() < 0.5 ? 'a' : 'A';
  for (char& letter : word) letter = static_cast<char>(first + any_int(random, 0, 25));
  return word;
}

void draw_shapes(cv::Mat& image, Random& random) {
  for (int i = any_int(random, 3, 8); i > 0; --i) {
    const cv::Size size(any_int(random, 4, 60), any_int(random, 4, 60));
    if (random.uniform() < 0.5) {
      cv::ellipse(image, any_point(random), size, random.uniform(0, 180), 0, 360, any_color(random),
                  cv::FILLED, cv::LINE_AA);
      continue;
    }
    std::vector<cv::Point> corners;
    const cv::Point centre = any_point(random);
    for (int k = any_int(random, 3, 7); k > 0; --k)
      corners.push_back(centre + cv::Point(any_int(random, -size.width, size.width),
                                           any_int(random, -size.height, size.height)));
    cv::fillPoly(image, std::vector<std::vector<cv::Point>>{corners}, any_color(random), cv::LINE_AA);
  }
}

void draw_words(cv::Mat& image, Random& random, double scale, int thickness, int least, int most) {
  const int font = any_int(random, 0, 7);
  cv::putText(image, any_word(random, least, most),
              {any_int(random, 2, kSide / 3), any_int(random, 15, kSide - 4)}, font, scale, any_color(random),
              thickness, cv::LINE_AA);
}

}  // namespace

cv::Mat invented_package(Random random) {
  cv::Mat image(kSide, kSide, CV_8UC3, any_color(random));
  draw_shapes(image, random);
  for (int i = any_int(random, 1, 3); i > 0; --i)
    draw_words(image, random, random.uniform(0.8, 2), any_int(random, 2, 4), 3, 8);
  for (int i = any_int(random, 2, 8); i > 0; --i)
    draw_words(image, random, random.uniform(0.3, 0.5), 1, 8, 24);
  return image;
}

std::vector<perception::Product> invent_products(int count, const std::filesystem::path& folder) {
  std::vector<perception::Product> products;
  const Random random(1);
  for (int i = 0; i < count; ++i) {
    const std::filesystem::path path = folder / fmt::format("invented_{}.png", i);
    mapping::write_image(path, invented_package(random.fork(static_cast<uint64_t>(i))));
    products.push_back({fmt::format("invented {}", i), {}, path});
  }
  return products;
}

}  // namespace loci::apps::description_evaluation
