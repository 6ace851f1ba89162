#include "mapping/interpretation/fronts/seams.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "mapping/base/math/math.h"
#include "mapping/interpretation/fronts/parameters.h"

namespace loci::mapping {
namespace {

/// Whether part of a ray's beam may have met a fixture or its posts.
bool touches(const FaceRay& ray, const FaceFixture& fixture) {
  for (const double part : {0.0, 0.35, 0.7, 1.0}) {
    const double depth = part * fixture.fixture.protrusion;
    const Vector2d at = ray.at_depth(depth);
    if (fixture.box.contains(at.x(), at.y(), kSeams.beam_m)) return true;
  }
  return false;
}

/// A channel along a row of chunks, as running sums over positions.
struct RunningSums {
  std::vector<double> sum, weight;

  explicit RunningSums(size_t positions) : sum(positions + 1), weight(positions + 1) {}

  struct Mean {
    double value = 0, weight = 0;
    bool known() const { return weight >= static_cast<double>(kSeams.min_weight); }
  };
  /// Over positions [first, last), limited to the grid.
  Mean mean(int first, int last) const {
    const int end = static_cast<int>(sum.size()) - 1;
    const auto a = static_cast<size_t>(std::clamp(first, 0, end));
    const auto b = static_cast<size_t>(std::clamp(last, 0, end));
    Mean result{0, b > a ? weight[b] - weight[a] : 0};
    if (result.known()) result.value = (sum[b] - sum[a]) / result.weight;
    return result;
  }
};

/// Standard score of a step (`seam` unset) or of a seam of a half width against its flanks; unset where too
/// few rays passed. `variance`: of a ray.
std::optional<double> line_score(const RunningSums& row, int position, std::optional<int> seam,
                                 size_t channel, double variance) {
  const int left_end = seam ? position - *seam - kSeams.flank_gap_cells : position;
  const int right_begin = seam ? position + *seam + 1 + kSeams.flank_gap_cells : position;
  const RunningSums::Mean left = row.mean(left_end - kSeams.flank_cells, left_end);
  const RunningSums::Mean right = row.mean(right_begin, right_begin + kSeams.flank_cells);
  if (!left.known() || !right.known()) return std::nullopt;
  double difference = right.value - left.value;
  double weights = 1 / left.weight + 1 / right.weight;
  if (seam) {
    const RunningSums::Mean middle = row.mean(position - *seam, position + *seam + 1);
    if (!middle.known()) return std::nullopt;
    // A dip is below (or beside) both flanks.
    const double a = middle.value - left.value;
    const double b = middle.value - right.value;
    difference = a * b <= 0 ? 0 : std::abs(a) < std::abs(b) ? a : b;
    weights = 1 / middle.weight + 1 / std::min(left.weight, right.weight);
  }
  return difference / std::sqrt(variance * weights + kSeams.trivial[channel] * kSeams.trivial[channel]);
}

}  // namespace

SeamMap::SeamMap(const FaceRays& rays, const std::vector<FaceFixture>& fixtures) : grid_(rays.face) {
  gather(rays, fixtures);
  estimate_noise();
  score(true, upright_);
  score(false, level_);
}

void SeamMap::gather(const FaceRays& rays, const std::vector<FaceFixture>& fixtures) {
  for (Sums& sums : sums_) {
    sums.sum.assign(grid_.size(), 0);
    sums.weight.assign(grid_.size(), 0);
  }
  std::vector<float> on(grid_.size(), 0);
  std::vector<float> off(grid_.size(), 0);
  const auto before = static_cast<float>(std::max(0.02, 2.5 * rays.sigma));
  const auto relief = static_cast<float>(kFaces.relief_m);
  const FaceRect extent{rays.face.u_min, rays.face.u_max, rays.face.v_min, rays.face.v_max};
  const auto used = [&](const FaceRay& ray, int& x, int& y) {
    if (ray.returned && ray.depth > before) return false;  // it ended before the face
    if (ray.cosine() < kSeams.min_cosine) return false;
    x = grid_.column(ray.plane_u());
    y = grid_.row(ray.plane_v());
    return grid_.inside(x, y) &&
           std::none_of(fixtures.begin(), fixtures.end(),
                        [&](const FaceFixture& fixture) { return touches(ray, fixture); });
  };
  for (const FaceRay& ray : rays.rays) {
    int x = 0;
    int y = 0;
    if (!used(ray, x, y)) continue;
    const size_t cell = grid_.number(x, y);
    const float weight = std::min(1.F, 2 * ray.cosine() * ray.cosine());
    const auto add = [&](size_t channel, float value) {
      sums_[channel].sum[cell] += weight * value;
      sums_[channel].weight[cell] += weight;
    };
    add(missing, ray.returned ? 0.F : 1.F);
    // A mirror-like front gives no returns, but neither does free space beside a face.
    if (ray.returned || extent.contains(ray)) (ray.returned && ray.depth <= -relief ? off : on)[cell] += 1;
    if (!ray.returned) continue;
    add(depth, std::max(ray.depth, -relief));
    for (size_t c = 0; c < ray.appearance.size(); ++c) add(intensity + c, ray.appearance[c]);
  }
  face_.assign(grid_.size(), 0);
  for (int y = 0; y < grid_.height; ++y)
    for (int x = 0; x < grid_.width; ++x) {
      float face = 0;
      float other = 0;
      for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx)
          if (grid_.inside(x + dx, y + dy)) {
            face += on[grid_.number(x + dx, y + dy)];
            other += off[grid_.number(x + dx, y + dy)];
          }
      if (face + other > 0) face_[grid_.number(x, y)] = face >= other ? 1 : 2;
    }
}

