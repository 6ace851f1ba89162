#include "perception/annotators/segmentation/clustering/part_assembly.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/segmentation/clustering/color_contrast.h"
#include "perception/annotators/segmentation/clustering/convex_parts.h"
#include "perception/annotators/segmentation/clustering/object_piece.h"
#include "perception/annotators/structure/supports.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;

class Assembly {
 public:
  Assembly(const ConvexParts& parts, const PlaneCloud& cloud, const AssemblyOptions& options)
      : cloud_(cloud),
        options_(options),
        plane_from_camera_(cloud.camera_from_plane.inverse()),
        sets_(static_cast<size_t>(parts.count)) {
    pieces_.resize(static_cast<size_t>(parts.count));
    alive_.resize(pieces_.size());
    std::iota(alive_.begin(), alive_.end(), size_t{0});
    for (size_t i = 0; i < parts.part_of_point.size(); ++i)
      pieces_[static_cast<size_t>(parts.part_of_point[i])].points.push_back(static_cast<int>(i));
    for (const auto& [pair, count] : parts.contacts) contacts_[pair] = count;
    for (Piece& piece : pieces_) measure_area(piece, cloud_);
  }

  void run() {
    while (join_splinter()) {
    }
    while (join_coplanar()) {
    }
    for (const size_t i : alive_) measure_shape(pieces_[i], cloud_);
    while (join_hollow() || join_cavity() || join_contained() || join_appendage() || join_neck() ||
           join_lid() || join_bent() || join_hidden()) {
    }
  }

  int piece_of(int part) { return static_cast<int>(sets_.find(static_cast<size_t>(part))); }

 private:
  enum class Check { within, before, around, facing_around, behind, hovers, bent, neck };
  /// What was found out about two pieces, which holds until one of them grows.
  template <class Find>
  double remembered(Check check, const Piece& a, const Piece& b, Find&& find) const {
    const auto number = [this](const Piece& piece) { return static_cast<size_t>(&piece - pieces_.data()); };
    const auto [entry, is_new] = found_.try_emplace({check, number(a), number(b)}, 0.0);
    if (is_new) entry->second = static_cast<double>(find());
    return entry->second;
  }

  /// Which share of a piece's points lies within the footprint of another, or nearly so.
  double share_within(const Piece& inner, const Piece& outer) const {
    return remembered(Check::within, inner, outer, [&] { return find_share_within(inner, outer); });
  }
  double find_share_within(const Piece& inner, const Piece& outer) const {
    if (outer.footprint.size() < 3) return 0;
    const double slack = options_.slack_m;
    const size_t stride = std::max<size_t>(1, inner.points.size() / 300);
    int within = 0;
    int count = 0;
    for (size_t k = 0; k < inner.points.size(); k += stride, ++count) {
      const Vector3f& p = cloud_.points[static_cast<size_t>(inner.points[k])];
      if (outer.extent.exteriorDistance(Vector2f(p.head<2>())) > static_cast<float>(slack)) continue;
      within += is_within(outer, p.head<2>(), slack) ? 1 : 0;
    }
    return static_cast<double>(within) / count;
  }

  /// Whether a position lies in a footprint, or nearly so. Only beside a corner the lines of the edges do not
  /// tell.
  static bool is_within(const Piece& piece, const Vector2f& position, double slack) {
    constexpr double kRounding = 1e-6;
    const double inside = piece.outline.inside(position.cast<double>());
    if (inside > kRounding) return true;
    if (inside < -slack - kRounding) return false;
    return cv::pointPolygonTest(piece.footprint, {position.x(), position.y()}, true) > -slack;
  }

  double share_before(const Piece& a, const Piece& b) const {
    return remembered(Check::before, a, b,
                      [&] { return loci::perception::share_before(a, b, cloud_, options_.slack_m); });
  }
  /// Whether a piece that touches another is an object rather than its handle or label: it reaches down to
  /// the support, has another colour, and is as large as the smallest objects.
  bool stands_apart(const Piece& a, const Piece& b) const {
    constexpr double kMinArea = 0.001;  // m², of what is seen
    return static_cast<double>(a.bottom) <= options_.hovering_m && a.area > kMinArea * a.noise &&
           is_other_color(a.lab, b.lab);
  }

