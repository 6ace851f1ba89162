#include "gui/core/theme.h"

#include <QApplication>
#include <QFontInfo>
#include <QStyleFactory>
#include <cmath>

namespace loci::gui {
namespace {

constexpr int kFontPixels = 13;

QPalette plain_palette(bool dark) {
  const QColor window = dark ? QColor(37, 39, 43) : QColor(243, 244, 246);
  const QColor base = dark ? QColor(28, 30, 33) : QColor(255, 255, 255);
  const QColor text = dark ? QColor(228, 230, 234) : QColor(29, 32, 36);
  const QColor accent = dark ? QColor(64, 140, 220) : QColor(20, 104, 196);
  const QColor faint = dark ? QColor(128, 132, 138) : QColor(140, 145, 152);
  QPalette palette(window);
  palette.setColor(QPalette::Window, window);
  palette.setColor(QPalette::Base, base);
  palette.setColor(QPalette::AlternateBase, dark ? QColor(33, 35, 39) : QColor(247, 248, 250));
  palette.setColor(QPalette::Button, dark ? QColor(52, 55, 60) : QColor(235, 237, 240));
  for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText, QPalette::ToolTipText})
    palette.setColor(role, text);
  palette.setColor(QPalette::ToolTipBase, dark ? QColor(52, 55, 60) : QColor(255, 255, 255));
  palette.setColor(QPalette::Highlight, accent);
  palette.setColor(QPalette::HighlightedText, Qt::white);
  palette.setColor(QPalette::Link, accent);
  palette.setColor(QPalette::PlaceholderText, faint);
  for (const auto role : {QPalette::WindowText, QPalette::Text, QPalette::ButtonText})
    palette.setColor(QPalette::Disabled, role, faint);
  return palette;
}

QColor mixed(const QColor& a, const QColor& b, double part_of_b) {
  const auto mix = [&](int x, int y) { return static_cast<int>(x + (y - x) * part_of_b); };
  return {mix(a.red(), b.red()), mix(a.green(), b.green()), mix(a.blue(), b.blue())};
}

}  // namespace

Theme Theme::of(const QPalette& palette) {
  Theme theme;
  const QColor& window = palette.color(QPalette::Window);
  theme.text = palette.color(QPalette::WindowText);
  theme.dark = window.lightness() < theme.text.lightness();
  theme.muted = mixed(theme.text, window, 0.42);
  theme.grid = mixed(theme.text, window, 0.80);
  theme.panel = palette.color(QPalette::Base);
  theme.accent = palette.color(QPalette::Highlight);
  theme.seen = theme.dark ? QColor(92, 190, 110) : QColor(34, 139, 60);
  theme.unseen = theme.dark ? QColor(232, 180, 80) : QColor(186, 117, 0);
  theme.gone = theme.dark ? QColor(235, 105, 100) : QColor(190, 45, 45);
  return theme;
}

QColor Theme::of_status(memory::ObjectStatus status) const {
  switch (status) {
    case memory::ObjectStatus::seen:
      return seen;
    case memory::ObjectStatus::missed:
    case memory::ObjectStatus::hidden:
    case memory::ObjectStatus::out_of_view:
      return unseen;
    case memory::ObjectStatus::gone:
      return gone;
  }
  return muted;
}

QColor Theme::of_event(memory::EventKind kind) const {
  switch (kind) {
    case memory::EventKind::appeared:
    case memory::EventKind::reappeared:
      return seen;
    case memory::EventKind::gone:
      return gone;
    case memory::EventKind::hidden:
      return unseen;
    case memory::EventKind::moved:
    case memory::EventKind::place_moved:
      return accent;
    case memory::EventKind::looks_different:
    case memory::EventKind::joint_changed:
      break;
  }
  return dark ? QColor(180, 140, 230) : QColor(120, 70, 180);
}

QFont scaled_font(QFont font, double factor) {
  if (font.pointSizeF() > 0)
    font.setPointSizeF(font.pointSizeF() * factor);
  else
    font.setPixelSize(static_cast<int>(font.pixelSize() * factor + 0.5));
  return font;
}

QFont bold_font(QFont font) {
  font.setBold(true);
  return font;
}

QFont small_font(const QFont& font) {
  const double points = QFontInfo(font).pointSizeF();
  if (font.pointSizeF() > 0) return scaled_font(font, (points - 1) / points);
  QFont small = font;
  small.setPixelSize(static_cast<int>(std::ceil(font.pixelSize() * (points - 1) / points)));
  return small;
}

void apply_theme(QApplication& application, ThemeChoice choice, bool has_desktop) {
  application.setStyle(QStyleFactory::create("Fusion"));
  if (!has_desktop) {
    // Qt then guesses sizes for fonts that depend on the platform: here the same window everywhere.
    QFont font("DejaVu Sans");
    font.setPixelSize(kFontPixels);
    QApplication::setFont(font);
  }
  if (choice == ThemeChoice::system && has_desktop) return;
  application.setPalette(plain_palette(choice == ThemeChoice::dark));
}

}  // namespace loci::gui