double SeamMap::noise_of(size_t channel, int columns, int rows) const {
  // What rays met behind the face, over a low row beside a tall unit, has no depth of its own.
  const auto block_at = [&](int x, int y) {
    std::array<double, 2> block{};
    for (int dy = 0; dy < rows; ++dy)
      for (int dx = 0; dx < columns; ++dx) {
        const size_t cell = grid_.number(x + dx, y + dy);
        if (face_[cell] == 2) return std::array<double, 2>{};
        block[0] += static_cast<double>(sums_[channel].sum[cell]);
        block[1] += static_cast<double>(sums_[channel].weight[cell]);
      }
    return block;
  };
  std::vector<double> deviations;
  for (int y = 0; y + rows <= grid_.height; y += rows) {
    std::array<double, 2> last{};
    for (int x = 0; x + columns <= grid_.width; x += columns) {
      const std::array<double, 2> block = block_at(x, y);
      if (block[1] >= 1 && last[1] >= 1)
        deviations.push_back(std::abs(block[0] / block[1] - last[0] / last[1]) /
                             std::sqrt(1 / block[1] + 1 / last[1]));
      last = block;
    }
  }
  if (deviations.empty()) return 0;
  return 1.4826 * median(std::move(deviations));
}

void SeamMap::estimate_noise() {
  // Differences of neighbours; the median is robust to seams. Blocks as large as the flanks of a line show
  // correlated noise: quantised depth, drift between scans.
  for (size_t c = 0; c < kChannels; ++c) {
    const double sd =
        c == missing ? 0 : std::max(noise_of(c, 1, 1), noise_of(c, kSeams.flank_cells, kSeams.chunk_cells));
    variance_[c] = std::pow(std::max(kSeams.min_sd[c], sd), 2);
  }
}

void SeamMap::score(bool upright, Scores& scores) const {
  scores.positions = upright ? grid_.width : grid_.height;
  scores.chunks = ((upright ? grid_.height : grid_.width) + kSeams.chunk_cells - 1) / kSeams.chunk_cells;
  for (size_t c = 0; c < kChannels; ++c) score_channel(upright, c, scores);
}

