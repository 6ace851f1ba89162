#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/videoio.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace loci {

/// A frame of OpenCV's vtest.avi (package opencv-doc) with its people.
struct Pedestrians {
  cv::Mat image;
  std::vector<cv::Rect> boxes;
};

/// Ten frames with people that were marked by hand: at least 50 pixels high and half visible. Empty without
/// the video.
inline std::vector<Pedestrians> marked_pedestrians() {
  const std::filesystem::path video = "/usr/share/doc/opencv-doc/examples/data/vtest.avi";
  std::vector<Pedestrians> marked;
  if (!std::filesystem::exists(video)) return marked;
  std::map<int, std::vector<cv::Rect>> boxes;
  std::ifstream file(std::filesystem::path(LOCI_SOURCE_DIR) / "tests/data/people/vtest.csv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream values(line);
    int frame = 0;
    cv::Rect box;
    values >> frame >> box.x >> box.y >> box.width >> box.height;
    boxes[frame].push_back(box);
  }
  cv::VideoCapture capture(video.string());
  cv::Mat image;
  for (int index = 0; capture.read(image); ++index)
    if (const auto here = boxes.find(index); here != boxes.end())
      marked.push_back({image.clone(), here->second});
  return marked;
}

}  // namespace loci
