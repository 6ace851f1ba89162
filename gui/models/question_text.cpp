#include "gui/models/question_text.h"

#include <QRegularExpression>
#include <algorithm>

namespace loci::gui {
namespace {

/// With the offset of an hour that clocks showed twice: "02:30+02:00".
const QString kTime = R"((?:\d{4}-\d\d-\d\d )?\b\d\d:\d\d(?::\d\d(?:\.\d+)?)?(?:[+-]\d\d:\d\d)?\b)";

/// One expression for all that can be clicked; longer place names first, so that none hides another.
QRegularExpression clickable(QStringList places) {
  std::sort(places.begin(), places.end(), [](const QString& a, const QString& b) {
    return a.size() != b.size() ? a.size() > b.size() : a < b;
  });
  QStringList names;
  for (const QString& place : places)
    if (!place.isEmpty()) names << QRegularExpression::escape(place);
  QString pattern = "(?<object>\\bobject_\\d+\\b)|(?<time>" + kTime + ")";
  if (!names.isEmpty()) pattern += "|(?<place>\\b(?:" + names.join('|') + ")\\b)";
  return QRegularExpression(pattern);
}

QString link(const QRegularExpressionMatch& match) {
  const QString text = match.captured();
  QString target = "place:" + text;
  if (!match.captured("object").isEmpty()) target = "object:" + text.mid(7);
  if (!match.captured("time").isEmpty()) target = "time:" + text;
  return QString("<a href=\"%1\">%2</a>").arg(target.toHtmlEscaped(), text.toHtmlEscaped());
}

}  // namespace

QString linked_text(const QString& plain, const QStringList& places) {
  QString html;
  int end = 0;
  for (auto all = clickable(places).globalMatch(plain); all.hasNext();) {
    const auto match = all.next();
    html += plain.mid(end, match.capturedStart() - end).toHtmlEscaped() + link(match);
    end = match.capturedEnd();
  }
  return html + plain.mid(end).toHtmlEscaped();
}

std::vector<int64_t> objects_named(const QString& plain) {
  static const QRegularExpression kObject(R"(\bobject_(\d+)\b)");
  std::vector<int64_t> objects;
  for (auto all = kObject.globalMatch(plain); all.hasNext();) {
    const int64_t id = all.next().captured(1).toLongLong();
    if (std::find(objects.begin(), objects.end(), id) == objects.end()) objects.push_back(id);
  }
  return objects;
}

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
