#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace loci {

/// What a person says about an object or a place, instead of what was said before. Rows are only added, as by
/// `loci-memory fact`, with source "user".
struct FactEdit {
  std::string about = {};                  ///< "object_12", "table_1"
  std::string key = {};                    ///< alias, class, owner
  std::optional<std::string> before = {};  ///< unset = nothing was said
  std::optional<std::string> after = {};   ///< unset = it is taken back

  FactEdit reversed() const { return {about, key, after, before}; }
};

/// The edit that makes `after` hold (empty = nothing), with what holds now as `before`.
FactEdit make_edit(const std::filesystem::path& path, const std::string& about, const std::string& key,
                   const std::string& after);
/// Writes it. Error when the file cannot be written, as while another program writes to it.
void apply_edit(const std::filesystem::path& path, const FactEdit& edit);

}  // namespace loci
