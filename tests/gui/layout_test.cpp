// How the window is laid out: at the sizes that are promised, light and dark, with every dock in front.

#include <QAbstractButton>
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QScrollArea>
#include <QToolBar>
#include <QToolButton>
#include <cmath>

#include "gui/core/theme.h"
#include "gui/views/compare_view.h"
#include "gui/views/scene_view.h"
#include "gui/views/timeline/time_bar.h"
#include "tests/gui/window_fixture.h"

namespace loci::gui {
namespace {

struct Look {
  QSize size;
  ThemeChoice theme;
};

std::ostream& operator<<(std::ostream& out, const Look& look) {
  return out << look.size.width() << "x" << look.size.height()
             << (look.theme == ThemeChoice::dark ? " dark" : " light");
}

class Layout : public test::BrowserWindow, public testing::WithParamInterface<Look> {
 protected:
  Layout() : test::BrowserWindow(MapBackend::memory) {
    apply_theme(*static_cast<QApplication*>(QApplication::instance()), GetParam().theme, false);
    window.resize(GetParam().size);
    choose(2);
    QTest::qWait(50);
  }
  ~Layout() override {
    apply_theme(*static_cast<QApplication*>(QApplication::instance()), ThemeChoice::light, false);
  }

  static QString name_of(const QWidget* widget, const QString& text) {
    return QString("%1 '%2' in %3")
        .arg(widget->metaObject()->className(), text, widget->parentWidget()->metaObject()->className());
  }
  /// Texts that have less room than they need. What scrolls, wraps or ends in "…" does not count.
  QStringList clipped() const {
    QStringList found;
    for (const QWidget* widget : window.findChildren<QWidget*>()) {
      if (!is_seen(widget)) continue;
      QString text;
      if (const auto* label = qobject_cast<const QLabel*>(widget)) {
        if (label->wordWrap() || label->sizePolicy().horizontalPolicy() == QSizePolicy::Ignored) continue;
        text = label->text();
      } else if (const auto* button = qobject_cast<const QAbstractButton*>(widget)) {
        text = button->text();
      }
      if (text.isEmpty() || text.endsWith("…")) continue;
      if (widget->width() < widget->minimumSizeHint().width() ||
          widget->height() < widget->fontMetrics().height())
        found << name_of(widget, text);
    }
    return found;
  }
  /// Texts whose letters are smaller than those of the application by more than a point.
  QStringList tiny() const {
    const double least = QFontInfo(QApplication::font()).pointSizeF() - 1;
    QStringList found;
    for (const QWidget* widget : window.findChildren<QWidget*>()) {
      const double size = QFontInfo(widget->font()).pointSizeF();
      if (is_seen(widget) && size < least - 0.01)
        found << QString("%1: %2 of %3 points")
                     .arg(name_of(widget, widget->objectName()))
                     .arg(size)
                     .arg(least + 1);
    }
    return found;
  }
  bool is_seen(const QWidget* widget) const {
    return widget->isVisible() && !widget->visibleRegion().isEmpty() && widget->parentWidget() != nullptr;
  }
  /// Siblings that lie over each other, as far as both say something.
  QStringList overlapping() const {
    QStringList found;
    std::vector<const QWidget*> all;
    for (const QWidget* widget : window.findChildren<QWidget*>())
      if (is_seen(widget) && (qobject_cast<const QLabel*>(widget) != nullptr ||
                              qobject_cast<const QAbstractButton*>(widget) != nullptr ||
                              qobject_cast<const QComboBox*>(widget) != nullptr))
        all.push_back(widget);
    for (size_t i = 0; i < all.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        if (all[i]->parentWidget() == all[j]->parentWidget() &&
            all[i]->geometry().intersects(all[j]->geometry()))
          found << QString(all[i]->metaObject()->className()) + " over " + all[j]->metaObject()->className() +
                       " in " + all[i]->parentWidget()->metaObject()->className();
    return found;
  }
  /// As the Web Content Accessibility Guidelines have it: from 1 (the same) to 21.
  static double contrast(const QColor& one, const QColor& other) {
    const auto luminance = [](const QColor& color) {
      const auto linear = [](double part) {
        return part <= 0.03928 ? part / 12.92 : std::pow((part + 0.055) / 1.055, 2.4);
      };
      return 0.2126 * linear(color.redF()) + 0.7152 * linear(color.greenF()) + 0.0722 * linear(color.blueF());
    };
    const double a = luminance(one), b = luminance(other);
    return (std::max(a, b) + 0.05) / (std::min(a, b) + 0.05);
  }
};

TEST_P(Layout, NothingIsClippedOrLiesOverSomethingElseInAnyDock) {
  for (const char* dock : {"identity", "compare", "statistics", "log", "tools3d", "objects", "selection"}) {
    window.docks().show(dock);
    settle();
    QTest::qWait(20);
    EXPECT_EQ(window.size(), GetParam().size) << dock;
    EXPECT_TRUE(clipped().isEmpty()) << dock << ": " << clipped().join("; ").toStdString();
    EXPECT_TRUE(overlapping().isEmpty()) << dock << ": " << overlapping().join("; ").toStdString();
    EXPECT_TRUE(tiny().isEmpty()) << dock << ": " << tiny().join("; ").toStdString();
  }
  window.docks().show("compare");
  window.docks().compare().beside_box()->setChecked(true);
  settle();
  EXPECT_TRUE(clipped().isEmpty()) << clipped().join("; ").toStdString();
  EXPECT_EQ(window.size(), GetParam().size) << "both maps";
  EXPECT_GE(window.maps().then()->width(), 200);
}

TEST_P(Layout, WhatIsWrittenCanBeRead) {
  const QPalette colors = QApplication::palette();
  const Theme theme = Theme::of(colors);
  const QFont font = QApplication::font();
  EXPECT_GE(QFontInfo(small_font(font)).pointSizeF(), QFontInfo(font).pointSizeF() - 1) << "what is painted";
  EXPECT_GE(contrast(colors.color(QPalette::WindowText), colors.color(QPalette::Window)), 7);
  EXPECT_GE(contrast(colors.color(QPalette::HighlightedText), colors.color(QPalette::Highlight)), 3);
  for (const QColor& color : {theme.seen, theme.unseen, theme.gone, theme.muted})
    EXPECT_GE(contrast(color, theme.panel), 3) << color.name().toStdString();
}

TEST_P(Layout, TheFirstViewHasEverythingInView) {
  window.screenshot();
  EXPECT_EQ(window.map().scene().shown_labels().size(), window.map().scene().objects().size());
}

TEST_P(Layout, AnEmptyWindowSaysInEachDockWhatToDo) {
  window.show_data(nullptr);
  settle();
  for (const char* dock : {"identity", "compare", "statistics", "log", "tools3d", "objects", "selection"}) {
    window.docks().show(dock);
    settle();
    EXPECT_TRUE(clipped().isEmpty()) << dock << ": " << clipped().join("; ").toStdString();
  }
  EXPECT_NO_THROW(window.screenshot());
}

INSTANTIATE_TEST_SUITE_P(At, Layout,
                         testing::Values(Look{{1280, 800}, ThemeChoice::light},
                                         Look{{1280, 800}, ThemeChoice::dark},
                                         Look{{1920, 1080}, ThemeChoice::light},
                                         Look{{1920, 1080}, ThemeChoice::dark}),
                         [](const auto& look) {
                           return QString("%1x%2%3")
                               .arg(look.param.size.width())
                               .arg(look.param.size.height())
                               .arg(look.param.theme == ThemeChoice::dark ? "Dark" : "Light")
                               .toStdString();
                         });

}  // namespace
}  // namespace loci::gui