void SeamMap::score_channel(bool upright, size_t channel, Scores& scores) const {
  const auto positions = static_cast<size_t>(scores.positions);
  const auto entries = static_cast<size_t>(scores.chunks + 1) * positions;
  for (auto& integral : scores.integrals[channel]) integral.assign(entries, {});
  RunningSums row(positions);
  const int across = upright ? grid_.height : grid_.width;
  for (int chunk = 0; chunk < scores.chunks; ++chunk) {
    for (size_t p = 0; p < positions; ++p) {
      double sum = 0;
      double weight = 0;
      for (int k = chunk * kSeams.chunk_cells; k < std::min(across, (chunk + 1) * kSeams.chunk_cells); ++k) {
        const size_t cell =
            upright ? grid_.number(static_cast<int>(p), k) : grid_.number(k, static_cast<int>(p));
        sum += static_cast<double>(sums_[channel].sum[cell]);
        weight += static_cast<double>(sums_[channel].weight[cell]);
      }
      row.sum[p + 1] = row.sum[p] + sum;
      row.weight[p + 1] = row.weight[p] + weight;
    }
    for (int p = 0; p < scores.positions; ++p) {
      const auto at = static_cast<size_t>(chunk) * positions + static_cast<size_t>(p);
      for (size_t w = 0; w <= kSeams.half_widths.size(); ++w) {
        const bool step = w == kSeams.half_widths.size();
        Scores::Entry entry = scores.integrals[channel][w][at];
        if (const auto z = line_score(row, p, step ? std::nullopt : std::optional(kSeams.half_widths[w]),
                                      channel, variance_[channel])) {
          entry.z += static_cast<float>(std::clamp(*z, -kSeams.max_z, kSeams.max_z));
          entry.shown += *z > kSeams.shown_z ? 1.F : *z < -kSeams.shown_z ? -1.F : 0.F;
          entry.count += 1;
        }
        scores.integrals[channel][w][at + positions] = entry;
      }
    }
  }
}

double SeamMap::weakest(const std::vector<Scores::Entry>& integral, size_t positions, size_t position,
                        int first_chunk, int last_chunk, double mean) {
  double min_mean = 1e9;
  const int window = std::min(kSeams.window_chunks, last_chunk - first_chunk);
  for (int chunk = first_chunk; chunk + window <= last_chunk; ++chunk) {
    const Scores::Entry& low = integral[static_cast<size_t>(chunk) * positions + position];
    const Scores::Entry& high = integral[static_cast<size_t>(chunk + window) * positions + position];
    const double count = static_cast<double>(high.count - low.count);
    if (count < 1) continue;
    min_mean = std::min(min_mean, static_cast<double>(high.z - low.z) / count / mean);
  }
  return min_mean;
}

LineEvidence SeamMap::strongest(const Scores& scores, int position, int first_chunk, int last_chunk) const {
  LineEvidence best;
  if (position < 0 || position >= scores.positions) return best;
  first_chunk = std::clamp(first_chunk, 0, scores.chunks);
  last_chunk = std::clamp(last_chunk, 0, scores.chunks);
  if (last_chunk <= first_chunk) return best;
  const auto positions = static_cast<size_t>(scores.positions);
  const size_t low = static_cast<size_t>(first_chunk) * positions + static_cast<size_t>(position);
  const size_t high = static_cast<size_t>(last_chunk) * positions + static_cast<size_t>(position);
  for (size_t c = 0; c < kChannels; ++c)
    for (size_t w = 0; w <= kSeams.half_widths.size(); ++w) {
      const auto& integral = scores.integrals[c][w];
      const double count = static_cast<double>(integral[high].count - integral[low].count);
      if (count < 1 || count < 0.4 * (last_chunk - first_chunk)) continue;
      double z = static_cast<double>(integral[high].z - integral[low].z) / std::sqrt(count);
      double share = static_cast<double>(integral[high].shown - integral[low].shown) / count;
      const bool step = w == kSeams.half_widths.size();
      // Seams are deeper and give fewer returns; intensity and colour may change either way.
      if (!step && c == depth) z = -z, share = -share;
      if (step || c >= intensity) share = z < 0 ? -share : share, z = std::abs(z);
      if (z <= best.z) continue;
      best.z = z;
      best.weakest = weakest(integral, positions, static_cast<size_t>(position), first_chunk, last_chunk,
                             static_cast<double>(integral[high].z - integral[low].z) / count);
      best.share = share;
      best.kind = step ? LineEvidence::Kind::step : LineEvidence::Kind::seam;
      best.width = step ? 0 : (2 * kSeams.half_widths[w] + 1) * kFaces.cell_m;
      best.relief = c == depth || c == missing;
    }
  return best;
}

