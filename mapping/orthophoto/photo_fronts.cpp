#include "mapping/orthophoto/photo_fronts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "mapping/articulation/articulation.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"
#include "mapping/interpretation/fronts/ribs.h"
#include "mapping/orthophoto/bars.h"
#include "mapping/orthophoto/knobs.h"
#include "mapping/orthophoto/lines.h"
#include "mapping/orthophoto/parameters.h"

namespace loci::mapping {
namespace {

enum Side : size_t { left, right, bottom, top };
constexpr std::array<const char*, 4> kSideNames = {"left", "right", "bottom", "top"};

struct Edge {
  std::string kind = "border";  ///< border, seam, step, outline, regular
  double z = 0;
};

/// A part of the orthophoto; columns [x0, x1), rows [y0, y1).
struct Part {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  std::array<Edge, 4> edges;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  cv::Rect rect() const { return {x0, y0, width(), height()}; }
};

/// Pixels of bars that certainly stand before the face: a row of handles would look like a level seam.
cv::Mat hidden(const Orthophoto& photo, const std::vector<FaceFixture>& bars) {
  cv::Mat mask(photo.color.size(), CV_8U, cv::Scalar(0));
  for (const FaceFixture& bar : bars) {
    const Json& evidence = bar.fixture.evidence;
    if (evidence.contains("relief_m") &&
        evidence.at("relief_m").get<double>() <
            kPhotoFronts.hidden_sigmas * evidence.at("relief_sd_m").get<double>())
      continue;  // it may be a seam
    const FaceRect box = bar.box.grown(kPhotoFronts.hidden_m);
    cv::rectangle(mask, cv::Point2d(photo.column(box.u0), photo.row(box.v1)),
                  cv::Point2d(photo.column(box.u1), photo.row(box.v0)), 255, cv::FILLED);
  }
  return mask;
}

/// The bars of the image, and fixtures that are known otherwise in place of those at the same spot.
std::vector<FaceFixture> all_bars(const Orthophoto& photo, const std::vector<Fixture>& known) {
  std::vector<FaceFixture> bars;
  for (const Fixture& fixture : known) {
    FaceFixture bar;
    bar.fixture = fixture;
    const Vector2d at = photo.seen_at(fixture.centre);
    bar.u = at.x();
    bar.v = at.y();
    Vector2d half(fixture.radius, fixture.radius);
    if (fixture.kind == Fixture::Kind::handle)
      half[std::abs(fixture.axis.z()) > 0.7 ? 1 : 0] = fixture.length / 2;
    bar.box = {bar.u - half.x(), bar.u + half.x(), bar.v - half.y(), bar.v + half.y()};
    bars.push_back(std::move(bar));
  }
  const size_t count = bars.size();
  for (FaceFixture& bar : find_bars(photo)) {
    const double smear = kBars.smear_sigmas * bar.fixture.evidence.value("position_sd_m", 0.0);
    const auto same = [&](const FaceFixture& other) {
      return other.box.grown(kBars.same_bar_m + smear).intersects(bar.box);
    };
    if (std::none_of(bars.begin(), bars.begin() + static_cast<std::ptrdiff_t>(count), same))
      bars.push_back(std::move(bar));
  }
  const std::vector<FaceFixture> knobs = find_knobs(photo, bars);
  bars.insert(bars.end(), knobs.begin(), knobs.end());
  return bars;
}

class PhotoLayout {
 public:
  PhotoLayout(const Orthophoto& photo, std::vector<FaceFixture> bars)
      : photo_(photo),
        bars_(std::move(bars)),
        lines_(photo, hidden(photo, bars_)),
        min_side_(px(kPhotoFronts.min_side_m)) {
    known_ = (photo.relief == photo.relief) & (photo.weight > 0);
    face_ = (cv::abs(photo.relief) < kBars.face_relief_m) & known_;
    open_ = cv::abs(photo.relief) >= kBars.face_relief_m;
    cv::integral(face_ / 255, face_sums_, CV_32S);
    for (FaceFixture& bar : bars_) move_to_its_place(bar);
  }

  std::vector<Front> run() {
    Part whole;
    whole.x1 = photo_.width();
    whole.y1 = photo_.height();
    shrink(whole);
    if (whole.width() <= min_side_ || whole.height() <= min_side_) return {};
    Layout layout = best_layout(whole, 0);
    if (layout.fronts.size() == 1 && !may_stand_alone(layout.parts.front())) return {};
    add_bare(layout);
    return std::move(layout.fronts);
  }

 private:
  int px(double metres) const { return static_cast<int>(std::lround(metres / photo_.pixel_m)); }

