#include "apps/evaluate/articulation/tracks.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/random.h"
#include "mapping/base/text/csv.h"
#include "mapping/base/text/json.h"

namespace loci::apps::articulation {
namespace {

constexpr size_t kStillPoses = 15;
constexpr size_t kHeldPoses = 60;
constexpr double kHeldNoise = 0.002;

mapping::Track first_poses(const mapping::Track& track, size_t count) {
  mapping::Track first;
  count = std::min(count, track.positions.size());
  first.positions.assign(track.positions.begin(),
                         track.positions.begin() + static_cast<std::ptrdiff_t>(count));
  if (!track.orientations.empty())
    first.orientations.assign(track.orientations.begin(),
                              track.orientations.begin() + static_cast<std::ptrdiff_t>(count));
  return first;
}

mapping::Track held_pose(const mapping::Track& track, Random random) {
  mapping::Track held;
  for (size_t i = 0; i < kHeldPoses; ++i) {
    const Vector3d noise(random.normal(kHeldNoise), random.normal(kHeldNoise), random.normal(kHeldNoise));
    held.positions.push_back(track.positions.front() + noise);
  }
  return held;
}

/// Counts by something, in the order of first use.
struct Tally {
  size_t count = 0, right = 0, plain_right = 0;
  double probability = 0;
};

Json to_json(const Tally& tally) {
  return {{"tracks", tally.count},
          {"right", tally.right},
          {"plain_right", tally.plain_right},
          {"mean_probability_of_truth", tally.probability / static_cast<double>(tally.count)}};
}

std::map<std::string, Tally> tallies(const std::vector<Judged>& tracks) {
  std::map<std::string, Tally> all;
  for (const Judged& judged : tracks) {
    Tally& tally = all[judged.confidence];
    ++tally.count;
    tally.right += judged.right();
    tally.plain_right += judged.plain == judged.truth;
    tally.probability += judged.of_truth;
  }
  return all;
}

/// How often what was said with a probability in each tenth was right.
std::array<Tally, 10> calibration(const std::vector<Judged>& tracks) {
  std::array<Tally, 10> bins;
  for (const Judged& judged : tracks) {
    Tally& bin = bins[std::min<size_t>(9, static_cast<size_t>(judged.probability * 10))];
    ++bin.count;
    bin.right += judged.right();
    bin.probability += judged.probability;
  }
  return bins;
}

std::map<std::string, std::map<std::string, size_t>> confusion(const std::vector<Judged>& tracks,
                                                               const std::string& confidence) {
  std::map<std::string, std::map<std::string, size_t>> table;
  for (const Judged& judged : tracks)
    if (judged.confidence == confidence) ++table[judged.truth][judged.said];
  return table;
}

}  // namespace

std::vector<KnownTrack> read_known_tracks(const std::filesystem::path& folder) {
  const CsvTable index = CsvTable::read(folder / "index.csv");
  const size_t file = index.require_column("file"), type = index.require_column("joint_type"),
               confidence = index.require_column("confidence");
  std::vector<KnownTrack> tracks, still;
  for (size_t row = 0; row < index.rows(); ++row) {
    KnownTrack known{index.cell(row, file), index.cell(row, type), index.cell(row, confidence), {}};
    if (known.type == "rotational") known.type = "revolute";
    known.track = mapping::read_track(folder / known.name);
    still.push_back({known.name + ", one pose held", "rigid", "made", held_pose(known.track, Random(row))});
    if (!known.track.orientations.empty() && known.confidence == "high")
      still.push_back({known.name + ", first poses", "rigid", "made", first_poses(known.track, kStillPoses)});
    tracks.push_back(std::move(known));
  }
  for (KnownTrack& track : still) tracks.push_back(std::move(track));
  return tracks;
}

std::string plain_decision(const mapping::Track& track) {
  Vector3d mean = Vector3d::Zero();
  const double count = static_cast<double>(track.positions.size());
  for (const Vector3d& p : track.positions) mean += p / count;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Vector3d& p : track.positions) scatter += (p - mean) * (p - mean).transpose() / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
  const double line_square = solver.eigenvalues()[0] + solver.eigenvalues()[1];

