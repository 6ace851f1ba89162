#include "mapping/interpretation/face_seams.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/quantile.h"

namespace loci::mapping {
namespace {

constexpr int kFlank = 6;           // cells on each side that a line is compared with
constexpr int kFlankGap = 1;        // cells between a line and its flanks
constexpr int kWindow = 5;          // chunks; a line that shows nothing over this length is interrupted
constexpr float kMinCosine = 0.3F;  // of incidence; a flatter ray tells where it crosses the face too badly
constexpr double kMaxZ = 4;         // influence of one chunk
constexpr double kShownZ = 1;       // a chunk with more shows the line
constexpr float kMinWeight = 1.5F;  // rays in a line's part of a chunk
/// Differences of this size are no evidence: shading, registration. Metres, share, intensity, colour.
constexpr std::array<double, 6> kTrivial = {0.001, 0.02, 0.008, 0.006, 0.006, 0.006};
constexpr std::array<double, 6> kMinSd = {0.002, 0.05, 0.01, 0.008, 0.008, 0.008};

/// Of the angle of incidence on the face.
float cosine_of(const FaceRay& ray) {
  return 1 / std::sqrt(1 + ray.slope_u * ray.slope_u + ray.slope_v * ray.slope_v);
}

/// Whether a ray comes near a fixture: part of its beam may have met it, or the post below it.
bool touches(const FaceRay& ray, const FaceFixture& fixture) {
  constexpr double kBeam = 0.018;  // m
  for (const double part : {0.0, 0.35, 0.7, 1.0}) {
    const double depth = part * fixture.fixture.protrusion;
    if (fixture.box.contains(static_cast<double>(ray.u) + static_cast<double>(ray.slope_u) * depth,
                             static_cast<double>(ray.v) + static_cast<double>(ray.slope_v) * depth, kBeam))
      return true;
  }
  return false;
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
  const auto relief = static_cast<float>(kFaceRelief);
  const FaceRect extent{rays.face.u_min, rays.face.u_max, rays.face.v_min, rays.face.v_max};
  const auto used = [&](const FaceRay& ray, int& x, int& y) {
    if (ray.returned && ray.depth > before) return false;  // it ended before it met the face
    if (cosine_of(ray) < kMinCosine) return false;
    x = grid_.column(static_cast<double>(ray.u));
    y = grid_.row(static_cast<double>(ray.v));
    return grid_.inside(x, y) &&
           std::none_of(fixtures.begin(), fixtures.end(),
                        [&](const FaceFixture& fixture) { return touches(ray, fixture); });
  };
  for (const FaceRay& ray : rays.rays) {
    int x = 0;
    int y = 0;
    if (!used(ray, x, y)) continue;
    const size_t cell = grid_.number(x, y);
    const float weight = std::min(1.F, 2 * cosine_of(ray) * cosine_of(ray));
    const auto add = [&](size_t channel, float value) {
      sums_[channel].sum[cell] += weight * value;
      sums_[channel].weight[cell] += weight;
    };
    add(missing, ray.returned ? 0.F : 1.F);
    // A mirror-like front gives no returns, but neither does the sky beside a face.
    if (ray.returned || extent.contains(static_cast<double>(ray.u), static_cast<double>(ray.v)))
      (ray.returned && ray.depth <= -relief ? off : on)[cell] += 1;
    if (!ray.returned) continue;
    add(depth, std::max(ray.depth, -relief));
    for (size_t c = 0; c < ray.look.size(); ++c) add(intensity + c, ray.look[c]);
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

double SeamMap::scatter(size_t channel, int columns, int rows) const {
  std::vector<double> deviations;
  std::array<double, 2> last{};
  for (int y = 0; y + rows <= grid_.height; y += rows) {
    last = {};
    for (int x = 0; x + columns <= grid_.width; x += columns) {
      std::array<double, 2> block{};
      for (int dy = 0; dy < rows; ++dy)
        for (int dx = 0; dx < columns; ++dx) {
          const size_t cell = grid_.number(x + dx, y + dy);
          block[0] += static_cast<double>(sums_[channel].sum[cell]);
          block[1] += static_cast<double>(sums_[channel].weight[cell]);
        }
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
  // Differences of neighbours; the median hides the seams. Blocks as large as the flanks of a line show noise
  // that rays share: quantised depth, drift between scans.
  for (size_t c = 0; c < kChannels; ++c) {
    const double sd = c == missing ? 0 : std::max(scatter(c, 1, 1), scatter(c, kFlank, kChunk));
    variance_[c] = std::pow(std::max(kMinSd[c], sd), 2);
  }
}

void SeamMap::score(bool upright, Scores& scores) const {
  scores.positions = upright ? grid_.width : grid_.height;
  scores.chunks = ((upright ? grid_.height : grid_.width) + kChunk - 1) / kChunk;
  for (size_t c = 0; c < kChannels; ++c) score_channel(upright, c, scores);
}

void SeamMap::score_channel(bool upright, size_t channel, Scores& scores) const {
  const auto positions = static_cast<size_t>(scores.positions);
  const auto entries = static_cast<size_t>(scores.chunks + 1) * positions;
  for (auto& integral : scores.integrals[channel]) integral.assign(entries, {});
  std::vector<double> sums(positions + 1);
  std::vector<double> weights(positions + 1);
  for (int chunk = 0; chunk < scores.chunks; ++chunk) {
    const int across = upright ? grid_.height : grid_.width;
    for (size_t p = 0; p < positions; ++p) {
      double sum = 0;
      double weight = 0;
      for (int k = chunk * kChunk; k < std::min(across, (chunk + 1) * kChunk); ++k) {
        const size_t cell =
            upright ? grid_.number(static_cast<int>(p), k) : grid_.number(k, static_cast<int>(p));
        sum += static_cast<double>(sums_[channel].sum[cell]);
        weight += static_cast<double>(sums_[channel].weight[cell]);
      }
      sums[p + 1] = sums[p] + sum;
      weights[p + 1] = weights[p] + weight;
    }
    const auto total = [&](const std::vector<double>& integral, int first, int last) {  // [first, last)
      const auto a = static_cast<size_t>(std::clamp(first, 0, scores.positions));
      const auto b = static_cast<size_t>(std::clamp(last, 0, scores.positions));
      return b > a ? integral[b] - integral[a] : 0;
    };
    const size_t row = static_cast<size_t>(chunk) * positions;
    for (int p = 0; p < scores.positions; ++p) {
      const auto at = row + static_cast<size_t>(p);
      for (size_t w = 0; w <= kHalfWidths.size(); ++w) {
        Scores::Entry entry = scores.integrals[channel][w][at];
        const bool step = w == kHalfWidths.size();
        const int half = step ? 0 : kHalfWidths[w];
        const int left_end = step ? p : p - half - kFlankGap;
        const int right_begin = step ? p : p + half + 1 + kFlankGap;
        const double left_weight = total(weights, left_end - kFlank, left_end);
        const double right_weight = total(weights, right_begin, right_begin + kFlank);
        const double least = static_cast<double>(kMinWeight);
        double difference = 0;
        double variance = 0;
        bool known = left_weight >= least && right_weight >= least;
        const double left = known ? total(sums, left_end - kFlank, left_end) / left_weight : 0;
        const double right = known ? total(sums, right_begin, right_begin + kFlank) / right_weight : 0;
        if (step && known) {
          difference = right - left;
          variance = variance_[channel] * (1 / left_weight + 1 / right_weight);
        } else if (known) {
          const double weight = total(weights, p - half, p + half + 1);
          known = weight >= least;
          if (known) {
            const double middle = total(sums, p - half, p + half + 1) / weight;
            // A dip is below (or beside) both flanks.
            const double a = middle - left;
            const double b = middle - right;
            difference = a * b <= 0 ? 0 : std::abs(a) < std::abs(b) ? a : b;
            variance = variance_[channel] * (1 / weight + 1 / std::min(left_weight, right_weight));
          }
        }
        if (known) {
          const double z = difference / std::sqrt(variance + kTrivial[channel] * kTrivial[channel]);
          entry.z += static_cast<float>(std::clamp(z, -kMaxZ, kMaxZ));
          entry.shown += z > kShownZ ? 1.F : z < -kShownZ ? -1.F : 0.F;
          entry.count += 1;
        }
        scores.integrals[channel][w][at + positions] = entry;
      }
    }
  }
}

double SeamMap::weakest(const std::vector<Scores::Entry>& integral, size_t positions, size_t position,
                        int first_chunk, int last_chunk, double mean) {
  double least = 1e9;
  const int window = std::min(kWindow, last_chunk - first_chunk);
  for (int chunk = first_chunk; chunk + window <= last_chunk; ++chunk) {
    const Scores::Entry& low = integral[static_cast<size_t>(chunk) * positions + position];
    const Scores::Entry& high = integral[static_cast<size_t>(chunk + window) * positions + position];
    const double count = static_cast<double>(high.count - low.count);
    if (count < 1) continue;
    least = std::min(least, static_cast<double>(high.z - low.z) / count / mean);
  }
  return least;
}

LineEvidence SeamMap::line(const Scores& scores, int position, int first_chunk, int last_chunk) const {
  LineEvidence best;
  if (position < 0 || position >= scores.positions) return best;
  first_chunk = std::clamp(first_chunk, 0, scores.chunks);
  last_chunk = std::clamp(last_chunk, 0, scores.chunks);
  if (last_chunk <= first_chunk) return best;
  const auto positions = static_cast<size_t>(scores.positions);
  const size_t low = static_cast<size_t>(first_chunk) * positions + static_cast<size_t>(position);
  const size_t high = static_cast<size_t>(last_chunk) * positions + static_cast<size_t>(position);
  for (size_t c = 0; c < kChannels; ++c)
    for (size_t w = 0; w <= kHalfWidths.size(); ++w) {
      const auto& integral = scores.integrals[c][w];
      const double count = static_cast<double>(integral[high].count - integral[low].count);
      if (count < 1 || count < 0.4 * (last_chunk - first_chunk)) continue;
      double z = static_cast<double>(integral[high].z - integral[low].z) / std::sqrt(count);
      double share = static_cast<double>(integral[high].shown - integral[low].shown) / count;
      const bool step = w == kHalfWidths.size();
      // Seams are deeper and give fewer returns, never the other way round; light and colour go either way.
      if (!step && c == depth) z = -z, share = -share;
      if (step || c >= intensity) share = z < 0 ? -share : share, z = std::abs(z);
      if (z <= best.z) continue;
      best.z = z;
      best.weakest = weakest(integral, positions, static_cast<size_t>(position), first_chunk, last_chunk,
                             static_cast<double>(integral[high].z - integral[low].z) / count);
      best.share = share;
      best.kind = step ? LineEvidence::Kind::step : LineEvidence::Kind::seam;
      best.width = step ? 0 : (2 * kHalfWidths[w] + 1) * kFaceCell;
      best.relief = c == depth || c == missing;
    }
  return best;
}

LineEvidence SeamMap::upright(double u, double v0, double v1) const {
  const double chunk = kChunk * kFaceCell;
  LineEvidence evidence =
      line(upright_, grid_.column(u), static_cast<int>(std::lround((v0 - grid_.v0) / chunk)),
           static_cast<int>(std::lround((v1 - grid_.v0) / chunk)));
  evidence.position = u;
  return evidence;
}

LineEvidence SeamMap::level(double v, double u0, double u1) const {
  const double chunk = kChunk * kFaceCell;
  LineEvidence evidence = line(level_, grid_.row(v), static_cast<int>(std::lround((u0 - grid_.u0) / chunk)),
                               static_cast<int>(std::lround((u1 - grid_.u0) / chunk)));
  evidence.position = v;
  return evidence;
}

double SeamMap::unit(size_t channel) const {
  return variance_[channel] + kTrivial[channel] * kTrivial[channel];
}

SeamMap::Profile SeamMap::profile(bool upright, int centre, double from, double to) const {
  constexpr double kMargin = 0.01;  // m at both ends that are not used
  const int first = std::max(0, upright ? grid_.row(from + kMargin) : grid_.column(from + kMargin));
  const int last = std::min(upright ? grid_.height : grid_.width,
                            (upright ? grid_.row(to - kMargin) : grid_.column(to - kMargin)) + 1);
  Profile profile;
  for (int d = -Profile::kReach; d <= Profile::kReach; ++d) {
    const auto i = static_cast<size_t>(d + Profile::kReach);
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

LineEvidence SeamMap::refine(bool upright, const LineEvidence& line, double from, double to) const {
  constexpr int kReach = Profile::kReach;
  constexpr int kCore = 3;         // cells in which the line is
  constexpr double kBlur = 0.008;  // m; what beam and registration make of a thin line
  LineEvidence refined = line;
  const double origin = upright ? grid_.u0 : grid_.v0;
  for (int round = 0; round < 3; ++round) {
    const int centre = static_cast<int>(std::floor((refined.position - origin) / kFaceCell));
    const Profile p = profile(upright, centre, from, to);
    const auto side_mean = [&](const auto& values, size_t c, int first, int last) {
      double sum = 0;
      double weight = 1e-9;
      for (int d = first; d <= last; ++d) {
        const auto i = static_cast<size_t>(d + kReach);
        sum += values[i] * p.weight[c][i];
        weight += p.weight[c][i];
      }
      return sum / weight;
    };
    double step_energy = 0;
    std::array<double, 2 * kReach + 1> excursion{};
    for (size_t c = 0; c < kChannels; ++c) {
      const double left = side_mean(p.mean[c], c, -kReach, -kCore - 1);
      const double right = side_mean(p.mean[c], c, kCore + 1, kReach);
      step_energy += (right - left) * (right - left) / unit(c);
      for (int d = -kCore - 1; d <= kCore + 1; ++d) {
        const auto i = static_cast<size_t>(d + kReach);
        if (p.weight[c][i] < 1) continue;
        const double out =
            std::max({0.0, p.mean[c][i] - std::max(left, right), std::min(left, right) - p.mean[c][i]});
        excursion[i] += std::max(0.0, out * out / unit(c) - 4 / p.weight[c][i]);
      }
    }
    refined.rise =
        side_mean(p.mean[depth], depth, kCore, kReach) - side_mean(p.mean[depth], depth, -kReach, -kCore);
    const double most = *std::max_element(excursion.begin(), excursion.end());
    if (most > 0.5 * step_energy && most > 0) {
      refined.kind = LineEvidence::Kind::seam;
      double sum = 0;
      double moment = 0;
      int shown = 0;
      for (int d = -kCore - 1; d <= kCore + 1; ++d) {
        const double e = std::sqrt(excursion[static_cast<size_t>(d + kReach)] / most);
        if (e < 0.35) continue;
        ++shown;
        sum += e;
        moment += e * d;
      }
      refined.position = origin + (centre + moment / sum + 0.5) * kFaceCell;
      refined.width = std::max(0.0, shown * kFaceCell - kBlur);
    } else {
      refined.kind = LineEvidence::Kind::step;
      refined.width = 0;
      double least = 1e300;
      for (int split = -kReach + 3; split <= kReach - 2; ++split) {
        double error = 0;
        for (size_t c = 0; c < kChannels; ++c)
          for (const bool low : {true, false}) {
            const int first = low ? -kReach : split;
            const int last = low ? split - 1 : kReach;
            const double mean = side_mean(p.mean[c], c, first, last);
            for (int d = first; d <= last; ++d) {
              const auto i = static_cast<size_t>(d + kReach);
              error += p.weight[c][i] * (p.mean[c][i] - mean) * (p.mean[c][i] - mean) / unit(c);
            }
          }
        if (error < least) least = error, refined.position = origin + (centre + split) * kFaceCell;
      }
    }
    if (static_cast<int>(std::floor((refined.position - origin) / kFaceCell)) == centre) break;
  }
  return refined;
}

SeamMap::Look SeamMap::look(const FaceRect& rect) const {
  Look look;
  double cells = 0;
  double rays = 0;
  for (int y = std::max(0, grid_.row(rect.v0)); y < std::min(grid_.height, grid_.row(rect.v1) + 1); ++y)
    for (int x = std::max(0, grid_.column(rect.u0)); x < std::min(grid_.width, grid_.column(rect.u1) + 1);
         ++x) {
      const size_t cell = grid_.number(x, y);
      ++cells;
      look.known += face_[cell] > 0 ? 1 : 0;
      look.face += face_[cell] == 1 ? 1 : 0;
      rays += static_cast<double>(sums_[missing].weight[cell]);
      look.returned += static_cast<double>(sums_[missing].weight[cell] - sums_[missing].sum[cell]);
    }
  if (rays > 0) look.returned /= rays;
  if (look.known > 0) look.face /= look.known;
  if (cells > 0) look.known /= cells;
  return look;
}

std::vector<std::array<float, 2>> SeamMap::column_shares(const FaceRect& rect) const {
  std::vector<std::array<float, 2>> shares;
  for (double u = rect.u0 + kFaceCell / 2; u < rect.u1; u += kFaceCell) {
    const Look column = look({u, u, rect.v0, rect.v1});
    shares.push_back({static_cast<float>(column.known), static_cast<float>(column.face)});
  }
  return shares;
}

std::vector<std::array<float, 2>> SeamMap::row_shares(const FaceRect& rect) const {
  std::vector<std::array<float, 2>> shares;
  for (double v = rect.v0 + kFaceCell / 2; v < rect.v1; v += kFaceCell) {
    const Look row = look({rect.u0, rect.u1, v, v});
    shares.push_back({static_cast<float>(row.known), static_cast<float>(row.face)});
  }
  return shares;
}

}  // namespace loci::mapping
