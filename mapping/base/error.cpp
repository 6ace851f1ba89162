#include "mapping/base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "mapping/base/text/text.h"

namespace loci {
namespace {

constexpr size_t kMaxText = 4000;  ///< bytes of an error's line: it may quote a hostile file
constexpr size_t kMaxName = 200;   ///< bytes of a name that a near one is looked for

size_t edit_distance(std::string_view first, std::string_view second) {
  const std::string a = lower_case(first), b = lower_case(second);
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const bool same = a[i - 1] == b[j - 1];
      const size_t replaced = diagonal + (same ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
    }
  }
  return row[b.size()];
}

}  // namespace

std::string FileLocation::text() const {
  std::string text = file;
  if (line > 0 && !file.empty()) text += fmt::format(":{}", line);
  if (!key.empty()) text += text.empty() ? key : ": " + key;
  return text;
}

Error::Error(std::string what, FileLocation location, std::string hint)
    : message_(std::move(what)), location_(std::move(location)), hint_(std::move(hint)) {
  const std::string where = location_.text();
  text_ = where.empty() ? message_ : where + ": " + message_;
  if (!hint_.empty()) text_ += "; " + hint_;
  if (text_.size() > kMaxText) text_.replace(kMaxText / 2, text_.size() - kMaxText, " … ");
  std::replace_if(
      text_.begin(), text_.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
}

void Warnings::add(std::string text, const FileLocation& location) {
  const std::string where = location.text();
  texts_.push_back(where.empty() ? std::move(text) : where + ": " + text);
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
  std::string best;
  if (name.size() > kMaxName) return best;
  size_t best_distance = std::max<size_t>(2, name.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    if (candidate.size() >= name.size() + best_distance) continue;
    const size_t distance = edit_distance(name, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_name(name, candidates);
  return nearest.empty() ? "" : fmt::format("did you mean '{}'?", nearest);
}

}  // namespace loci