  Eigen::MatrixXd rows(track.positions.size(), 3);
  Eigen::VectorXd squares(track.positions.size());
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Vector3d p = solver.eigenvectors().transpose() * (track.positions[static_cast<size_t>(i)] - mean);
    rows.row(i) << 2 * p[2], 2 * p[1], 1;
    squares[i] = p[1] * p[1] + p[2] * p[2];
  }
  const Vector3d solution = rows.colPivHouseholderQr().solve(squares);
  const double radius = std::sqrt(std::max(solution[2] + solution.head<2>().squaredNorm(), 0.0));
  double circle_square = solver.eigenvalues()[0];
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const Vector2d off(rows(i, 0) / 2 - solution[0], rows(i, 1) / 2 - solution[1]);
    circle_square += std::pow(off.norm() - radius, 2) / count;
  }
  return circle_square < line_square ? "revolute" : "prismatic";
}

TrackEvaluation evaluate_tracks(const std::vector<KnownTrack>& tracks, const mapping::TrackOptions& options) {
  TrackEvaluation evaluation;
  for (const KnownTrack& known : tracks) {
    const Json answer = fit_track(known.track, options).report();
    const std::string said = answer["type"].get<std::string>();
    evaluation.tracks.push_back(
        {known.name, known.type, known.confidence, said, answer["probabilities"][said].get<double>(),
         answer["probabilities"][known.type].get<double>(), plain_decision(known.track)});
  }
  return evaluation;
}

std::string TrackEvaluation::text() const {
  std::string text = "label        tracks  right  probability of the truth  right by least rms\n";
  for (const auto& [confidence, tally] : tallies(tracks))
    text += fmt::format("{:<12} {:>6} {:>6} {:>25.2f} {:>19}\n", confidence, tally.count, tally.right,
                        tally.probability / static_cast<double>(tally.count), tally.plain_right);
  for (const auto& [confidence, unused] : tallies(tracks)) {
    text += "\n" + confidence + ": truth, said, tracks\n";
    for (const auto& [truth, row] : confusion(tracks, confidence))
      for (const auto& [said, count] : row) text += fmt::format("  {:<10} {:<10} {}\n", truth, said, count);
  }
  text += "\nsaid with probability, right, tracks\n";
  for (const Tally& bin : calibration(tracks))
    if (bin.count > 0)
      text += fmt::format("  {:.2f} {:>6.2f} {:>5}\n", bin.probability / static_cast<double>(bin.count),
                          static_cast<double>(bin.right) / static_cast<double>(bin.count), bin.count);
  for (const Judged& judged : tracks)
    if (!judged.right())
      text += fmt::format("\n{} ({}): {} said {} ({:.2f}; {:.2f} for the truth)", judged.name,
                          judged.confidence, judged.truth, judged.said, judged.probability, judged.of_truth);
  return text + "\n";
}

Json TrackEvaluation::report() const {
  Json json{{"labels", Json::object()}, {"calibration", Json::array()}, {"tracks", Json::array()}};
  for (const auto& [confidence, tally] : tallies(tracks)) {
    json["labels"][confidence] = to_json(tally);
    json["labels"][confidence]["confusion"] = confusion(tracks, confidence);
  }
  for (const Tally& bin : calibration(tracks))
    if (bin.count > 0)
      json["calibration"].push_back(
          {{"probability", bin.probability / static_cast<double>(bin.count)},
           {"right", static_cast<double>(bin.right) / static_cast<double>(bin.count)},
           {"tracks", bin.count}});
  for (const Judged& judged : tracks)
    json["tracks"].push_back({{"name", judged.name},
                              {"truth", judged.truth},
                              {"label", judged.confidence},
                              {"said", judged.said},
                              {"probability", judged.probability},
                              {"probability_of_truth", judged.of_truth},
                              {"least_rms", judged.plain}});
  return json;
}

}  // namespace loci::apps::articulation
