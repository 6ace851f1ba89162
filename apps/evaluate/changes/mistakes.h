#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "apps/evaluate/changes/comparison.h"

namespace loci::apps::changes {

/// How many mistakes a page shows.
inline constexpr size_t kShownMistakes = 10;

/// What an observation may have been.
struct Competitor {
  std::string name;  ///< of the object, or "false cluster"
  double probability = 0;
};

/// An image of one end of a transition: the true box green, the box of the remembered object magenta.
struct MistakeView {
  int64_t frame = 0;
  cv::Mat image = {};  ///< CV_8UC3, BGR; empty where nothing is to be seen
};

/// A wrong transition, and why it was taken for what it was not.
struct Mistake {
  std::string recording;
  JudgedTransition transition;
  double stated = 0;  ///< probability of what was stated; 0 where nothing was, as no cluster was found
  std::vector<Competitor> competitors = {};  ///< most probable first
  MistakeView before = {}, after = {};
};

/// The wrong transitions of a memory's story that were stated with the highest probability, these first;
/// kShownMistakes at most.
std::vector<Mistake> worst_mistakes(const Comparison& comparison, const Truth& truth, const Moments& moments,
                                    const Story& story, const mapping::Recording& recording);
/// The same of a memory of a recording in `folder`.
std::vector<Mistake> worst_mistakes(const Comparison& comparison, const std::filesystem::path& folder,
                                    const mapping::Recording& recording, const memory::Store& store);

/// The worst of several recordings as one page without external files.
std::string mistakes_page(std::vector<Mistake> mistakes);

inline constexpr const char* kMistakesFile = "mistakes.html";

}  // namespace loci::apps::changes
