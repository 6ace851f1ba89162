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

}  // namespace loci::gui
