#include "apps/evaluate/normals/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "apps/evaluate/normals/peers.h"
#include "apps/evaluate/normals/surfaces.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/recording/recording.h"

namespace loci::apps::normals_evaluation {
namespace {

class Ours : public Method {
 public:
  Ours(const perception::NormalOptions& options, bool corrected) : options_(options), corrected_(corrected) {}

  Estimate estimate(const cv::Mat& depth, const mapping::PinholeCamera& camera) override {
    if (corrected_ && camera != bias_camera_) {
      bias_ = measure_inclination_bias(camera, options_);
      bias_camera_ = camera;
    }
    const double begin = thread_cpu_seconds();
    smooth_depth_and_normals(depth, camera, options_, bias_, found_);
    return {found_.normals, thread_cpu_seconds() - begin};
  }

 private:
  perception::NormalOptions options_;
  bool corrected_;
  perception::InclinationBias bias_;
  mapping::PinholeCamera bias_camera_{0, 0, 0, 0, 0, 0};
  perception::DepthNormals found_;
};

/// Seconds of the fastest of some runs: what other programs do to the caches is not the method's.
double fastest(Method& method, const cv::Mat& depth, const mapping::PinholeCamera& camera) {
  constexpr int kRuns = 3;
  double seconds = std::numeric_limits<double>::infinity();
  for (int run = 0; run < kRuns; ++run) seconds = std::min(seconds, method.estimate(depth, camera).seconds);
  return seconds;
}

/// The methods, and what they did so far to one set.
class Contest {
 public:
  Contest(const ComparisonOptions& options, const perception::NormalOptions& normals) : options_(options) {
    entries_.emplace_back(kBefore, std::make_unique<Ours>(normals, false));
    entries_.emplace_back(kAfter, std::make_unique<Ours>(normals, true));
    if (!options.peers) return;
    entries_.emplace_back(kIntegralImage, pcl_integral_image());
    entries_.emplace_back(kLinearLeastSquares, pcl_linear_least_squares());
    reference_ = pcl_normal_estimation();
  }

  void begin(SetResult& set) const {
    for (const auto& entry : entries_) set.methods.emplace_back(entry.first, MethodErrors());
    if (reference_) set.methods.emplace_back(kReference, MethodErrors());
  }

  void add(const Surfaces& surfaces, const mapping::PinholeCamera& camera, SetResult& set) {
    Estimate reference;
    // The reference takes most of a second, so that it judges a part of the frames only.
    if (reference_ && set.frames < options_.reference_frames) {
      reference = reference_->estimate(surfaces.depth, camera);
      set.methods.back().second.add(reference.normals, surfaces.truth, {});
      set.methods.back().second.seconds.push_back(reference.seconds);
    }
    for (size_t i = 0; i < entries_.size(); ++i) {
      const Estimate found = entries_[i].second->estimate(surfaces.depth, camera);
      set.methods[i].second.add(found.normals, surfaces.truth, reference.normals);
      set.methods[i].second.seconds.push_back(fastest(*entries_[i].second, surfaces.depth, camera));
    }
    ++set.frames;
    set.holes += (share_of_holes(surfaces.depth) - set.holes) / set.frames;
  }