LineEvidence SeamMap::line(bool upright, double position, double from, double to) const {
  const double origin = upright ? grid_.v0 : grid_.u0;
  const auto chunk_of = [&](double at) {
    return static_cast<int>(std::lround((at - origin) / (kSeams.chunk_cells * kFaces.cell_m)));
  };
  LineEvidence evidence =
      strongest(upright ? upright_ : level_, upright ? grid_.column(position) : grid_.row(position),
                chunk_of(from), chunk_of(to));
  evidence.position = position;
  return evidence;
}

double SeamMap::unit(size_t channel) const {
  return variance_[channel] + kSeams.trivial[channel] * kSeams.trivial[channel];
}

double SeamMap::Profile::mean_between(size_t channel, int first, int last) const {
  double sum = 0;
  double total = 1e-9;
  for (int d = first; d <= last; ++d) {
    sum += mean[channel][index(d)] * weight[channel][index(d)];
    total += weight[channel][index(d)];
  }
  return sum / total;
}

SeamMap::Profile SeamMap::profile(bool upright, int centre, double from, double to) const {
  const int first =
      std::max(0, upright ? grid_.row(from + kSeams.end_margin_m) : grid_.column(from + kSeams.end_margin_m));
  const int last =
      std::min(upright ? grid_.height : grid_.width,
               (upright ? grid_.row(to - kSeams.end_margin_m) : grid_.column(to - kSeams.end_margin_m)) + 1);
  Profile profile;
  profile.origin = upright ? grid_.u0 : grid_.v0;
  profile.centre = centre;
  for (int d = -kSeams.profile_cells; d <= kSeams.profile_cells; ++d) {
    const size_t i = Profile::index(d);
    for (int k = first; k < last; ++k) {
      const int x = upright ? centre + d : k;
      const int y = upright ? k : centre + d;
      if (!grid_.inside(x, y)) continue;
      const size_t cell = grid_.number(x, y);
      for (size_t c = 0; c < kChannels; ++c) {
        profile.mean[c][i] += static_cast<double>(sums_[c].sum[cell]);
        profile.weight[c][i] += static_cast<double>(sums_[c].weight[cell]);
      }
    }
    for (size_t c = 0; c < kChannels; ++c)
      if (profile.weight[c][i] > 0) profile.mean[c][i] /= profile.weight[c][i];
  }
  return profile;
}

bool SeamMap::place_seam(const Profile& p, LineEvidence& line) const {
  constexpr int kCore = kSeams.core_cells;
  constexpr int kReach = kSeams.profile_cells;
  double step_energy = 0;
  Profile::Values excursion{};
  for (size_t c = 0; c < kChannels; ++c) {
    const double left = p.mean_between(c, -kReach, -kCore - 1);
    const double right = p.mean_between(c, kCore + 1, kReach);
    step_energy += (right - left) * (right - left) / unit(c);
    for (int d = -kCore - 1; d <= kCore + 1; ++d) {
      const size_t i = Profile::index(d);
      if (p.weight[c][i] < 1) continue;
      const double out =
          std::max({0.0, p.mean[c][i] - std::max(left, right), std::min(left, right) - p.mean[c][i]});
      excursion[i] += std::max(0.0, out * out / unit(c) - 4 / p.weight[c][i]);
    }
  }
  const double peak = *std::max_element(excursion.begin(), excursion.end());
  if (!(peak > 0.5 * step_energy && peak > 0)) return false;
  double sum = 0;
  double moment = 0;
  int shown = 0;
  for (int d = -kCore - 1; d <= kCore + 1; ++d) {
    const double e = std::sqrt(excursion[Profile::index(d)] / peak);
    if (e < 0.35) continue;
    ++shown;
    sum += e;
    moment += e * d;
  }
  line.kind = LineEvidence::Kind::seam;
  line.position = p.origin + (p.centre + moment / sum + 0.5) * kFaces.cell_m;
  line.width = std::max(0.0, shown * kFaces.cell_m - kSeams.blur_m);
  return true;
}

