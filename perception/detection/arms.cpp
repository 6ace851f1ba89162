#include "perception/detection/arms.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>

#include "perception/detection/arm_grid.h"

namespace loci::perception {
namespace {

/// Measures of arms, metres.
constexpr double kSlice = 0.02;     ///< arms are cut across into slices of this length
constexpr double kMaxWidth = 0.17;  ///< of a slice: a hand with fingers apart, a sleeve
constexpr double kMaxEntry = 0.35;  ///< of the slice at the image's border, which cuts an arm askew
constexpr double kMinMeanWidth = 0.04, kMaxMeanWidth = 0.13;
constexpr double kMinBulge =
    0.0052;                          ///< deviation from a plane, in the median of its pieces: boards are flat
constexpr double kNoise = 0.0012;    ///< of the depth at 1 m, which makes boards deviate, too
constexpr double kMinLength = 0.15;  ///< in view
constexpr double kMinHand = 0.08;    ///< of what has a colour of skin
constexpr double kMinBare = 0.5;     ///< share of a slice from which on it is skin
constexpr double kMinBareHand = 0.6;  ///< share of all of the hand
constexpr float kUpright = 0.5F;      ///< cosine to the vertical of what stands rather than reaches in
constexpr double kBorder = 0.03;      ///< part of the image's width along its border that is not measured

/// How far cells are from the border of the image, along what is free.
struct Paths {
  std::vector<float> distance;  ///< metres; infinite where nothing leads to the border
  std::vector<size_t> parent;   ///< the cell itself at the border
  std::vector<size_t> order;    ///< the cells that are reached, by distance
};

Paths paths_from_border(const ArmGrid& grid) {
  Paths paths{std::vector<float>(grid.size(), std::numeric_limits<float>::infinity()),
              std::vector<size_t>(grid.size()),
              {}};
  std::priority_queue<std::pair<float, size_t>, std::vector<std::pair<float, size_t>>, std::greater<>> open;
  const cv::Rect all(0, 0, grid.columns(), grid.rows());
  const int border = std::max(1, static_cast<int>(kBorder * grid.columns()));
  const cv::Rect inner(border, border, all.width - 2 * border, all.height - 2 * border);
  for (int row = 0; row < grid.rows(); ++row)
    for (int column = 0; column < grid.columns(); ++column) {
      const size_t cell = grid.cell(row, column);
      if (inner.contains({column, row}) || !grid.is_free(cell)) continue;
      paths.distance[cell] = 0;
      paths.parent[cell] = cell;
      open.emplace(0.0F, cell);
    }
  while (!open.empty()) {
    const float distance = open.top().first;
    const size_t cell = open.top().second;
    open.pop();
    if (distance > paths.distance[cell]) continue;
    paths.order.push_back(cell);
    grid.for_each_neighbour(cell, [&](size_t next) {
      const float through = distance + (grid.point(next) - grid.point(cell)).norm();
      if (through >= paths.distance[next]) return;
      paths.distance[next] = through;
      paths.parent[next] = cell;
      open.emplace(through, next);
    });
  }
  return paths;
}

constexpr size_t kNone = std::numeric_limits<size_t>::max();

/// A connected piece of what is equally far from the border.
struct Slice {
  std::vector<size_t> cells;
  size_t parent = kNone;  ///< the slice through which paths go on to the border; none at the border
  int number = 0;         ///< of kSlice from the border
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  double bare = 0;   ///< share of skin
  double width = 0;  ///< across the path, metres
  float lowest = 0;  ///< height
};

/// Parents come before what goes on from them.
std::vector<Slice> cut_into_slices(const ArmGrid& grid, const Paths& paths) {
  std::vector<size_t> slice_of(grid.size(), kNone);
  std::vector<Slice> slices;
  const auto number = [&](size_t cell) {
    return static_cast<int>(static_cast<double>(paths.distance[cell]) / kSlice);
  };
  for (const size_t first : paths.order) {
    if (slice_of[first] != kNone) continue;
    const size_t id = slices.size();
    Slice slice;
    slice.number = number(first);
    slice.cells = {first};
    slice_of[first] = id;
    for (size_t i = 0; i < slice.cells.size(); ++i)
      grid.for_each_neighbour(slice.cells[i], [&](size_t next) {
        if (slice_of[next] != kNone || number(next) != slice.number) return;
        slice_of[next] = id;
        slice.cells.push_back(next);
      });
    if (const size_t before = slice_of[paths.parent[first]]; before != id) slice.parent = before;
    slices.push_back(std::move(slice));
  }
  return slices;
}

/// Fills in what the cells of slices say.
void measure(const ArmGrid& grid, std::vector<Slice>& slices) {
  for (Slice& slice : slices) {
    slice.lowest = std::numeric_limits<float>::infinity();
    for (const size_t cell : slice.cells) {
      slice.centre += grid.point(cell) / static_cast<float>(slice.cells.size());
      slice.bare += (grid.is_skin(cell) ? 1.0 : 0.0) / static_cast<double>(slice.cells.size());
      slice.lowest = std::min(slice.lowest, grid.height(grid.point(cell)));
    }
  }
  for (Slice& slice : slices) {
    const Slice* before = &slice;
    for (int i = 0; i < 3 && before->parent != kNone; ++i) before = &slices[before->parent];
    const Eigen::Vector3f along = (slice.centre - before->centre).normalized();
    float across = 0;
    for (const size_t cell : slice.cells) {
      const Eigen::Vector3f offset = grid.point(cell) - slice.centre;
      across += (offset - offset.dot(along) * along).squaredNorm();
    }
    // An even distribution over a width w has the variance w²/12.
    slice.width = std::sqrt(12 * static_cast<double>(across) / static_cast<double>(slice.cells.size()));
  }
}

/// How far a piece of three slices deviates from a plane (standard deviation).
double bulge_at(const ArmGrid& grid, const std::vector<Slice>& slices, size_t first) {
  std::vector<Eigen::Vector3f> points;
  size_t at = first;
  for (int i = 0; i < 3 && at != kNone; ++i, at = slices[at].parent)
    for (const size_t cell : slices[at].cells) points.push_back(grid.point(cell));
  const auto count = static_cast<float>(points.size());
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& point : points) mean += point / count;
  Eigen::Matrix3f scatter = Eigen::Matrix3f::Zero();
  for (const Eigen::Vector3f& point : points) scatter += (point - mean) * (point - mean).transpose() / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(scatter, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, static_cast<double>(solver.eigenvalues()[0])));
}