 private:
  ComparisonOptions options_;
  std::vector<std::pair<std::string, std::unique_ptr<Method>>> entries_;
  std::unique_ptr<Method> reference_;
};

DisparityNoise sensor_of(const perception::NormalOptions& normals, double sigma_px) {
  return {normals.baseline_m, normals.disparity_quantum_px, sigma_px};
}

SetResult synthetic_set(const std::string& name, double sigma_px, Contest& contest,
                        const ComparisonOptions& options, const perception::NormalOptions& normals,
                        const Random& random, Progress& progress) {
  const mapping::PinholeCamera kinect;
  SetResult set;
  set.name = name;
  set.synthetic = true;
  set.sigma_px = sigma_px;
  contest.begin(set);
  for (int i = 0; i < options.frames; ++i) {
    progress.check(static_cast<double>(i) / options.frames, name);
    Random draw = random.fork(static_cast<uint64_t>(i));
    contest.add(planar_patches(kinect, sensor_of(normals, sigma_px), draw), kinect, set);
  }
  return set;
}

SetResult recorded_set(const std::filesystem::path& path, Contest& contest, const ComparisonOptions& options,
                       const perception::NormalOptions& normals, Progress& progress) {
  const std::unique_ptr<mapping::Recording> recording = mapping::open_recording(path);
  SetResult set;
  set.name = std::filesystem::path(recording->info().path).filename().string();
  contest.begin(set);
  // Spread over the recording; those without enough holes are passed over.
  const size_t all = recording->size();
  const size_t step = std::max<size_t>(1, all / static_cast<size_t>(2 * options.real_frames));
  for (size_t i = 0; i < all && set.frames < options.real_frames; i += step) {
    progress.check(static_cast<double>(i) / static_cast<double>(all), set.name);
    const mapping::RgbdFrame frame = recording->frame(i);
    if (share_of_holes(frame.depth) < options.min_holes) continue;
    contest.add(flat_areas(frame.depth, frame.camera.depth, sensor_of(normals, 0)), frame.camera.depth, set);
  }
  if (set.frames == 0)
    throw Error(fmt::format("no frame has {:.0f} % holes", 100 * options.min_holes), {path.string(), 0, {}},
                "lower --min-holes");
  return set;
}

}  // namespace

void ComparisonOptions::declare(OptionTable& table) {
  table.integer("frames", frames, "", "Synthetic frames per level of noise.", 1, 100000);
  table.integer("reference_frames", reference_frames, "",
                "Frames of each set on which the slow PCL NormalEstimation is run.", 0, 100000);
  table.integer("real_frames", real_frames, "", "Frames of each recording.", 1, 100000);
  table.number("min_holes", min_holes, "", "Share of pixels without depth that a real frame must have.", 0,
               1);
  table.flag("peers", peers, "Runs PCL's methods beside ours.");
  table.integer("seed", seed, "", "Seed of the planes and their noise.", 0, 1 << 30);
}

const MethodErrors* SetResult::find(const std::string& method) const {
  for (const auto& each : methods)
    if (each.first == method) return &each.second;
  return nullptr;
}

Comparison compare(const std::vector<std::filesystem::path>& recordings, const ComparisonOptions& options,
                   const perception::NormalOptions& normals, Progress& progress) {
  Contest contest(options, normals);
  const Random random(static_cast<uint64_t>(options.seed));
  Comparison comparison;
  const std::pair<const char*, double> levels[] = {{"planes, no noise", 0},
                                                   {"planes, 1/16 px", 1.0 / 16},
                                                   {"planes, 1/8 px", 1.0 / 8},
                                                   {"planes, 1/4 px", 1.0 / 4}};
  for (const auto& [name, sigma] : levels)
    comparison.sets.push_back(synthetic_set(name, sigma, contest, options, normals, random, progress));
  for (const std::filesystem::path& path : recordings)
    comparison.sets.push_back(recorded_set(path, contest, options, normals, progress));
  return comparison;
}

std::string Comparison::text() const {
  std::string text;
  for (const SetResult& set : sets) {
    text += fmt::format("{}: {} frames, {:.0f} % holes{}\n", set.name, set.frames, 100 * set.holes,
                        set.synthetic ? "" : "; errors against planes fitted to flat squares");
    text += fmt::format("  {:<26}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "", "<= 1.5°", "<= 3.5°", "> 9.5°",
                        "median", "normals", "ms", "94 %");
    for (const auto& [name, errors] : set.methods) {
      if (errors.seconds.empty()) continue;
      text += fmt::format("  {:<26}{:>7.1f} %{:>7.1f} %{:>7.1f} %{:>8.2f}°{:>7.1f} %{:>9.2f}{:>9.2f}\n", name,
                          100 * errors.to_truth.within(1.5), 100 * errors.to_truth.within(3.5),
                          100 * (1 - errors.to_truth.within(9.5)), errors.to_truth.median(),
                          100 * errors.density(), errors.median_ms(), errors.quantile_ms(0.94));
    }
    const MethodErrors* ours = set.find(kAfter);
    const MethodErrors* peer = set.find(kIntegralImage);
    if (peer != nullptr)
      text += fmt::format("  {:.1f} times as fast as IntegralImage\n", peer->median_ms() / ours->median_ms());
    text += "\n";
  }
  return text;
}

Json Comparison::to_json() const {
  Json list = Json::array();
  for (const SetResult& set : sets) {
    Json json = {{"name", set.name}, {"frames", set.frames}, {"holes", set.holes}};
    if (set.synthetic) json["sigma_px"] = set.sigma_px;
    json["methods"] = Json::array();
    for (const auto& [name, errors] : set.methods) {
      if (errors.seconds.empty()) continue;
      Json bias = Json::array();
      for (int row = 0; row < InclinationHistogram::kRows; ++row)
        bias.push_back(errors.by_inclination.median(row));
      Json method = {{"method", name},
                     {"within_1_5_deg", errors.to_truth.within(1.5)},
                     {"within_3_5_deg", errors.to_truth.within(3.5)},
                     {"beyond_9_5_deg", 1 - errors.to_truth.within(9.5)},
                     {"median_deg", errors.to_truth.median()},
                     {"density", errors.density()},
                     {"ms", errors.median_ms()},
                     {"ms_of_94_percent", errors.quantile_ms(0.94)},
                     {"deviation_deg_by_inclination", bias}};
      if (errors.to_reference.count() > 0) method["median_to_reference_deg"] = errors.to_reference.median();
      json["methods"].push_back(std::move(method));
    }
    list.push_back(std::move(json));
  }
  return {{"sets", list}};
}

}  // namespace loci::apps::normals_evaluation
