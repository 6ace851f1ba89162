#pragma once

#include <string>

#include "nbv/survey.h"

namespace loci {

/// The map's report with the story of the exploration before it: every scan with its reason, overlap,
/// coverage, times and pictures of the plan (Fig. 7.2, 7.4), and every pull with what it showed.
std::string survey_report(const SurveyResult& result, const std::string& input);

}  // namespace loci