/// What may be an arm: slices from the tip of a hand back to the border, or to what is too wide.
struct Limb {
  std::vector<size_t> chain;
  bool from_border = false;
  double width = 0;  ///< mean, metres
  double bulge = 0;  ///< median, metres
  double hand = 0;   ///< length of what is bare from the tip on, metres
  double bare = 0;   ///< share of skin of the hand
  bool in_the_air = false;
  bool over_a_surface = false;  ///< the hand

  Limb(const ArmGrid& grid, const std::vector<Slice>& slices, size_t tip);
  bool is_arm(const ArmGrid& grid, const std::vector<Slice>& slices) const;
};

Limb::Limb(const ArmGrid& grid, const std::vector<Slice>& slices, size_t tip) {
  size_t at = tip;
  for (; at != kNone && slices[at].width < (slices[at].number == 0 ? kMaxEntry : kMaxWidth);
       at = slices[at].parent)
    chain.push_back(at);
  from_border = at == kNone;
  const auto length = static_cast<double>(chain.size());
  if (!from_border || length * kSlice < kMinLength) return;
  std::vector<double> bulges;
  double bare_slices = 0;
  for (const size_t id : chain) {
    const Slice& slice = slices[id];
    width += slice.width / length;
    bulges.push_back(bulge_at(grid, slices, id));
    in_the_air = in_the_air || grid.is_in_the_air(slice.lowest);
    if (bare_slices + 1 < static_cast<double>(bulges.size()) || slice.bare <= kMinBare) continue;
    ++bare_slices;
    bare += slice.bare;
    over_a_surface = over_a_surface || grid.is_over_a_surface(slice.centre);
  }
  hand = bare_slices * kSlice;
  bare /= std::max(1.0, bare_slices);
  const auto middle = bulges.begin() + static_cast<std::ptrdiff_t>(bulges.size() / 2);
  std::ranges::nth_element(bulges, middle);
  bulge = *middle;
}