  /// Makes two pieces one, of which only the area is known then.
  void merge(size_t a, size_t b) {
    const size_t keep = std::min(a, b);
    const size_t gone = std::max(a, b);
    sets_.join(keep, gone);
    std::erase(alive_, gone);
    std::erase_if(found_, [&](const auto& entry) {
      const auto& [check, first, second] = entry.first;
      return first == keep || first == gone || second == keep || second == gone;
    });
    pieces_[keep].points.insert(pieces_[keep].points.end(), pieces_[gone].points.begin(),
                                pieces_[gone].points.end());
    pieces_[gone].points.clear();
    measure_area(pieces_[keep], cloud_);
    std::map<std::array<int, 2>, int> contacts;
    for (const auto& [pair, count] : contacts_) {
      const int first = piece_of(pair[0]);
      const int second = piece_of(pair[1]);
      if (first != second) contacts[{std::min(first, second), std::max(first, second)}] += count;
    }
    contacts_ = std::move(contacts);
  }

  void join(size_t a, size_t b) {
    merge(a, b);
    measure_shape(pieces_[std::min(a, b)], cloud_);
  }

  int contact(size_t a, size_t b) const {
    const auto it = contacts_.find({static_cast<int>(std::min(a, b)), static_cast<int>(std::max(a, b))});
    return it == contacts_.end() ? 0 : it->second;
  }

  /// The piece that `a` touches most; pieces_.size() = none.
  size_t most_touched(size_t a) const {
    size_t best = pieces_.size();
    int most = 0;
    for (const auto& [pair, count] : contacts_) {
      const auto first = static_cast<size_t>(pair[0]);
      const auto second = static_cast<size_t>(pair[1]);
      if ((first != a && second != a) || count <= most) continue;
      most = count;
      best = first == a ? second : first;
    }
    return best;
  }

  bool join_splinter() {
    size_t smallest = pieces_.size();
    for (const size_t i : alive_) {
      if (pieces_[i].area >= options_.splinter_m2 * pieces_[i].noise) continue;
      if (most_touched(i) == pieces_.size()) continue;
      if (smallest == pieces_.size() || pieces_[i].area < pieces_[smallest].area) smallest = i;
    }
    if (smallest == pieces_.size()) return false;
    merge(smallest, most_touched(smallest));
    return true;
  }

  /// Pieces that touch and lie on one plane as well as the noise lets any plane be measured. Far away the
  /// steps of the disparity part a flat surface.
  bool join_coplanar() {
    for (const auto& [pair, count] : contacts_) {
      const auto first = static_cast<size_t>(pair[0]);
      const auto second = static_cast<size_t>(pair[1]);
      const Piece& a = pieces_[first];
      const Piece& b = pieces_[second];
      const double noise = depth_noise(1.0) * std::max(a.noise, b.noise);
      if (plane_residual(a, b, cloud_) > noise) continue;
      merge(first, second);
      return true;
    }
    return false;
  }

  bool join_contained() {
    for (const size_t inner : alive_) {
      for (const size_t outer : alive_) {
        if (outer == inner || pieces_[outer].area < pieces_[inner].area) continue;
        const Piece& a = pieces_[inner];
        const Piece& b = pieces_[outer];
        const auto slack = static_cast<float>(options_.slack_m);
        if (a.top > b.top + slack || a.bottom < b.bottom - 0.03f) continue;
        if (share_within(a, b) < options_.within || (a.distance < b.distance && stands_apart(a, b))) continue;
        join(inner, outer);
        return true;
      }
    }
    return false;
  }

