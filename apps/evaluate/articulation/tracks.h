#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/articulation/articulation.h"

namespace loci::apps::articulation {

/// A track and what made it: rigid, prismatic, revolute, unknown (neither line nor circle).
struct KnownTrack {
  std::string name;
  std::string type;
  std::string confidence;  ///< of the label: high, medium, low
  mapping::Track track;
};

/// The tracks of a folder with index.csv (file, joint_type, confidence), and rigid ones made of them: of
/// every track a pose held still with noise of 2 mm, and of those with orientations the first 15 poses, which
/// have hardly begun to move.
std::vector<KnownTrack> read_known_tracks(const std::filesystem::path& folder);

struct Judged {
  std::string name, truth, confidence;
  std::string said;        ///< by fit_track
  double probability = 0;  ///< of what was said
  double of_truth = 0;     ///< that it gave to the truth
  std::string plain;       ///< by the peer
  bool right() const { return said == truth; }
};

/// The peer: least squares line and circle, and whichever has the smaller rms; no outliers, no penalty. It
/// knows no third answer.
std::string plain_decision(const mapping::Track& track);

struct TrackEvaluation {
  std::vector<Judged> tracks;

  std::string text() const;
  Json report() const;
};

TrackEvaluation evaluate_tracks(const std::vector<KnownTrack>& tracks, const mapping::TrackOptions& options);

}  // namespace loci::apps::articulation