void SeamMap::place_step(const Profile& p, LineEvidence& line) const {
  constexpr int kReach = kSeams.profile_cells;
  line.kind = LineEvidence::Kind::step;
  line.width = 0;
  double min_error = 1e300;
  for (int split = -kReach + 3; split <= kReach - 2; ++split) {
    double error = 0;
    for (size_t c = 0; c < kChannels; ++c)
      for (const bool low : {true, false}) {
        const int first = low ? -kReach : split;
        const int last = low ? split - 1 : kReach;
        const double mean = p.mean_between(c, first, last);
        for (int d = first; d <= last; ++d) {
          const size_t i = Profile::index(d);
          error += p.weight[c][i] * (p.mean[c][i] - mean) * (p.mean[c][i] - mean) / unit(c);
        }
      }
    if (error < min_error) min_error = error, line.position = p.origin + (p.centre + split) * kFaces.cell_m;
  }
}

LineEvidence SeamMap::refine(bool upright, const LineEvidence& line, double from, double to) const {
  LineEvidence refined = line;
  const double origin = upright ? grid_.u0 : grid_.v0;
  const auto cell_of = [&](double position) {
    return static_cast<int>(std::floor((position - origin) / kFaces.cell_m));
  };
  for (int round = 0; round < 3; ++round) {
    const Profile p = profile(upright, cell_of(refined.position), from, to);
    refined.rise = p.mean_between(depth, kSeams.core_cells, kSeams.profile_cells) -
                   p.mean_between(depth, -kSeams.profile_cells, -kSeams.core_cells);
    if (!place_seam(p, refined)) place_step(p, refined);
    if (cell_of(refined.position) == p.centre) break;
  }
  return refined;
}

SeamMap::Coverage SeamMap::coverage(const FaceRect& rect) const {
  Coverage coverage;
  double cells = 0;
  double rays = 0;
  for (int y = std::max(0, grid_.row(rect.v0)); y < std::min(grid_.height, grid_.row(rect.v1) + 1); ++y)
    for (int x = std::max(0, grid_.column(rect.u0)); x < std::min(grid_.width, grid_.column(rect.u1) + 1);
         ++x) {
      const size_t cell = grid_.number(x, y);
      ++cells;
      coverage.known += face_[cell] > 0 ? 1 : 0;
      coverage.face += face_[cell] == 1 ? 1 : 0;
      rays += static_cast<double>(sums_[missing].weight[cell]);
      coverage.returned += static_cast<double>(sums_[missing].weight[cell] - sums_[missing].sum[cell]);
    }
  if (rays > 0) coverage.returned /= rays;
  if (coverage.known > 0) coverage.face /= coverage.known;
  if (cells > 0) coverage.known /= cells;
  return coverage;
}

std::vector<std::array<float, 2>> SeamMap::coverage_of(const FaceRect& rect, bool columns) const {
  std::vector<std::array<float, 2>> shares;
  for (double at = rect.low(columns) + kFaces.cell_m / 2; at < rect.high(columns); at += kFaces.cell_m) {
    FaceRect line = rect;
    line.low(columns) = line.high(columns) = at;
    const Coverage one = coverage(line);
    shares.push_back({static_cast<float>(one.known), static_cast<float>(one.face)});
  }
  return shares;
}

}  // namespace loci::mapping