  /// Share of `inner`'s bearings that lie between those of `outer`.
  double share_between(const Piece& inner, const Piece& outer) const {
    float turn = inner.bearing - outer.bearing;
    if (turn > kPi) turn -= 2 * kPi;
    if (turn < -kPi) turn += 2 * kPi;
    const float slack = static_cast<float>(options_.slack_m) / std::max(0.1f, outer.distance);
    const float low = std::max(inner.left + turn, outer.left - slack);
    const float high = std::min(inner.right + turn, outer.right + slack);
    return static_cast<double>((high - low) / std::max(1e-6f, inner.right - inner.left));
  }

  /// Pieces of one bent rod, such as a banana, whose inner side is concave: both are as high as thick, of one
  /// height and thickness, and meet end to end.
  bool join_bent() {
    for (const auto& [pair, count] : contacts_) {
      const auto first = static_cast<size_t>(pair[0]);
      const auto second = static_cast<size_t>(pair[1]);
      if (!one_bent_rod(pieces_[first], pieces_[second])) continue;
      join(first, second);
      return true;
    }
    return false;
  }

  /// Whether a piece is seen from the side only: of what lies there one sees the upper side, too.
  bool is_wall(const Piece& piece) const {
    constexpr float kSlope = 0.2f;
    size_t sloping = 0;
    for (const int i : piece.points) sloping += cloud_.normals[static_cast<size_t>(i)].z() > kSlope ? 1 : 0;
    return 4 * sloping < piece.points.size();
  }

  bool one_bent_rod(const Piece& a, const Piece& b) const {
    return remembered(Check::bent, a, b, [&] { return find_bent_rod(a, b); }) != 0;
  }
  bool find_bent_rod(const Piece& a, const Piece& b) const {
    const auto slack = static_cast<float>(options_.slack_m);
    if (std::abs(a.top - b.top) > slack || std::abs(a.bottom - b.bottom) > slack) return false;
    constexpr float kMinThickness = 0.45f;  // only the side towards the camera is seen
    const Rod first(a, cloud_), second(b, cloud_);
    if (!first.is_rod() || !second.is_rod() || is_wall(a) || is_wall(b)) return false;
    const auto [thinner, thicker] = std::minmax(first.thickness, second.thickness);
    if (thinner < kMinThickness * thicker) return false;
    constexpr float kMinCosine = 0.5f;  // bent by 60 degrees at most
    if (std::abs(first.along.dot(second.along)) < kMinCosine) return false;
    return first.gap_to(second) < first.thickness + slack;
  }

  /// Pieces of the inside of a round vessel, which concave edges part where it is narrow.
  bool join_hollow() {
    for (const auto& [pair, count] : contacts_) {
      const auto first = static_cast<size_t>(pair[0]);
      const auto second = static_cast<size_t>(pair[1]);
      const Piece& a = pieces_[first];
      const Piece& b = pieces_[second];
      if (a.area < options_.splinter_m2 || b.area < options_.splinter_m2) continue;
      if (std::abs(a.top - b.top) > static_cast<float>(options_.slack_m)) continue;
      if (!around_one_axis(a, b, true)) continue;
      join(first, second);
      return true;
    }
    return false;
  }