  /// From where the images show a fixture, from the side maybe, to the place of its front before which it
  /// stands.
  void move_to_its_place(FaceFixture& bar) const {
    const Vector2d stands = photo_.stands_at(bar.fixture.centre), shift = stands - Vector2d(bar.u, bar.v);
    bar.u = stands.x();
    bar.v = stands.y();
    const auto moved = [](double& low, double& high, double by) {
      const double unsure = std::min(kPhotoFronts.unsure_shift * std::abs(by), (high - low) / 2);
      low += by + unsure;
      high += by - unsure;
    };
    moved(bar.box.u0, bar.box.u1, shift.x());
    moved(bar.box.v0, bar.box.v1, shift.y());
  }

  /// Trims rows and columns at the border that are not of the face.
  void shrink(Part& part) const {
    const auto share = [&](int x0, int y0, int w, int h) {
      const cv::Rect strip(x0, y0, w, h);
      const int known = cv::countNonZero(known_(strip));
      if (known < kPhotoFronts.min_known * w * h) return 0.0;
      return static_cast<double>(cv::countNonZero(face_(strip))) / known;
    };
    for (int round = 0; round < 2; ++round) {
      while (part.width() > 1 && share(part.x0, part.y0, 1, part.height()) < kPhotoFronts.min_face) ++part.x0;
      while (part.width() > 1 && share(part.x1 - 1, part.y0, 1, part.height()) < kPhotoFronts.min_face)
        --part.x1;
      while (part.height() > 1 && share(part.x0, part.y0, part.width(), 1) < kPhotoFronts.min_face) ++part.y0;
      while (part.height() > 1 && share(part.x0, part.y1 - 1, part.width(), 1) < kPhotoFronts.min_face)
        --part.y1;
    }
    const int reach = px(kPhotoFronts.outline_m);
    mark_outline(part, left, {part.x0 - reach, part.y0, reach, part.height()});
    mark_outline(part, right, {part.x1, part.y0, reach, part.height()});
    mark_outline(part, top, {part.x0, part.y0 - reach, part.width(), reach});
    mark_outline(part, bottom, {part.x0, part.y1, part.width(), reach});
  }

  /// The end of the face is an edge where another surface shows beyond it.
  void mark_outline(Part& part, Side side, const cv::Rect& beyond) const {
    const cv::Rect inside = beyond & cv::Rect({}, open_.size());
    if (part.edges[side].kind == "border" && !inside.empty() &&
        cv::countNonZero(open_(inside)) > kPhotoFronts.outline_open * beyond.area())
      part.edges[side] = {"outline", 0};
  }

  struct Layout {
    double value = 0;
    std::vector<Front> fronts;
    std::vector<Part> parts;  ///< of the fronts
    std::vector<Part> bare;   ///< parts with edges on all sides, without a bar
    void append(const Layout& other) {
      value += other.value;
      fronts.insert(fronts.end(), other.fronts.begin(), other.fronts.end());
      parts.insert(parts.end(), other.parts.begin(), other.parts.end());
      bare.insert(bare.end(), other.bare.begin(), other.bare.end());
    }
  };

  /// Backs of chairs, boxes and sides of furniture have ends, but hardly lines, and now and then a bar before
  /// them.
  bool may_stand_alone(const Part& part) const {
    const auto lines = std::count_if(part.edges.begin(), part.edges.end(), [](const Edge& edge) {
      return edge.kind == "seam" || edge.kind == "step";
    });
    return photo_.face.area > kPhotoFronts.min_lone_area_m2 && lines >= kPhotoFronts.min_resolved;
  }

  /// Bare parts beside a front with a bar are fronts, too: some open by a push.
  void add_bare(Layout& layout) const {
    for (const Part& part : layout.bare)
      if (std::any_of(layout.parts.begin(), layout.parts.end(),
                      [&](const Part& other) { return are_neighbours(part, other); }))
        layout.fronts.push_back(front_of(part, nullptr));
  }

  bool are_neighbours(const Part& a, const Part& b) const {
    const int gap = px(kPhotoFronts.neighbour_m);
    const auto overlap = [](int a0, int a1, int b0, int b1) { return std::min(a1, b1) - std::max(a0, b0); };
    const int across = overlap(a.x0, a.x1, b.x0, b.x1), down = overlap(a.y0, a.y1, b.y0, b.y1);
    const auto beside = [&](int apart, int shared, int shorter) {
      return std::abs(apart) <= gap && shared > kPhotoFronts.min_shared * shorter;
    };
    return beside(across, down, std::min(a.height(), b.height())) ||
           beside(down, across, std::min(a.width(), b.width()));
  }

  struct Cut {
    bool along_u = true;
    int position = 0;
    Edge edge;
    double cost = 0;
  };

  static Edge edge_of(const PhotoLine& line) {
    return {line.kind == PhotoLine::Kind::seam ? "seam" : "step", line.z};
  }

