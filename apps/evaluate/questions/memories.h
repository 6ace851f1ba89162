#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "mapping/base/error.h"
#include "mapping/base/progress.h"
#include "memory/store/store.h"

namespace loci::apps::questions {

/// Which object of the simulation each object of a memory is: the one near which most of its observations
/// are.
using TrueNames = std::map<memory::Id, std::string>;

/// Objects that the simulation draws alike, by the first of them: nobody can tell which of them an answer
/// means.
using Twins = std::map<std::string, std::string>;

struct AskedMemory {
  std::filesystem::path file = {};
  TrueNames names = {};
  Twins twins = {};
};

/// Where scenarios are.
struct AskedFolders {
  std::filesystem::path samples = {};  ///< of day.yaml and the household's taxonomy
  std::filesystem::path days = {};     ///< of further days
};

/// Makes a memory of the tables in `folder`, unless it is there: the sample day perceived (plain), the same
/// with its objects named by class as people would and the household's taxonomy (day), and the scenario that
/// is called so in `from.days`, named likewise. Those were drawn by `loci-evaluate days` and are kept as
/// files, as the truth of the tables is that of these days.
AskedMemory asked_memory(const std::string& name, const std::filesystem::path& folder,
                         const AskedFolders& from, int threads, Progress& progress, Warnings& warnings);

}  // namespace loci::apps::questions