  /// Whether the walls of two pieces stand around one upright axis, as a bowl's do: those of `a` face it,
  /// those of `b`, too, or away from it. Walls of boxes that meet in a corner are flat and face past each
  /// other.
  bool around_one_axis(const Piece& a, const Piece& b, bool b_faces_it) const {
    return remembered(b_faces_it ? Check::around : Check::facing_around, a, b,
                      [&] { return find_common_axis(a, b, b_faces_it); }) != 0;
  }
  bool find_common_axis(const Piece& a, const Piece& b, bool b_faces_it) const {
    constexpr float kMinSlope = 0.2f;  // What lies level faces nowhere.
    constexpr float kMinSpread = 0.05f;
    struct Walls {
      std::vector<Vector2f> places, facing;
    };
    std::array<Walls, 2> walls;
    Eigen::Matrix2f across = Eigen::Matrix2f::Zero();
    Vector2f sum = Vector2f::Zero();
    for (const Piece* piece : {&a, &b})
      for (const int i : piece->points) {
        const Vector2f normal = cloud_.normals[static_cast<size_t>(i)].head<2>();
        if (!(normal.norm() > kMinSlope)) continue;
        auto& [places, facing] = walls[piece == &b ? 1 : 0];
        facing.push_back((piece == &b && !b_faces_it ? -1 : 1) * normal.normalized());
        places.push_back(cloud_.points[static_cast<size_t>(i)].head<2>());
        const Eigen::Matrix2f beside =
            Eigen::Matrix2f::Identity() - facing.back() * facing.back().transpose();
        across += beside;
        sum += beside * places.back();
      }
    if (2 * (walls[0].places.size() + walls[1].places.size()) < a.points.size() + b.points.size())
      return false;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2f> solver(across);
    if (solver.eigenvalues()[0] < kMinSpread * solver.eigenvalues()[1]) return false;
    const Vector2f axis = across.ldlt().solve(sum);
    std::vector<float> past, ahead;
    std::array<float, 2> radii{};
    for (size_t k = 0; k < walls.size(); ++k) {
      const auto& [places, facing] = walls[k];
      if (places.empty()) return false;
      std::vector<float> distances;
      for (size_t i = 0; i < places.size(); ++i) {
        const Vector2f to = axis - places[i];
        distances.push_back(to.norm());
        ahead.push_back(facing[i].dot(to));
        past.push_back(std::abs(facing[i].x() * to.y() - facing[i].y() * to.x()));
      }
      radii[k] = median(distances);
    }
    // A few points far behind do not count among those of a large wall.
    constexpr float kMaxRatio = 3;
    if (std::max(radii[0], radii[1]) > kMaxRatio * std::min(radii[0], radii[1])) return false;
    const float radius = median(ahead);
    return quantile(ahead, 0.1) > 0 &&
           median(past) < std::min(0.25f * radius, static_cast<float>(options_.slack_m));
  }

  /// The inside of a vessel with the wall before it.
  bool join_cavity() {
    const auto slack = static_cast<float>(options_.slack_m);
    for (const size_t inner : alive_) {
      const Piece& a = pieces_[inner];
      if (a.facing_out > -0.1f || a.area < options_.splinter_m2) continue;
      size_t best = pieces_.size();
      for (const size_t outer : alive_) {
        const Piece& b = pieces_[outer];
        if (outer == inner || b.facing_out < 0 || b.area < options_.splinter_m2) continue;
        const float width = std::max(0.1f, (b.right - b.left) * b.distance);
        if (std::abs(a.top - b.top) > slack || a.distance < b.distance) continue;
        if (a.distance > b.distance + width && !around_one_axis(a, b, false)) continue;
        if (share_between(a, b) < options_.within) continue;
        if (best == pieces_.size() || b.distance > pieces_[best].distance) best = outer;
      }
      if (best == pieces_.size()) continue;
      join(inner, best);
      return true;
    }
    return false;
  }

  /// Whether `a` stands on top of `b`.
  bool on_top(const Piece& a, const Piece& b) const {
    return a.bottom > b.bottom + 0.02f && a.top > b.top + 0.02f && share_within(a, b) > 0.6;
  }

  /// The nearest piece that is larger than `a`; pieces_.size() = none within `reach`.
  size_t nearest_host(size_t a, double reach) {
    size_t best = pieces_.size();
    for (const size_t i : alive_) {
      if (i == a || pieces_[a].area > options_.appendage * pieces_[i].area) continue;
      const double distance = gap(pieces_[a], pieces_[i], reach);
      if (distance > reach) continue;
      reach = distance;
      best = i;
    }
    return best;
  }

  /// Whether a piece ends above the support and empty space is seen below it.
  bool hovers(const Piece& piece) const {
    return remembered(Check::hovers, piece, piece, [&] { return find_hovering(piece); }) != 0;
  }
  bool find_hovering(const Piece& piece) const {
    if (static_cast<double>(piece.bottom) <= options_.hovering_m) return false;
    int free = 0;
    int known = 0;
    const size_t stride = std::max<size_t>(1, piece.points.size() / 400);
    for (size_t k = 0; k < piece.points.size(); k += stride) {
      Vector3f p = cloud_.points[static_cast<size_t>(piece.points[k])];
      if (p.z() > piece.bottom + 0.3f * (piece.top - piece.bottom)) continue;
      p.z() = 0.5f * piece.bottom;
      const Space space = space_at(p);
      known += space == Space::unknown ? 0 : 1;
      free += space == Space::free ? 1 : 0;
    }
    return free > 0.5 * known;
  }

