#include "mapping/simulation/laser_sweep.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"

namespace loci::mapping {
namespace {

using Eigen::Vector3f;

/// What comes back along a sub-ray, or what a beam makes of its sub-rays.
struct Echo {
  float range = 0;
  float intensity = 0;
  Vector3f color = Vector3f::Zero();  ///< red, green, blue, of 255
};

class Beam {
 public:
  Beam(const RayScene& scene, const LaserModel& laser, const Isometry3d& map_from_scanner)
      : scene_(scene),
        laser_(laser),
        rotation_(map_from_scanner.linear()),
        origin_(map_from_scanner.translation().cast<float>()),
        half_width_(laser.beam_width_deg / 2 * kDegree),
        glossy_cos_(static_cast<float>(std::cos(laser.glossy_incidence_max_deg * kDegree))) {}

  /// What the scanner makes of one beam, without the noise of its numbers; nothing = no return.
  std::optional<Echo> measure(const Vector3d& direction, Random& random) const {
    const Vector3d left = Vector3d(-direction.y(), direction.x(), 0).normalized() * half_width_;
    const Vector3d up = direction.cross(left);
    std::array<Echo, 5> echoes;
    size_t count = 0;
    for (const Vector3d& offset : {Vector3d(0, 0, 0), left, Vector3d(-left), up, Vector3d(-up)})
      if (const auto echo = sub_ray((direction + offset).normalized())) echoes[count++] = *echo;
    if (count == 0) return std::nullopt;
    const auto [nearest, farthest] =
        std::minmax_element(echoes.begin(), echoes.begin() + static_cast<std::ptrdiff_t>(count),
                            [](const Echo& a, const Echo& b) { return a.range < b.range; });
    const bool spread = farthest->range - nearest->range > static_cast<float>(laser_.mixed_spread_m);
    if (spread && random.uniform() >= laser_.mixed_probability) return *nearest;
    Echo mean;
    for (size_t i = 0; i < count; ++i) {
      mean.range += echoes[i].range / static_cast<float>(count);
      mean.intensity += echoes[i].intensity / static_cast<float>(count);
      mean.color += echoes[i].color / static_cast<float>(count);
    }
    return mean;
  }

 private:
  std::optional<Echo> sub_ray(const Vector3d& direction) const {
    const Vector3f in_map = (rotation_ * direction).cast<float>();
    const RayHit hit = scene_.cast(origin_, in_map, static_cast<float>(laser_.range_max_m));
    if (hit.link < 0) return std::nullopt;
    const float cosine = -hit.normal.dot(in_map);
    if (hit.glossy && cosine < glossy_cos_) return std::nullopt;
    const Vector3f color(hit.color[0], hit.color[1], hit.color[2]);
    const float intensity = color.dot(Vector3f(0.2126f, 0.7152f, 0.0722f)) / 255 * cosine;
    if (intensity < static_cast<float>(laser_.min_reflectance)) return std::nullopt;
    return Echo{hit.distance, intensity, color};
  }

  const RayScene& scene_;
  const LaserModel& laser_;
  Eigen::Matrix3d rotation_;
  Vector3f origin_;
  double half_width_;
  float glossy_cos_;
};

uint8_t noisy_byte(float value, double sigma, Random& random) {
  return static_cast<uint8_t>(std::lround(std::clamp(value + random.normal(sigma), 0., 255.)));
}

void measure_line(const Beam& beam, const LaserModel& laser, int tilt, Random random,
                  std::vector<ScanPoint>& points) {
  points.reserve(static_cast<size_t>(laser.azimuths()));
  for (int azimuth = 0; azimuth < laser.azimuths(); ++azimuth) {
    const Vector3d direction = laser.direction(azimuth, tilt);
    const std::optional<Echo> echo = beam.measure(direction, random);
    ScanPoint point;
    point.returned = echo.has_value();
    double range = laser.range_max_m;
    if (echo) {
      if (echo->range < laser.range_min_m) continue;
      range = echo->range + random.normal(laser.range_sigma_m);
      point.intensity = static_cast<float>(echo->intensity + random.normal(laser.intensity_sigma));
      point.r = noisy_byte(echo->color[0], laser.color_sigma, random);
      point.g = noisy_byte(echo->color[1], laser.color_sigma, random);
      point.b = noisy_byte(echo->color[2], laser.color_sigma, random);
    }
    point.position = (range * direction).cast<float>();
    points.push_back(point);
  }
}

}  // namespace

Scan simulate_sweep(const RayScene& scene, const Isometry3d& map_from_scanner, const LaserModel& laser,
                    const Random& random, int threads) {
  const Beam beam(scene, laser, map_from_scanner);
  std::vector<std::vector<ScanPoint>> lines(static_cast<size_t>(laser.tilts()));
  parallel_for(lines.size(), threads, [&](size_t begin, size_t end) {
    for (size_t line = begin; line < end; ++line)
      measure_line(beam, laser, static_cast<int>(line), random.fork(line), lines[line]);
  });
  Scan scan;
  scan.map_from_scan = map_from_scanner;
  scan.origins.emplace_back(Vector3f::Zero());
  for (const auto& line : lines) scan.points.insert(scan.points.end(), line.begin(), line.end());
  return scan;
}

}  // namespace loci::mapping
