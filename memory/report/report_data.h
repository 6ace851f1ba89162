#pragma once

#include <map>
#include <string>
#include <vector>

#include "memory/questions/location.h"
#include "memory/report/memory_report.h"

namespace loci::memory {

/// The input of the sections of a report, read once.
struct ReportData {
  const Store& store;
  TimeWriter times;
  std::vector<ObjectHistory> histories = {};  ///< of the objects with most observations, in order of id
  size_t objects = 0;                         ///< of the memory
  std::vector<SceneRow> scenes = {};          ///< the last ones, in order of time
  size_t scenes_in_all = 0;
  std::map<Id, std::string> colors = {};  ///< of objects as they were seen last, as CSS

  ReportData(const Store& store, const ReportOptions& options, Progress& progress);
  /// The colour of an object, as the browser shows it, too; grey where it is unknown.
  std::string css_of(Id object) const;
  /// "Of 1,170 objects the 100 that were seen most often."; empty when all are here.
  std::string objects_left_out() const;
  std::string scenes_left_out() const;
};

/// "object_3", or "clutter".
std::string partner_name(const std::optional<Id>& object);

/// The association of an observation by the MAP hypothesis.
struct ChosenAssociation {
  AssociationRow chosen;
  double probability = 0;         ///< of this object, all explanations together
  std::string alternatives = {};  ///< "object_7 5 %, clutter 22 %"
};
/// By observation.
std::map<Id, ChosenAssociation> chosen_associations(const Store& store, Id scene);

/// "out of view".
std::string status_text(ObjectStatus status);

// The sections, in the order of the page; each is HTML.
std::string plan_section(const ReportData& data);
std::string timeline_section(const ReportData& data);
std::string objects_section(const ReportData& data);
std::string statistics_section(const ReportData& data, Progress& progress);
std::string decisions_section(const ReportData& data);
std::string log_section(const ReportData& data);

}  // namespace loci::memory