bool Limb::is_arm(const ArmGrid& grid, const std::vector<Slice>& slices) const {
  if (!from_border || hand < kMinHand || bare < kMinBareHand || !in_the_air || !over_a_surface) return false;
  if (width < kMinMeanWidth || width > kMaxMeanWidth) return false;
  const Eigen::Vector3f& tip = slices[chain.front()].centre;
  if ((tip - slices[chain.back()].centre).normalized().dot(grid.up()) > kUpright) return false;
  return bulge > std::hypot(kMinBulge, kNoise * static_cast<double>(tip.z() * tip.z()));
}

/// The slices of an arm: its chain, and fingers beside it.
std::vector<uint8_t> slices_of(const Limb& limb, const std::vector<Slice>& slices) {
  std::vector<uint8_t> part(slices.size(), 0);
  for (const size_t slice : limb.chain) part[slice] = 1;
  for (size_t i = 0; i < slices.size(); ++i)
    if (part[i] == 0 && slices[i].parent != kNone && part[slices[i].parent] != 0)
      part[i] = slices[i].width < kMaxWidth && slices[i].bare > kMinBare ? 1 : 0;
  return part;
}

Person make_person(const PeopleFrame& frame, std::vector<int> pixels, double score) {
  Person person;
  const Isometry3d color_from_depth = frame.camera.depth_from_color.inverse();
  for (const int pixel : pixels) {
    const cv::Vec3f& point = frame.points.ptr<cv::Vec3f>()[pixel];
    const Vector2d at = frame.camera.color.project(color_from_depth * Vector3d(cv::Vec3d(point).val));
    person.body |= cv::Rect(static_cast<int>(at.x()), static_cast<int>(at.y()), 1, 1);
  }
  person.body &= cv::Rect({}, frame.color.size());
  person.score = score;
  person.pixels = std::move(pixels);
  return person;
}

}  // namespace

std::vector<Person> find_arms(const PeopleFrame& frame) {
  if (frame.points.empty() || frame.color.empty() || !frame.map_from_camera) return {};
  const ArmGrid grid(frame);
  std::vector<Slice> slices = cut_into_slices(grid, paths_from_border(grid));
  measure(grid, slices);
  std::vector<size_t> tips(slices.size());
  std::iota(tips.begin(), tips.end(), 0);
  std::ranges::stable_sort(tips, std::greater<>(), [&](size_t tip) { return slices[tip].number; });
  std::vector<Person> people;
  std::vector<uint8_t> taken(slices.size(), 0);
  for (const size_t tip : tips) {
    if (slices[tip].bare <= kMinBare) continue;
    const Limb limb(grid, slices, tip);
    if (!limb.is_arm(grid, slices)) continue;
    if (std::ranges::any_of(limb.chain, [&](size_t slice) { return taken[slice] != 0; })) continue;
    const std::vector<uint8_t> part = slices_of(limb, slices);
    std::vector<size_t> cells;
    for (size_t i = 0; i < slices.size(); ++i) {
      if (part[i] == 0) continue;
      taken[i] = 1;
      cells.insert(cells.end(), slices[i].cells.begin(), slices[i].cells.end());
    }
    people.push_back(make_person(frame, grid.pixels_of(cells), limb.bare));
  }
  return people;
}

}  // namespace loci::perception
