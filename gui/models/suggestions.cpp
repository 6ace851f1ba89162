#include "gui/models/suggestions.h"

#include <algorithm>

namespace loci::gui {
namespace {

constexpr size_t kAskedWhenEmpty = 4;
constexpr int kWordsOfAName = 3;

class Collector {
 public:
  explicit Collector(size_t limit) : limit_(limit) {}
  void add(const QString& text, Suggestion::Kind kind) {
    const bool known = std::any_of(found_.begin(), found_.end(),
                                   [&](const Suggestion& s) { return s.text == text && s.kind == kind; });
    if (!known && found_.size() < limit_) found_.push_back({text, kind});
  }
  std::vector<Suggestion> take() { return std::move(found_); }

 private:
  size_t limit_;
  std::vector<Suggestion> found_;
};

/// "where is the red c" becomes "where is the red cup": names that begin with the last words.
void complete_names(const QString& typed, const QStringList& names, Collector& collector) {
  const QStringList parts = typed.split(' ');
  for (int count = std::min(kWordsOfAName, static_cast<int>(parts.size())); count > 0; --count) {
    const QString tail = QStringList(parts.mid(parts.size() - count)).join(' ');
    if (tail.trimmed().isEmpty()) continue;
    const QString head = typed.left(typed.size() - tail.size());
    for (const QString& name : names)
      if (name.startsWith(tail, Qt::CaseInsensitive) && name.size() > tail.size())
        collector.add(head + name, Suggestion::Kind::word);
  }
}

bool has_all(const QString& line, const QStringList& words) {
  return std::all_of(words.begin(), words.end(),
                     [&](const QString& word) { return line.contains(word, Qt::CaseInsensitive); });
}

}  // namespace

std::vector<Suggestion> suggest(const QString& typed, const SuggestionSources& sources, size_t limit) {
  Collector collector(limit);
  const QStringList words = typed.split(' ', Qt::SkipEmptyParts);
  if (words.isEmpty()) {
    for (const QString& line : sources.asked.mid(0, kAskedWhenEmpty))
      collector.add(line, Suggestion::Kind::asked);
    for (const QString& line : sources.examples)
      if (!sources.asked.mid(0, kAskedWhenEmpty).contains(line))
        collector.add(line, Suggestion::Kind::example);
    return collector.take();
  }
  complete_names(typed, sources.words, collector);
  for (const QString& line : sources.actions)
    if (line.startsWith(typed, Qt::CaseInsensitive)) collector.add(line, Suggestion::Kind::action);
  for (const QString& line : sources.asked)
    if (has_all(line, words)) collector.add(line, Suggestion::Kind::asked);
  for (const QString& line : sources.examples)
    if (has_all(line, words)) collector.add(line, Suggestion::Kind::example);
  for (const QString& line : sources.actions)
    if (has_all(line, words)) collector.add(line, Suggestion::Kind::action);
  return collector.take();
}

}  // namespace loci::gui
