#include "perception/detection/people_detector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <queue>

#include "mapping/base/load_symbol.h"
#include "perception/detection/lift.h"
#include "perception/detection/people_models.h"

namespace loci::perception {

namespace {

/// Measures of people and of how they look to a depth camera, metres.
constexpr double kHeadWidth = 0.16;  ///< as the cascade frames a face
constexpr double kHeadHeight = 0.24;
constexpr double kHeadRadius = 0.05;            ///< of the middle of a head, which is measured as one surface
constexpr double kHeadDepth = 0.12;             ///< largest difference of depth inside
constexpr double kBesideHead[] = {0.17, 0.24};  ///< air from here on, left, right and above
constexpr double kAir = 0.15;                   ///< what is farther than the head by this much is behind it
constexpr double kChest = 0.38;                 ///< below the middle of the head
constexpr double kChestDepth = 0.35;            ///< largest difference of depth between head and chest
constexpr double kMinHead_z = 0.6, kMaxHead_z = 2.2;  ///< of the middle of a head over the floor
constexpr double kStatures[] = {1.3, 1.5, 1.7, 1.9};  ///< the small ones for cameras that look down
constexpr double kReach = 0.8;                        ///< of arms, from the axis of the body
constexpr double kFlat = 0.85;      ///< cosine to the vertical from which on a surface is a table
constexpr double kShoulders = 0.4;  ///< most of a body is this near to its axis
constexpr double kMinNear = 0.6;
constexpr double kHeadArea = 0.02;                 ///< at least seen of who shows a face, m²
constexpr double kMinArea = 0.18, kMaxArea = 1.5;  ///< of the silhouette, m²

/// Scores. With depth little is left to be mistaken for a person.
constexpr double kBodyScore_depth = 0.25;
constexpr double kBodyScore_color = 0.6;

/// The window of OpenCV's people: 64 × 128 pixels around a body of 96.
const cv::Size kWindow(64, 128);
constexpr double kWindowBody = 96.0;
constexpr double kWindowTop = 16.0;

constexpr int kFacePixels = 28;  ///< a face is looked for at this width
constexpr int kGrid = 4;         ///< pixels of the depth image between places where heads are looked for

double step_of_noise(double z) {
  return 0.03 + 0.006 * z * z;
}

/// A place in the depth image that may show a head.
struct Candidate {
  cv::Point pixel;  ///< middle
  Vector3d centre;  ///< depth camera's frame
};

/// Looks up depths around a pixel by metric offsets.
class DepthLookup {
 public:
  explicit DepthLookup(const PeopleFrame& frame) : frame_(frame) {}

  bool contains(const cv::Point& pixel) const { return cv::Rect({}, frame_.points.size()).contains(pixel); }
  /// NaN = not measured, or outside.
  float at(int u, int v) const {
    if (!contains({u, v})) return std::numeric_limits<float>::quiet_NaN();
    return frame_.points.ptr<cv::Vec3f>(v)[u][2];
  }
  bool explained(int u, int v) const { return !frame_.explained.empty() && frame_.explained.ptr(v)[u] != 0; }

