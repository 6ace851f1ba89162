#pragma once

#include <QColor>
#include <QFont>
#include <QPalette>
#include <string>

#include "gui/core/text.h"

class QApplication;

namespace loci::gui {

/// The colours of the views. They follow the palette, so that light and dark desktops both look right.
struct Theme {
  bool dark = false;
  QColor text, muted, grid, panel, accent;
  QColor seen, unseen, gone;

  static Theme of(const QPalette& palette);
  QColor of_status(memory::ObjectStatus status) const;
  QColor of_event(memory::EventKind kind) const;
};

/// The font enlarged or reduced, whether its size is in points or in pixels.
QFont scaled_font(QFont font, double factor);
QFont bold_font(QFont font);
/// A point smaller, for what stands beside other things; nothing is written smaller than that.
QFont small_font(const QFont& font);

enum class ThemeChoice { system, light, dark };

/// Sets style, font and palette of the application. `system` keeps the desktop's palette; without a desktop
/// it is our light one.
void apply_theme(QApplication& application, ThemeChoice choice, bool has_desktop);

}  // namespace loci::gui
