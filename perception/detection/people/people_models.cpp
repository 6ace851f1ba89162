#include "perception/detection/people_models.h"

#include <opencv2/objdetect.hpp>
#include <string>

#include "mapping/base/error.h"

namespace loci::perception {

std::string_view frontal_face_cascade();  // face_cascade.cpp, made from OpenCV's file

namespace {

class OpenCvPeopleModels : public PeopleModels {
 public:
  OpenCvPeopleModels() {
    const cv::FileStorage file(std::string(frontal_face_cascade()),
                               cv::FileStorage::READ | cv::FileStorage::MEMORY);
    if (!face_.read(file.getFirstTopLevelNode())) throw Error("OpenCV cannot read its own cascade of faces");
    body_.setSVMDetector(cv::HOGDescriptor::getDefaultPeopleDetector());
  }

  std::vector<cv::Rect> faces(const cv::Mat& grey, int min_neighbours, int min_size, int max_size) override {
    std::vector<cv::Rect> faces;
    face_.detectMultiScale(grey, faces, 1.1, min_neighbours, 0, {min_size, min_size}, {max_size, max_size});
    return faces;
  }

  std::vector<BodyWindow> bodies_at_scale(const cv::Mat& grey, double min_score) override {
    std::vector<cv::Point> corners;
    std::vector<double> scores;
    body_.detect(grey, corners, scores, min_score, {8, 8});
    std::vector<BodyWindow> windows;
    for (size_t i = 0; i < corners.size(); ++i) windows.push_back({{corners[i], body_.winSize}, scores[i]});
    return windows;
  }

  std::vector<BodyWindow> bodies(const cv::Mat& grey) override {
    std::vector<cv::Rect> found;
    std::vector<double> scores;
    body_.detectMultiScale(grey, found, scores, 0, {8, 8}, {16, 16}, 1.05, 2);
    std::vector<BodyWindow> windows;
    for (size_t i = 0; i < found.size(); ++i) windows.push_back({found[i], scores[i]});
    return windows;
  }

 private:
  cv::CascadeClassifier face_;
  cv::HOGDescriptor body_;
};

}  // namespace
}  // namespace loci::perception

extern "C" loci::perception::PeopleModels* loci_make_people_models() {
  return new loci::perception::OpenCvPeopleModels();
}