  /// Handles and other small parts that do not stand by themselves.
  bool join_appendage() {
    for (const size_t i : alive_) {
      if (pieces_[i].points.size() < 20) continue;
      const Piece& a = pieces_[i];
      const bool hovering = hovers(a);
      const bool small = a.area < (hovering ? 0.003 : 0.0015) * a.noise;
      size_t host = most_touched(i);
      if (host == pieces_.size() && small) host = nearest_host(i, options_.slack_m * 1.5);
      if (host == pieces_.size()) continue;
      const Piece& b = pieces_[host];
      // What runs along an object of the same height is its other side, and may be larger.
      const bool alongside = std::abs(a.top - b.top) < static_cast<float>(options_.slack_m) &&
                             contact(i, host) > 0.25 * static_cast<double>(a.points.size());
      if (a.area > (alongside ? 2 : 1) * options_.appendage * b.area || on_top(a, b)) continue;
      const bool tiny = a.area < 0.12 * b.area || a.area < 0.0014 * a.noise;
      if (!hovering && (!tiny || stands_apart(a, b))) continue;
      if (contact(i, host) == 0 && a.top > b.top + static_cast<float>(options_.slack_m)) continue;
      join(i, host);
      return true;
    }
    return false;
  }

  /// A neck or a cap: narrow, in the middle above what tapers towards it, or slender; or the knob of a lid,
  /// narrow and low. What merely stands on something stands on a top that is as wide as the rest.
  bool join_neck() {
    for (const auto& [pair, count] : contacts_) {
      auto upper = static_cast<size_t>(pair[0]);
      auto lower = static_cast<size_t>(pair[1]);
      if (pieces_[upper].top < pieces_[lower].top) std::swap(upper, lower);
      const Piece& a = pieces_[upper];
      const Piece& b = pieces_[lower];
      if (!on_top(a, b) || a.bottom < 0.5f * (b.bottom + b.top) || a.area > b.area) continue;
      if (!is_neck(a, b)) continue;
      join(upper, lower);
      return true;
    }
    return false;
  }

  bool is_neck(const Piece& neck, const Piece& body) const {
    return remembered(Check::neck, neck, body, [&] { return find_neck(neck, body); }) != 0;
  }
  bool find_neck(const Piece& neck, const Piece& body) const {
    const auto band = [&](const Piece& piece, float low) {
      return outline_band(cloud_.points, piece.points, cloud_.viewpoint, low, piece.top + 0.05f);
    };
    const OutlineBand a = band(neck, neck.bottom - 0.05f);
    const OutlineBand b = band(body, body.bottom - 0.05f);
    const OutlineBand shoulder = band(body, body.top - static_cast<float>(options_.slack_m));
    if (a.width > static_cast<float>(options_.neck_m) || shoulder.points < 5) return false;
    const bool tapers = shoulder.width < 0.8f * b.width && shoulder.width < 1.75f * a.width;
    constexpr float kSlender = 1.5f;  // what is so slender does not stand by itself
    constexpr float kKnob = 0.03f;    // m, of height at most
    const float height = neck.top - neck.bottom;
    if (!tapers && height < kSlender * a.width && height > kKnob) return false;
    const Vector2f apart = a.middle - b.middle;
    const auto slack = static_cast<float>(options_.slack_m);
    if (std::abs(b.across.dot(apart)) > 0.8f * slack) return false;
    // Only the fronts are seen, and that of a neck lies as far back as the body is thicker.
    const float back = b.across.x() * apart.y() - b.across.y() * apart.x();
    return std::abs(back) < 0.5f * (b.width - a.width) + slack;
  }