  double face_share(const cv::Rect& rect) const {
    const auto sum = [&](int x, int y) { return face_sums_.at<int>(y, x); };
    const int inside = sum(rect.x + rect.width, rect.y + rect.height) - sum(rect.x, rect.y + rect.height) -
                       sum(rect.x + rect.width, rect.y) + sum(rect.x, rect.y);
    return static_cast<double>(inside) / rect.area();
  }

  /// The cut where the extent of the face changes most, as beside tall furniture.
  void add_outline_cut(const Part& part, std::vector<Cut>& cuts) const {
    constexpr int kStep = 3;  // Pixels along the cut.
    const int window = px(kPhotoFronts.outline_window_m);
    for (const bool along_u : {true, false}) {
      const int first = along_u ? part.x0 : part.y0, last = along_u ? part.x1 : part.y1;
      const int from = along_u ? part.y0 : part.x0, to = along_u ? part.y1 : part.x1;
      double most = 0;
      int position = 0;
      for (int at = first + window; at <= last - window; ++at) {
        double changed = 0;
        for (int along = from; along + kStep <= to; along += kStep) {
          const auto share = [&](int start) {
            return face_share(along_u ? cv::Rect(start, along, window, kStep)
                                      : cv::Rect(along, start, kStep, window));
          };
          const double change = std::abs(share(at - window) - share(at));
          if (change > kPhotoFronts.outline_share) changed += change;
        }
        if (changed > most) most = changed, position = at;
      }
      if (most * kStep * photo_.pixel_m > kPhotoFronts.min_outline_step_m)
        cuts.push_back({along_u, position, {"outline", 0}, 0});
    }
  }

  /// Cuts between bars that belong to different fronts: at the strongest line between them, however weak, or
  /// in the middle between bars side by side.
  void add_cuts_between_bars(const Part& part, std::vector<Cut>& cuts) const {
    std::vector<const FaceFixture*> bars;
    const FaceRect rect = rect_of(part);
    for (const FaceFixture& bar : bars_)
      if (rect.contains(bar.u, bar.v)) bars.push_back(&bar);
    if (bars.size() < 2 || bars.size() > 12) return;
    for (const bool along_u : {true, false}) {
      std::sort(bars.begin(), bars.end(), [&](const FaceFixture* a, const FaceFixture* b) {
        return along_u ? a->u < b->u : a->v < b->v;
      });
      for (size_t i = 1; i < bars.size(); ++i) {
        const double low = bars[i - 1]->box.high(along_u), high = bars[i]->box.low(along_u);
        if (high - low < kPhotoFronts.min_between_m) continue;
        const int first = static_cast<int>(std::lround(along_u ? photo_.column(low) : photo_.row(high)));
        const int last = static_cast<int>(std::lround(along_u ? photo_.column(high) : photo_.row(low)));
        PhotoLine best;
        for (int position = first + 3; position <= last - 3; ++position) {
          const PhotoLine line = along_u ? lines_.line(true, position, part.y0, part.y1)
                                         : lines_.line(false, position, part.x0, part.x1);
          if (line.z > best.z) best = line;
        }
        if (best.z > kPhotoFronts.weak_z)
          cuts.push_back({along_u, best.position, edge_of(best),
                          kPhotoFronts.regular_cost * std::max(0.0, 1 - best.z / kLines.min_z)});
        else if (along_u)
          cuts.push_back({true, (first + last) / 2, {"regular", 0}, kPhotoFronts.regular_cost});
      }
    }
  }

  /// The best of one front and of the layouts on both sides of the strongest upright and the strongest level
  /// line.
  const Layout& best_layout(const Part& part, int depth) {
    const auto [known, fresh] = layouts_.try_emplace({part.x0, part.x1, part.y0, part.y1});
    Layout& best = known->second;
    if (!fresh || part.width() < min_side_ || part.height() < min_side_) return best;
    const int strip = px(kPhotoFronts.min_strip_m);
    const PhotoLine upright = lines_.strongest(true, part.x0 + strip, part.x1 - strip, part.y0, part.y1);
    const PhotoLine level = lines_.strongest(false, part.y0 + strip, part.y1 - strip, part.x0, part.x1);
    best = one_front(part);
    best.value -= kPhotoFronts.line_cost * std::min(std::max(upright.z, level.z), kPhotoFronts.max_line_z);
    if (depth > kPhotoFronts.max_depth) return best;
    std::vector<Cut> cuts;
    if (upright.kind != PhotoLine::Kind::none) cuts.push_back({true, upright.position, edge_of(upright), 0});
    if (level.kind != PhotoLine::Kind::none) cuts.push_back({false, level.position, edge_of(level), 0});
    add_outline_cut(part, cuts);
    if (cuts.empty()) add_cuts_between_bars(part, cuts);
    for (const Cut& cut : cuts) {
      Part low = part, high = part;
      if (cut.along_u) {
        low.x1 = high.x0 = cut.position;
        low.edges[right] = high.edges[left] = cut.edge;
      } else {
        low.y1 = high.y0 = cut.position;
        low.edges[bottom] = high.edges[top] = cut.edge;
      }
      Layout divided = best_layout(low, depth + 1);
      divided.append(best_layout(high, depth + 1));
      divided.value -= cut.cost;
      if (divided.value >= best.value) best = std::move(divided);
    }
    return best;
  }