 private:
  const PeopleFrame& frame_;
};

/// Whether there is air left, right and above of a head. What is not measured is air only where nothing
/// behind is measured at all: holes in the depth are common.
bool stands_free(const DepthLookup& depth, int u, int v, double z, double pixels_per_m) {
  int behind = 0, unknown = 0;
  for (const double beside : kBesideHead) {
    const int side = static_cast<int>(std::lround(beside * pixels_per_m));
    const int above = side + static_cast<int>(std::lround((kHeadHeight - kHeadWidth) / 2 * pixels_per_m));
    const int rise = static_cast<int>(std::lround(kHeadRadius * pixels_per_m));
    for (const cv::Point& at : {cv::Point(u - side, v - rise),
                                {u + side, v - rise},
                                {u - side, v + rise},
                                {u + side, v + rise},
                                {u, v - above},
                                {u - side, v - above},
                                {u + side, v - above}}) {
      if (!depth.contains(at)) continue;
      const auto there = static_cast<double>(depth.at(at.x, at.y));
      if (there < z + kAir) return false;
      (std::isnan(there) ? unknown : behind) += 1;
    }
  }
  return behind >= 2 * unknown || behind == 0;
}

/// Whether a pixel is in the middle of what stands out as a head on a body.
bool looks_like_head(const DepthLookup& depth, const PeopleFrame& frame, int u, int v) {
  const auto z = static_cast<double>(depth.at(u, v));
  if (!(z > 0.4) || depth.explained(u, v)) return false;
  const double pixels = frame.camera.depth.fx / z;  // per metre
  const auto px = [&](double metres) { return static_cast<int>(std::lround(metres * pixels)); };
  if (!stands_free(depth, u, v, z, pixels)) return false;
  const int r = px(kHeadRadius);
  for (const auto& [du, dv] : {std::pair{-r, 0}, {r, 0}, {-r, r}, {r, r}, {0, -2 * r}, {0, r}, {0, 2 * r}})
    if (!(std::abs(static_cast<double>(depth.at(u + du, v + dv)) - z) < kHeadDepth)) return false;
  // The chest, unless the image ends above it.
  const int chest = v + px(kChest);
  if (chest >= frame.points.rows) return true;
  int on = 0;
  for (const double side : {-0.12, -0.06, 0.0, 0.06, 0.12}) {
    const int at = u + px(side);
    if (at < 0 || at >= frame.points.cols || depth.explained(at, chest)) continue;
    on += std::abs(static_cast<double>(depth.at(at, chest)) - z) < kChestDepth ? 1 : 0;
  }
  return on >= 3;
}

bool at_height_of_heads(const PeopleFrame& frame, const Vector3d& centre) {
  if (!frame.map_from_camera) return true;
  const double z = (*frame.map_from_camera * centre).z();
  return z > kMinHead_z && z < kMaxHead_z;
}

std::vector<Candidate> head_candidates(const PeopleFrame& frame) {
  const DepthLookup depth(frame);
  cv::Mat found = cv::Mat::zeros(frame.points.rows / kGrid, frame.points.cols / kGrid, CV_8U);
  for (int row = 0; row < found.rows; ++row)
    for (int column = 0; column < found.cols; ++column)
      found.ptr(row)[column] =
          looks_like_head(depth, frame, column * kGrid + kGrid / 2, row * kGrid + kGrid / 2) ? 255 : 0;
  cv::morphologyEx(found, found, cv::MORPH_CLOSE, cv::Mat::ones(5, 5, CV_8U));  // one head, one candidate
  cv::Mat labels, statistics, centroids;
  const int count = cv::connectedComponentsWithStats(found, labels, statistics, centroids);
  std::vector<Candidate> candidates;
  for (int i = 1; i < count; ++i) {
    Candidate candidate;
    candidate.pixel = {static_cast<int>(centroids.at<double>(i, 0) * kGrid) + kGrid / 2,
                       static_cast<int>(centroids.at<double>(i, 1) * kGrid) + kGrid / 2};
    const cv::Vec3f& point = frame.points.at<cv::Vec3f>(candidate.pixel);
    candidate.centre = Vector3d(cv::Vec3d(point).val);
    if (!candidate.centre.allFinite() || !at_height_of_heads(frame, candidate.centre)) continue;
    candidates.push_back(candidate);
  }
  return candidates;
}

/// A region of the image, which may reach beyond it, at a size of `width` columns.
cv::Mat patch(const cv::Mat& image, const cv::Rect2d& region, const cv::Size& size) {
  const double scale = size.width / region.width;
  const cv::Matx23d move(scale, 0, -region.x * scale, 0, size.height / region.height,
                         -region.y * size.height / region.height);
  cv::Mat out;
  const bool smaller = scale < 0.7;
  if (smaller) {  // without aliases
    const cv::Rect inside = cv::Rect(region) & cv::Rect({}, image.size());
    if (inside.size() == cv::Rect(region).size()) {
      cv::resize(image(inside), out, size, 0, 0, cv::INTER_AREA);
      return out;
    }
  }
  cv::warpAffine(image, out, move, size, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return out;
}

/// The depth pixels of a person: what goes on from the head, within reach, but for tables and floor.
std::vector<int> pixels_of(const PeopleFrame& frame, const Candidate& head) {
  const cv::Mat& points = frame.points;
  const Vector3d up = frame.map_from_camera
                          ? Vector3d(frame.map_from_camera->linear().transpose() * Vector3d::UnitZ())
                          : Vector3d(-Vector3d::UnitY());
  const auto point = [&](int u, int v) { return Vector3d(cv::Vec3d(points.ptr<cv::Vec3f>(v)[u]).val); };
  const auto flat = [&](int u, int v) {
    constexpr int kStep = 3;
    if (u < kStep || v < kStep || u + kStep >= points.cols || v + kStep >= points.rows) return false;
    const Vector3d normal = (point(u + kStep, v) - point(u - kStep, v))
                                .cross(point(u, v + kStep) - point(u, v - kStep))
                                .normalized();
    return std::abs(normal.dot(up)) > kFlat;
  };
  cv::Mat seen = cv::Mat::zeros(points.size(), CV_8U);
  std::queue<cv::Point> open({head.pixel});
  seen.at<uint8_t>(head.pixel) = 255;
  std::vector<int> pixels;
  while (!open.empty()) {
    const cv::Point at = open.front();
    open.pop();
    pixels.push_back(at.y * points.cols + at.x);
    const Vector3d here = point(at.x, at.y);
    for (const cv::Point& step : {cv::Point(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
      const cv::Point next = at + step;
      if (!cv::Rect({}, points.size()).contains(next) || seen.at<uint8_t>(next) != 0) continue;
      const Vector3d there = point(next.x, next.y);
      if (!there.allFinite() || std::abs(there.z() - here.z()) > step_of_noise(here.z())) continue;
      if (!frame.explained.empty() && frame.explained.at<uint8_t>(next) != 0) continue;
      const Vector3d from_head = there - head.centre;
      const double above = from_head.dot(up);
      if ((from_head - above * up).norm() > kReach || above > 2 * kHeadHeight) continue;
      if (above < -2 * kHeadHeight && flat(next.x, next.y)) continue;  // shoulders are flat, too
      seen.at<uint8_t>(next) = 255;
      open.push(next);
    }
  }
  std::ranges::sort(pixels);
  return pixels;
}

/// Whether pixels are those of a standing or sitting person by what they measure: a wall fills all of the
/// reach around a head.
bool is_slender(const PeopleFrame& frame, const Candidate& head, const std::vector<int>& pixels,
                double min_area) {
  double area = 0, near = 0;
  for (const int pixel : pixels) {
    const Vector3d point(cv::Vec3d(frame.points.ptr<cv::Vec3f>()[pixel]).val);
    const double here = point.z() * point.z() / (frame.camera.depth.fx * frame.camera.depth.fy);
    area += here;
    if (std::hypot(point.x() - head.centre.x(), point.z() - head.centre.z()) < kShoulders) near += here;
  }
  return area > min_area && area < kMaxArea && near > kMinNear * area;
}

cv::Rect inside(const cv::Rect2d& rect, const cv::Mat& image) {
  return cv::Rect(rect) & cv::Rect({}, image.size());
}

double overlap(const cv::Rect& a, const cv::Rect& b) {
  const double both = (a & b).area();
  return both / std::max(1.0, static_cast<double>(a.area()) + b.area() - both);
}

/// Where the head is in OpenCV's window of a body.
cv::Rect2d head_in(const cv::Rect2d& window) {
  const double x = window.width / kWindow.width, y = window.height / kWindow.height;
  return {window.x + 19 * x, window.y + 10 * y, 26 * x, 28 * y};
}

cv::Rect2d body_in(const cv::Rect2d& window) {
  const double x = window.width / kWindow.width, y = window.height / kWindow.height;
  return {window.x + 12 * x, window.y + 14 * y, 40 * x, 102 * y};
}

/// A face with hair, ears and chin.
cv::Rect2d head_around(const cv::Rect& face) {
  return {face.x - 0.25 * face.width, face.y - 0.35 * face.height, 1.5 * face.width, 1.7 * face.height};
}

}  // namespace

struct PeopleDetector::Models {
  std::unique_ptr<PeopleModels> models;

  Models() {
    using MakeModels = PeopleModels* (*)();
    static const auto make_models = reinterpret_cast<MakeModels>(
        load_symbol("loci_people.so", "loci_make_people_models", "people cannot be found",
                    "install loci_people.so and libopencv-objdetect"));
    models.reset(make_models());
  }

  /// The face at a place where a head of `pixels_per_m` is; of the colour image.
  std::optional<cv::Rect> face_at(const cv::Mat& grey, const Vector2d& centre, double pixels_per_m) {
    constexpr double kSide = 0.56;  // metres around the head
    const double scale = kFacePixels / (kHeadWidth * pixels_per_m);
    const cv::Rect2d region(centre.x() - kSide / 2 * pixels_per_m, centre.y() - kSide / 2 * pixels_per_m,
                            kSide * pixels_per_m, kSide * pixels_per_m);
    const int side = static_cast<int>(std::lround(region.width * scale));
    const std::vector<cv::Rect> faces = models->faces(patch(grey, region, {side, side}), 3, 20, 44);
    if (faces.empty()) return std::nullopt;
    const cv::Rect& best =
        *std::ranges::max_element(faces, {}, [](const cv::Rect& each) { return each.area(); });
    return cv::Rect(cv::Rect2d(region.x + best.x / scale, region.y + best.y / scale, best.width / scale,
                               best.height / scale));
  }

  /// The window of a standing body below a head, with its score.
  std::optional<std::pair<cv::Rect2d, double>> body_at(const cv::Mat& grey, const Vector2d& head,
                                                       double pixels_per_m) {
    std::optional<std::pair<cv::Rect2d, double>> best;
    for (const double stature : kStatures) {
      const double scale = kWindowBody / (stature * pixels_per_m);  // of the window
      const double top = head.y() - kHeadHeight / 2 * pixels_per_m - kWindowTop / scale;
      const cv::Rect2d window(head.x() - kWindow.width / 2.0 / scale, top, kWindow.width / scale,
                              kWindow.height / scale);
      const double visible = std::min<double>(grey.rows, window.y + window.height) - window.y;
      if (visible < 0.85 * window.height) continue;
      // With room to move by a cell.
      const cv::Rect2d wide(window.x - 8 / scale, window.y - 8 / scale, window.width + 16 / scale,
                            window.height + 16 / scale);
      for (const BodyWindow& found :
           models->bodies_at_scale(patch(grey, wide, kWindow + cv::Size(16, 16)), kBodyScore_depth))
        if (!best || found.score > best->second)
          best = {
              {wide.x + found.window.x / scale, wide.y + found.window.y / scale, window.width, window.height},
              found.score};
    }
    return best;
  }

  std::optional<Person> confirm(const PeopleFrame& frame, const cv::Mat& grey, const Candidate& candidate);
  std::vector<Person> search(const PeopleFrame& frame, const cv::Mat& grey);
};

/// Whether the colours agree with the depth that a person is there.
std::optional<Person> PeopleDetector::Models::confirm(const PeopleFrame& frame, const cv::Mat& grey,
                                                      const Candidate& candidate) {
  const Vector3d in_color = frame.camera.depth_from_color.inverse() * candidate.centre;
  if (!(in_color.z() > 0)) return std::nullopt;
  const Vector2d head = frame.camera.color.project(in_color);
  const double pixels_per_m = frame.camera.color.fx / in_color.z();
  Person person;
  if (const std::optional<cv::Rect> face_found = face_at(grey, head, pixels_per_m)) {
    person.has_face = true;
    person.score = 1;
    person.head = person.body = inside(head_around(*face_found), grey);
  } else if (const auto window = body_at(grey, head, pixels_per_m)) {
    person.score = std::min(1.0, window->second / 2);
    person.body = inside(body_in(window->first), grey);
    person.head = inside(cv::Rect2d(head.x() - 0.15 * pixels_per_m, head.y() - 0.2 * pixels_per_m,
                                    0.3 * pixels_per_m, 0.38 * pixels_per_m),
                         grey);
  } else {
    return std::nullopt;
  }
  person.pixels = pixels_of(frame, candidate);
  if (!is_slender(frame, candidate, person.pixels, person.has_face ? kHeadArea : kMinArea))
    return std::nullopt;
  for (const int pixel : person.pixels) {
    const Vector3d point = frame.camera.depth_from_color.inverse() *
                           Vector3d(cv::Vec3d(frame.points.ptr<cv::Vec3f>()[pixel]).val);
    const Vector2d at = frame.camera.color.project(point);
    const cv::Rect one(static_cast<int>(at.x()), static_cast<int>(at.y()), 1, 1);
    person.body |= one & cv::Rect({}, grey.size());
  }
  return person;
}

/// The whole image, without depth.
std::vector<Person> PeopleDetector::Models::search(const PeopleFrame& frame, const cv::Mat& grey) {
  std::vector<Person> people;
  for (const cv::Rect& each : models->faces(grey, 4, 24, std::max(grey.rows, grey.cols))) {
    const cv::Rect head = inside(head_around(each), frame.color);
    people.push_back({head, head, true, 1, {}});
  }
  constexpr double kEnlarged = 1.5;  // people from 64 pixels on
  cv::Mat large;
  cv::resize(grey, large, {}, kEnlarged, kEnlarged);
  if (large.rows < kWindow.height || large.cols < kWindow.width) return people;
  for (const BodyWindow& found : models->bodies(large)) {
    if (found.score < kBodyScore_color) continue;
    const cv::Rect2d window(found.window.x / kEnlarged, found.window.y / kEnlarged,
                            found.window.width / kEnlarged, found.window.height / kEnlarged);
    const cv::Rect head = inside(head_in(window), frame.color);
    const auto same = std::ranges::find_if(people, [&](const Person& person) {
      return person.has_face && (person.head & head).area() * 2 > std::min(person.head.area(), head.area());
    });
    if (same != people.end()) {
      same->body |= inside(body_in(window), frame.color);
      continue;
    }
    people.push_back({inside(body_in(window), frame.color), head, false, std::min(1.0, found.score / 2), {}});
  }
  return people;
}

PeopleDetector::PeopleDetector() : models_(std::make_unique<Models>()) {}
PeopleDetector::~PeopleDetector() = default;
PeopleDetector::PeopleDetector(PeopleDetector&&) noexcept = default;
PeopleDetector& PeopleDetector::operator=(PeopleDetector&&) noexcept = default;

std::vector<Person> PeopleDetector::detect(const PeopleFrame& frame) {
  if (frame.color.empty()) return {};
  cv::Mat grey;
  if (frame.points.empty()) {
    cv::cvtColor(frame.color, grey, cv::COLOR_BGR2GRAY);
    return models_->search(frame, grey);
  }
  const std::vector<Candidate> candidates = head_candidates(frame);
  if (candidates.empty()) return {};
  cv::cvtColor(frame.color, grey, cv::COLOR_BGR2GRAY);
  std::vector<Person> people;
  for (const Candidate& candidate : candidates) {
    std::optional<Person> person = models_->confirm(frame, grey, candidate);
    if (!person) continue;
    const auto same = std::ranges::find_if(
        people, [&](const Person& other) { return overlap(other.head, person->head) > 0.3; });
    if (same == people.end())
      people.push_back(std::move(*person));
    else if (same->score < person->score)
      *same = std::move(*person);
  }
  return people;
}

void anonymise(cv::Mat& image, const std::vector<cv::Rect>& heads, const cv::Point& offset) {
  for (const cv::Rect& head : heads) {
    const cv::Rect region = (head - offset) & cv::Rect({}, image.size());
    if (region.empty()) continue;
    cv::Mat target = image(region);
    cv::Mat coarse;
    cv::resize(target, coarse, {3, 3}, 0, 0, cv::INTER_AREA);
    cv::resize(coarse, target, region.size(), 0, 0, cv::INTER_LINEAR);
  }
}

void anonymise(mapping::RgbdFrame& frame, PeopleDetector& detector) {
  if (frame.color.empty()) return;
  std::vector<cv::Rect> heads;
  for (const Person& person : detector.detect({frame.color,
                                               points_of(frame.depth, frame.camera.depth),
                                               {},
                                               frame.camera,
                                               frame.map_from_camera}))
    heads.push_back(person.head);
  if (heads.empty()) return;
  frame.color = frame.color.clone();  // the recording may hold it
  anonymise(frame.color, heads);
}

}  // namespace loci::perception