  /// A lid reaches over the body below it: what hovers must stand on something, and a small strip right under
  /// it that does not reach out from under it is no object of its own.
  bool join_lid() {
    for (const size_t lid : alive_) {
      if (static_cast<double>(pieces_[lid].bottom) <= options_.hovering_m) continue;
      for (const size_t body : alive_) {
        const Piece& a = pieces_[body];
        const Piece& b = pieces_[lid];
        if (body == lid || contact(body, lid) == 0) continue;
        if (a.area > 0.35 * b.area || a.top > b.bottom + 0.03f || a.bottom > b.bottom) continue;
        if (share_within(a, b) < options_.within) continue;
        if (share_between(b, a) < 0.6) continue;
        join(body, lid);
        return true;
      }
    }
    return false;
  }

  enum class Space { free, taken, hidden, unknown };

  /// What the image says about a position in the plane's frame.
  Space space_at(const Vector3f& position) const {
    const Vector3d p = cloud_.camera_from_plane * position.cast<double>();
    if (p.z() <= 0.1) return Space::unknown;
    const Vector2d pixel = cloud_.camera.project(p);
    if (!cloud_.camera.contains(pixel)) return Space::unknown;
    const float z = cloud_.image_points.at<cv::Vec3f>(static_cast<int>(std::lround(pixel.y())),
                                                      static_cast<int>(std::lround(pixel.x())))[2];
    if (std::isnan(z)) return Space::unknown;
    const double behind = p.z() - static_cast<double>(z);
    return behind < -0.012 ? Space::free : behind > 0.03 ? Space::hidden : Space::taken;
  }

  /// Whether what is measured before a position, in the image, belongs to one of two pieces.
  bool hidden_by(const Piece& a, const Piece& b, const Vector3f& position) const {
    const Vector2d pixel = cloud_.camera.project(cloud_.camera_from_plane * position.cast<double>());
    const cv::Vec3f& measured = cloud_.image_points.at<cv::Vec3f>(static_cast<int>(std::lround(pixel.y())),
                                                                  static_cast<int>(std::lround(pixel.x())));
    const Vector3f at = (plane_from_camera_ * to_vector(measured)).cast<float>();
    const auto covers = [&](const Piece& piece) {
      return at.z() < piece.top + static_cast<float>(options_.slack_m) &&
             cv::pointPolygonTest(piece.footprint, {at.x(), at.y()}, true) > -options_.slack_m;
    };
    return covers(a) || covers(b);
  }

  /// Whether the convex completion of two pieces is nowhere seen to be empty, and hidden in between by
  /// something else: whatever stands before something of its own height hides what is between them.
  bool one_behind_something(const Piece& a, const Piece& b) const {
    return remembered(Check::behind, a, b, [&] { return find_hidden_middle(a, b); }) != 0;
  }
  bool find_hidden_middle(const Piece& a, const Piece& b) const {
    constexpr double kMaxBefore = 0.15;  // handles, and errors of normals
    if (share_before(a, b) > kMaxBefore || share_before(b, a) > kMaxBefore) return false;
    std::vector<cv::Point2f> both = a.footprint;
    both.insert(both.end(), b.footprint.begin(), b.footprint.end());
    std::vector<cv::Point2f> hull;
    cv::convexHull(both, hull);
    const double own = cv::contourArea(a.footprint) + cv::contourArea(b.footprint);
    if (cv::contourArea(hull) > 3 * own) return false;
    Vector2f low = Vector2f::Constant(1e9f);
    Vector2f high = Vector2f::Constant(-1e9f);
    for (const cv::Point2f& p : hull) {
      low = low.cwiseMin(Vector2f(p.x, p.y));
      high = high.cwiseMax(Vector2f(p.x, p.y));
    }
    int free = 0;
    int hidden = 0;
    int known = 0;
    for (float x = low.x(); x <= high.x(); x += 0.008f)
      for (float y = low.y(); y <= high.y(); y += 0.008f) {
        if (cv::pointPolygonTest(hull, {x, y}, true) < 0.008) continue;
        if (cv::pointPolygonTest(a.footprint, {x, y}, false) > 0) continue;
        if (cv::pointPolygonTest(b.footprint, {x, y}, false) > 0) continue;
        for (const float part : {0.5f, 0.85f}) {
          const Vector3f position(x, y, part * std::min(a.top, b.top));
          const Space space = space_at(position);
          if (space == Space::hidden && hidden_by(a, b, position)) continue;
          known += space == Space::unknown ? 0 : 1;
          free += space == Space::free ? 1 : 0;
          hidden += space == Space::hidden ? 1 : 0;
        }
      }
    return hidden > 0.3 * known && free < 0.2 * known;
  }