  /// A part as one front with the bar that suits it best.
  Layout one_front(Part part) {
    Layout layout;
    shrink(part);
    const FaceRect rect = rect_of(part);
    if (part.width() < min_side_ || part.height() < min_side_ || rect.width() > kPhotoFronts.max_width_m ||
        rect.width() * rect.height() > kPhotoFronts.max_area_m2)
      return layout;
    const auto resolved = std::count_if(part.edges.begin(), part.edges.end(),
                                        [](const Edge& edge) { return edge.kind != "border"; });
    if (resolved < kPhotoFronts.min_resolved) return layout;
    const FaceRect core = rect.grown(-kPhotoFronts.bar_margin_m);
    double bars = 0;
    for (const FaceFixture& bar : bars_) {
      if (!rect.contains(bar.u, bar.v)) continue;
      ++bars;
      if (!fits(bar.box, part, core)) continue;
      const Front front = front_of(part, &bar);
      const double value = kPhotoFronts.front_value + front_log_likelihood(front);
      if (layout.fronts.empty() || value > layout.value) layout = {value, {front}, {part}, {}};
    }
    if (layout.value < 0) layout = {};
    const double side = std::min(rect.width(), rect.height());
    if (layout.fronts.empty() && side > kPhotoFronts.bare_side_m) layout.value -= kPhotoFronts.bare_cost;
    if (layout.fronts.empty() && bars == 0 && side > kPhotoFronts.min_bare_m &&
        resolved >= kPhotoFronts.min_bare_resolved)
      layout.bare.push_back(part);
    layout.value -= kPhotoFronts.extra_bar * std::max(0.0, bars - static_cast<double>(layout.fronts.size()));
    return layout;
  }

  FaceRect rect_of(const Part& part) const {
    return {photo_.u(part.x0 - 0.5), photo_.u(part.x1 - 0.5), photo_.v(part.y1 - 0.5),
            photo_.v(part.y0 - 0.5)};
  }

  /// Whether a bar is within a part; where the part ends because no more was seen, it may end beyond.
  static bool fits(const FaceRect& box, const Part& part, const FaceRect& core) {
    const auto open = [&](Side side) { return part.edges[side].kind == "border"; };
    return (box.u0 > core.u0 || open(left)) && (box.u1 < core.u1 || open(right)) &&
           (box.v0 > core.v0 || open(bottom)) && (box.v1 < core.v1 || open(top));
  }

  Front front_of(const Part& part, const FaceFixture* bar) const {
    const FaceRect rect = rect_of(part);
    Front front;
    front.centre = photo_.in_map({rect.u(), rect.v()});
    front.normal = photo_.face.normal3();
    front.width = rect.width();
    front.height = rect.height();
    front.confidence = 0.9;
    if (bar != nullptr) {
      front.fixture = bar->fixture;
      front.confidence *= 0.5 + 0.5 * bar->fixture.confidence;
    }
    Json edges = Json::object(), scores = Json::array();
    for (size_t side = 0; side < 4; ++side) {
      edges[kSideNames[side]] = part.edges[side].kind;
      scores.push_back(std::round(10 * part.edges[side].z) / 10);
    }
    front.evidence = {{"edges", edges}, {"edge_scores", scores}, {"frames", photo_.frames.size()}};
    return front;
  }

  const Orthophoto& photo_;
  std::vector<FaceFixture> bars_;
  PhotoLines lines_;
  cv::Mat known_, face_;
  cv::Mat face_sums_;  ///< integral image of face_
  cv::Mat open_;       ///< measured, but not of the face
  int min_side_;
  std::map<std::array<int, 4>, Layout> layouts_;  ///< by part: columns and rows
};

}  // namespace

PhotoFrontSearch find_photo_fronts(const Orthophoto& photo, const std::vector<Fixture>& known) {
  if (photo.frames.empty()) return {};
  PhotoFrontSearch search;
  std::vector<FaceFixture> bars = all_bars(photo, known);
  search.ribs = remove_ribs(bars);
  search.fronts = PhotoLayout(photo, std::move(bars)).run();
  return search;
}

}  // namespace loci::mapping
