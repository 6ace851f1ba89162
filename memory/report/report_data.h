#pragma once

#include <map>
#include <string>
#include <vector>

#include "memory/questions/words.h"
#include "memory/report/memory_report.h"

namespace loci::memory {

/// What the sections of a report are made from, read once.
struct ReportData {
  const Store& store;
  TimeWriter times;
  std::vector<ObjectHistory> histories = {};  ///< of the objects seen most often, in order of their number
  size_t objects = 0;                         ///< in all
  std::vector<SceneRow> scenes = {};          ///< the last ones, in order of time
  size_t scenes_in_all = 0;

  ReportData(const Store& store, const ReportOptions& options, Progress& progress);
  /// "Of 1,170 objects the 100 that were seen most often."; empty when all are here.
  std::string objects_left_out() const;
  std::string scenes_left_out() const;
};

/// "object_3", or "a false cluster".
std::string explanation_name(const std::optional<Id>& object);

/// What an observation was taken for.
struct TakenFor {
  AssociationRow chosen;
  double probability = 0;    ///< that it is this object, whatever explains that it is there
  std::string instead = {};  ///< what else it may be: "object_7 5 %, a false cluster 22 %"
};
/// By number of observation, of the chosen story.
std::map<Id, TakenFor> taken_for(const Store& store, Id scene);

/// A colour of its own per object, as CSS.
std::string object_css(Id object);

// The sections, in the order of the page; each is HTML.
std::string plan_section(const ReportData& data);
std::string timeline_section(const ReportData& data);
std::string objects_section(const ReportData& data);
std::string statistics_section(const ReportData& data, Progress& progress);
std::string decisions_section(const ReportData& data);
std::string log_section(const ReportData& data);

}  // namespace loci::memory
