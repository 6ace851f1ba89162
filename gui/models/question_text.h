#pragma once

#include <QString>
#include <QStringList>
#include <vector>

namespace loci::gui {

/// Plain words as HTML in which objects ("object_12"), places and times are links: "object:12",
/// "place:table_1", "time:08:30:00". Line breaks and indents stay.
QString linked_text(const QString& plain, const QStringList& places);
/// Ids of the objects named in a text, each once, in order.
std::vector<int64_t> objects_named(const QString& plain);

/// A line that may be taken instead of typing on.
struct Suggestion {
  enum class Kind { asked, example, word, action };
  QString text;
  Kind kind = Kind::example;
};

/// What suggestions are made of.
struct SuggestionSources {
  QStringList asked;     ///< earlier questions, newest first
  QStringList examples;  ///< questions that are understood
  QStringList words;     ///< names of objects and places
  QStringList actions;   ///< what the window can do
};

/// Lines that fit what was typed, best first: words that complete the last ones, then questions and actions
/// with all of what was typed in them. Nothing typed: the last questions, then examples.
std::vector<Suggestion> suggest(const QString& typed, const SuggestionSources& sources, size_t limit);

}  // namespace loci::gui
