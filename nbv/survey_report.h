#pragma once

#include <filesystem>
#include <string>

#include "nbv/survey.h"

namespace loci::nbv {

/// The map's report with the story of the exploration before it: every scan with its reason, overlap,
/// coverage, times and images of the plan (Fig. 7.2, 7.4), and every pull with what it showed.
/// `folder` is that of the survey.
std::string survey_report(const SurveyResult& result, const std::filesystem::path& folder);

/// Where the images of the plan after a step are.
std::filesystem::path plan_folder(const std::filesystem::path& folder, size_t step);

}  // namespace loci::nbv
