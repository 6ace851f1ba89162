#include "gui/data/memory_verify.h"

#include <fmt/format.h>

#include "memory/store/store.h"

namespace loci::gui {

std::string verify_memory(const std::filesystem::path& path, Progress& progress) {
  memory::VerifyReport report;
  try {
    report = memory::Store::open_read(path).verify(progress);
  } catch (const Interrupted&) {
    throw;
  } catch (const Error& error) {
    return fmt::format("It cannot be read at all: {}", error.what());
  }
  std::string text =
      report.problems.empty() ? "It is sound." : fmt::format("{} problem(s):", report.problems.size());
  for (const std::string& problem : report.problems) text += "\n" + problem;
  text += fmt::format("\nSchema {}.{}:", report.major, report.minor);
  for (const auto& [table, count] : report.counts)
    if (count > 0) text += fmt::format(" {} {},", count, table);
  text.back() = '.';
  return text;
}

}  // namespace loci::gui