  /// Distance of two footprints; anything above `most` when it is larger.
  double gap(const Piece& a, const Piece& b, double most) const {
    double least = 1e9;
    if (static_cast<double>(a.extent.exteriorDistance(b.extent)) > most) return least;
    for (const cv::Point2f& p : a.footprint)
      least = std::min(least, -cv::pointPolygonTest(b.footprint, p, true));
    for (const cv::Point2f& p : b.footprint)
      least = std::min(least, -cv::pointPolygonTest(a.footprint, p, true));
    return least;
  }

  bool join_hidden() {
    constexpr float kMaxStep = 0.006f;  // two objects of nearly one height are as frequent as one half hidden
    for (const size_t i : alive_) {
      if (pieces_[i].area < options_.splinter_m2) continue;
      for (const size_t k : alive_) {
        if (k <= i || pieces_[k].area < options_.splinter_m2 || contact(i, k) > 0) continue;
        if (std::abs(pieces_[i].top - pieces_[k].top) > kMaxStep) continue;
        if (gap(pieces_[i], pieces_[k], options_.hidden_gap_m) > options_.hidden_gap_m) continue;
        if (!one_behind_something(pieces_[i], pieces_[k])) continue;
        join(i, k);
        return true;
      }
    }
    return false;
  }

  const PlaneCloud& cloud_;
  const AssemblyOptions& options_;
  const Isometry3d plane_from_camera_;
  DisjointSets sets_;
  std::vector<Piece> pieces_;
  std::vector<size_t> alive_;  ///< those that have not become part of another one, ascending
  std::map<std::array<int, 2>, int> contacts_;
  mutable std::map<std::tuple<Check, size_t, size_t>, double> found_;
};

}  // namespace

void AssemblyOptions::declare(OptionTable& table) {
  table.number("splinter_m2", splinter_m2, "m2",
               "Maximum area of splinters, which are merged into the neighbour with the longest contact.", 0,
               0.1);
  table.number("within", within, "",
               "Minimum share of a part inside the footprint of another part for both to be one object.", 0,
               1);
  table.number("slack_m", slack_m, "m", "Tolerance of that footprint.", 0, 0.2);
  table.number("appendage", appendage, "", "Maximum size of a handle relative to its object.", 0, 1);
  table.number("hovering_m", hovering_m, "m",
               "Parts whose lowest point is higher do not stand on the support.", 0, 0.5);
  table.number("hidden_gap_m", hidden_gap_m, "m",
               "Maximum hidden gap between two parts of the same height of one object.", 0, 1);
  table.number("neck_m", neck_m, "m", "Maximum width of a neck or cap above a tapering body.", 0, 0.3);
}

std::vector<int> assemble_parts(const ConvexParts& parts, const PlaneCloud& cloud,
                                const AssemblyOptions& options, int& count) {
  Assembly assembly(parts, cloud, options);
  assembly.run();
  std::vector<int> number(static_cast<size_t>(parts.count), -1);
  std::vector<int> object_of_part(static_cast<size_t>(parts.count));
  count = 0;
  for (int part = 0; part < parts.count; ++part) {
    int& n = number[static_cast<size_t>(assembly.piece_of(part))];
    if (n < 0) n = count++;
    object_of_part[static_cast<size_t>(part)] = n;
  }
  return object_of_part;
}

}  // namespace loci::perception
