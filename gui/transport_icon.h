#pragma once

#include <QColor>
#include <QIcon>

namespace loci::gui {

enum class Transport { first, previous, play, pause, next, last };

/// The signs of a player in the colour of the text: those of Qt are black in dark palettes too.
QIcon transport_icon(Transport sign, const QColor& color);

}  // namespace loci::gui
