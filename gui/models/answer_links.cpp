#include "gui/models/answer_links.h"

#include <QRegularExpression>
#include <algorithm>

namespace loci::gui {
namespace {

const QString kTime = R"((?:\d{4}-\d\d-\d\d )?\b\d\d:\d\d(?::\d\d(?:\.\d+)?)?\b)";

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

}  // namespace loci::gui
