#pragma once

#include <QObject>
#include <functional>
#include <string>

#include "gui/data/browser.h"

class QWidget;

namespace loci::gui {

/// Writes what is selected, or all of it, to files that a person names. Each has a twin on the command line.
class Exporter : public QObject {
  Q_OBJECT

 public:
  Exporter(Browser& browser, QWidget* window);

  /// What is believed of the selected object or place, else of all, as CSV or JSON.
  void table();
  void object_images();
  void scene_image();
  /// Points of the selected object, else of the scene, as PLY.
  void points();
  void map();
  void report();

 Q_SIGNALS:
  void message(const QString& text);  ///< for the status bar

 private:
  /// Asks for a file and writes it in the background.
  void write(const QString& name, const QString& filter,
             const std::function<std::string(const std::string& path)>& content);

  Browser& browser_;
  QWidget* window_;
};

}  // namespace loci::gui
