#include <gtest/gtest.h>

#include <QVTKOpenGLNativeWidget.h>
#include <QStandardPaths>
#include <QSurfaceFormat>

#include "gui/core/task_timer.h"
#include "gui/core/theme.h"

int main(int argc, char** argv) {
  QSurfaceFormat format = QVTKOpenGLNativeWidget::defaultFormat();
  format.setSamples(0);
  QSurfaceFormat::setDefaultFormat(format);
  QStandardPaths::setTestModeEnabled(true);
  testing::InitGoogleTest(&argc, argv);
  loci::gui::TimedApplication application(argc, argv);
  QApplication::setOrganizationName("loci-test");
  loci::gui::apply_theme(application, loci::gui::ThemeChoice::light, false);
  return RUN_ALL_TESTS();
}
