#pragma once

#include <QWidget>
#include <vector>

#include "gui/browser.h"
#include "gui/data/image_notes.h"

class QTreeWidget;

namespace loci::gui {

class SceneImage;

/// The image of the chosen scene, what is measured under the cursor, and, where annotators found something
/// in parts of it (texts, barcodes, answers of a visual search), these as a tree beside their boxes.
class SceneView : public QWidget {
  Q_OBJECT

 public:
  explicit SceneView(Browser& browser, QWidget* parent = nullptr);

  SceneImage& image() { return *image_; }
  QTreeWidget* notes() const { return tree_; }
  void show_notes(std::vector<ImageNote> notes);

 private:
  void refresh();

  Browser& browser_;
  SceneImage* image_;
  QTreeWidget* tree_;
  std::vector<ImageNote> notes_;
  int64_t scene_ = 0;  ///< that the notes are of; 0 = none
};

}  // namespace loci::gui
