#pragma once

#include <filesystem>
#include <vector>

namespace loci::perception::generator {

/// Writes a page (Markdown) that lists the types of the files with their features. Throws loci::Error.
void write_docs(const std::filesystem::path& output, const std::vector<std::filesystem::path>& files);

}  // namespace loci::perception::generator
